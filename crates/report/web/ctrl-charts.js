// ---------------------------------------------------------------- lines over the time of a run

const EVENTS = {
  'tracker-off': { label: 'tracker off', colour: '--series-4' },
  'tracker-decay': { label: 'tracker fades', colour: '--series-3' },
  stop: { label: 'stands', colour: '--braking' },
};
const OTHER_EVENT = { colour: '--quiet' };
const EVENT_LABELS = { pitch: 14, character: 6.3, most: 3 };
/** The same robots without disturbances, over the lines of those that have them. */
const BESIDE = { colour: '--ink', kind: 'dashed', width: 1.1 };
const UNDISTURBED = { ...BESIDE, name: 'without disturbances' };
const DECADES = 8;

const eventLook = ({ kind }) => (Object.hasOwn(EVENTS, kind) ? EVENTS[kind] : OTHER_EVENT);
const isStep = ({ kind }) => kind === 'desired-speed';

function eventWords({ robots }, event) {
  const name = robots[event.robot]?.name ?? 'all';
  if (isStep(event)) return `${name}: ${quantity(event.value, 2, 'm/s')}`;
  return `${name}: ${eventLook(event).label ?? event.kind}`;
}

/** Events that a figure marks: not the speeds wanted from the start on. */
const markedEvents = ({ events, time }) => events.filter((event) => !isStep(event) || event.from > time[0]);

/** A row for each label such that none covers another; none for what would not fit. */
function labelRows(labels) {
  const ends = [];
  return labels.map(({ from, to }) => {
    const free = ends.findIndex((end) => end < from);
    const row = free < 0 ? ends.length : free;
    ends[row] = to;
    return row < EVENT_LABELS.most ? row : -1;
  });
}

const insideAlong = ({ x, range }, time) => x(Math.min(Math.max(time, range.x.low), range.x.high));

function eventShade(event, frame) {
  const { top, bottom } = frame.box;
  const from = insideAlong(frame, event.from);
  const width = isStep(event) ? 1 : Math.max(insideAlong(frame, event.to) - from, 1);
  const node = svg('rect', { x: from, y: top, width, height: bottom - top, 'fill-opacity': isStep(event) ? 0.5 : 0.13 });
  return coloured(node, 'fill', eventLook(event).colour);
}

function eventLabels(report, frame) {
  const { box } = frame;
  const labels = sortRows(markedEvents(report), ({ from }) => from, false).map((event) => {
    const words = eventWords(report, event);
    const width = EVENT_LABELS.character * words.length;
    const from = Math.max(Math.min(insideAlong(frame, event.from) + 4, box.right - width), box.left);
    return { words, from, to: from + width + 6 };
  });
  const rows = labelRows(labels);
  const y = (row) => box.top + 13 + row * EVENT_LABELS.pitch;
  const node = ({ words, from }, index) => svg('text', { class: 'over', x: from, y: y(rows[index]) }, words);
  return labels.map((label, index) => (rows[index] < 0 ? null : node(label, index))).filter((one) => one !== null);
}

function eventEntries(report) {
  const kinds = [...new Set(markedEvents(report).map(({ kind }) => kind))];
  return kinds.map((kind) => {
    const sample = swatch(eventLook({ kind }).colour);
    sample.style.opacity = 0.35;
    return [sample, isStep({ kind }) ? 'new desired speed' : (eventLook({ kind }).label ?? kind)];
  });
}

function eventsAt(report, timeS) {
  const goingOn = (event) => !isStep(event) && timeS >= event.from && timeS <= event.to;
  return markedEvents(report).filter(goingOn).map((event) => eventWords(report, event));
}

// ---------------------------------------------------------------- axes

const isMiddling = (value) => value === 0 || (Math.abs(value) >= 1e-3 && Math.abs(value) < 1e5);
const anySize = (value) => (isMiddling(value) ? significant : scientific)(value);

const powerOfTen = (exponent) => `10${[...String(exponent)].map((sign) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(sign)]).join('')}`;

function decadeMarks(low, high, count) {
  const step = Math.max(Math.ceil((high - low) / count), 1);
  const exponents = Array.from({ length: high - low + 1 }, (_, index) => low + index);
  return exponents.filter((value) => value % step === 0).map((value) => ({ value, label: powerOfTen(value) }));
}

/** An axis of powers of ten and what puts values on it; what is not above its lower end lies there. */
function logAxis(values, unit) {
  const { low, high } = extent(values.filter((value) => value > 0));
  const top = high > 0 ? Math.ceil(Math.log10(high) + 1e-9) : 0;
  const bottom = high > 0 ? Math.max(Math.floor(Math.log10(low)), top - DECADES) : -1;
  const axis = { low: bottom, high: Math.max(top, bottom + 1), unit };
  const place = (value) => (value > 0 ? Math.max(Math.log10(value), bottom) : Number.isNaN(value) ? NaN : bottom);
  return { axis: { ...axis, isLog: true, marks: decadeMarks(axis.low, axis.high, 5) }, place };
}

/** An axis whose ticks count in thousands or thousandths of the unit, and so on, where they would be too long otherwise. */
function linearMarks({ low, high, unit }) {
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (isMiddling(size)) return { low, high, unit };
  const exponent = 3 * Math.floor(Math.log10(size) / 3);
  const marks = ticks(low, high, 5).map(({ value }) => ({ value, label: significant(value / 10 ** exponent).replace('-', '\u2212') }));
  return { low, high, unit: `${powerOfTen(exponent)}\u00a0${unit}`, marks };
}

/** From the least to the most, and to zero; or, close to it, as far as shows the least. */
function linearAxis(values, unit, isClose, isBound) {
  const least = extent(values).low;
  const { low, high } = rangeOf(values.length > 0 ? [0, ...values] : []);
  const place = (value) => value;
  if (!isClose) return { axis: linearMarks({ low: least < 0 || isBound ? low : 0, high, unit }), place };
  const span = Math.max(10 * Math.abs(least), 0.03 * (high - low));
  const close = { low: Math.min(least, 0) - 0.1 * span, high: Math.min(Math.max(least, 0) + span, high), unit };
  return { axis: linearMarks(close), place };
}

// ---------------------------------------------------------------- figures

/** Lines over time with the events behind them and the values under the pointer. */
function timePicture(report, { title, lines, unit, digits, caption, isLog = false, isClose = false, isBound = false, told = fixed }, width) {
  const { time, along } = report;
  const values = lines.flatMap((line) => Array.from(line.values)).filter(Number.isFinite);
  const { axis, place } = isLog ? logAxis(values, unit) : linearAxis(values, unit, isClose, isBound);
  const spec = {
    label: `${title} over time. ${caption}`,
    lines: lines.map((line) => ({ ...line, places: time, values: line.values.map(place) })),
    x: { ...along, unit: 's' },
    y: axis,
    under: (frame) => [...markedEvents(report).map((event) => eventShade(event, frame)), ...(isBound ? [boundNode(frame)] : [])],
    over: (frame) => eventLabels(report, frame),
    told: (at) => {
      const index = nearestIndex(time, at);
      const row = (line) => `${line.name} ${told(line.values[index], digits)}${unit ? `\u00a0${unit}` : ''}`;
      return [quantity(time[index], 2, 's'), [...lines.map(row), ...eventsAt(report, time[index])]];
    },
  };
  return linePicture(spec, width);
}

/** The zero that no line may go below. */
function boundNode({ box, y }) {
  const line = svg('line', { x1: box.left, x2: box.right, y1: y(0), y2: y(0), 'stroke-width': 1.25 });
  return coloured(line, 'stroke', '--braking');
}

/** A figure with its legend; `draw` draws it as wide as it is. */
function timeFigure(report, spec) {
  const lines = spec.lines.filter(({ values }) => isKnown(values));
  const body = el('div');
  const own = lineEntries(lines.filter(({ isBeside }) => !isBeside));
  const entries = [...own, ...besideEntry(lines, spec.beside ?? UNDISTURBED), ...eventEntries(report)];
  const content = lines.length > 0 ? [body, legendOf(entries)] : [note(spec.nothing ?? 'Not known for any robot.')];
  const caption = spec.caption ?? '';
  const node = el('figure', {}, el('h3', {}, spec.title), ...content, ...(caption ? [el('figcaption', {}, caption)] : []));
  const draw = (look = {}) =>
    lines.length > 0 && body.replaceChildren(timePicture(report, { ...spec, ...look, lines, caption }, chartWidth(body)));
  return { node, draw };
}

/** Lines that stand beside those of the robots: one entry for all. */
const besideEntry = (lines, look) => (lines.some(({ isBeside }) => isBeside) ? lineEntries([look]) : []);

/** A value of all robots over time, and of the same robots without disturbances. */
function robotLines(report, key, scale = 1) {
  const line = ({ name, colour, [key]: values }) => ({ name, colour, values: values.map((value) => scale * value) });
  const beside = report.undisturbed.map((robot, index) => {
    return { ...line(robot), ...BESIDE, name: `${report.robots[index].name}, undisturbed`, isBeside: true };
  });
  return [...report.robots.map(line), ...beside];
}

const hasTimes = ({ time, robots }) => time.length > 1 && robots.length > 0;
