// ---------------------------------------------------------------- slacks, outcomes and speeds

const SLACKS = ['δ1, desired speed', 'δ2, turn rate', 'δ3, path'];
const STRIP = { row: 22, bar: 16, top: 6, bottom: 42, left: 8, right: 14, title: 16 };

function slackFigures(report) {
  const lines = (row) => report.robots.map(({ name, colour, slack }) => ({ name, colour, values: slack[row] }));
  return SLACKS.map((title, row) => {
    const spec = { title: `Slack ${title}`, unit: '', isLog: true, told: anySize, lines: lines(row) };
    return timeFigure(report, spec);
  });
}

// ---------------------------------------------------------------- outcomes over time

const severity = (name) => [UNKNOWN, ...OUTCOMES].indexOf(outcomeLook(name));

/** Spans of one outcome; a column of pixels has the worst of its steps. */
function outcomeSpans({ outcome }, columns) {
  const { names, steps } = outcome;
  const ranks = names.map(severity);
  const spans = [];
  for (let column = 0; column < columns; column += 1) {
    const from = Math.floor((column * steps.length) / columns);
    const to = Math.max(Math.floor(((column + 1) * steps.length) / columns), from + 1);
    let worst = -1;
    for (let index = from; index < Math.min(to, steps.length); index += 1) {
      if (worst < 0 || (ranks[steps[index]] ?? 0) > (ranks[worst] ?? 0)) worst = steps[index];
    }
    const colour = (names[worst] === undefined ? UNKNOWN : outcomeLook(names[worst])).colour;
    const last = spans.at(-1);
    if (last?.colour === colour) last.to = column + 1;
    else spans.push({ colour, from: column, to: column + 1 });
  }
  return spans;
}

function stripRow(robot, index, left, width) {
  const top = STRIP.top + index * (STRIP.title + STRIP.row) + STRIP.title;
  const bars = outcomeSpans(robot, Math.floor(width)).map(({ colour, from, to }) =>
    coloured(svg('rect', { x: left + from, y: top, width: to - from, height: STRIP.bar }), 'fill', colour),
  );
  return [svg('text', { class: 'name', x: left, y: top - 4 }, robot.name), ...bars];
}

function stripPicture(report, width) {
  const { time, robots } = report;
  const [left, right] = [STRIP.left, width - STRIP.right];
  const bottom = STRIP.top + robots.length * (STRIP.title + STRIP.row);
  const range = report.along;
  const x = linear(range.low, range.high, left, right);
  const along = ({ value, label }) => [
    svg('line', { class: 'axis', x1: x(value), x2: x(value), y1: bottom, y2: bottom + 4 }),
    svg('text', { ...labelPlace(x(value), right + STRIP.right), y: bottom + 17 }, label),
  ];
  const label = `How the steps of each robot ended, over time. ${robots.map(countWords).join(' ')}`;
  const size = { width, height: bottom + STRIP.bottom };
  const drawn = picture(size, label, [
    ...robots.flatMap((robot, index) => stripRow(robot, index, left, right - left)),
    ...ticks(range.low, range.high, Math.max(3, (right - left) / 60)).flatMap(along),
    svg('text', { x: right, y: bottom + 34, 'text-anchor': 'end' }, 's'),
  ]);
  const frame = { width, box: { left, right, top: STRIP.top, bottom }, range: { x: range, y: { low: 0, high: robots.length } } };
  return hoverable(frame, drawn, (timeS) => {
    const index = nearestIndex(time, timeS);
    const row = (robot) => `${robot.name}: ${outcomeWords(outcomeAt(robot, index).name)}`;
    return [quantity(time[index], 2, 's'), [...robots.map(row), ...eventsAt(report, time[index])]];
  });
}

/** How often each outcome is, from the best to the worst. */
function outcomeCounts({ outcome }) {
  const counts = new Map();
  for (const step of outcome.steps) if (step >= 0) counts.set(outcome.names[step], (counts.get(outcome.names[step]) ?? 0) + 1);
  return sortRows([...counts], ([name]) => severity(name), false);
}

function countWords(robot) {
  const counts = outcomeCounts(robot).map(([name, count]) => `${outcomeWords(name)} ${fixed(count, 0)}`);
  return `${robot.name}: ${counts.join(', ') || 'not known'}.`;
}

function countTable({ robots, time }) {
  const counts = robots.map((robot) => new Map(outcomeCounts(robot)));
  const names = sortRows([...new Set(counts.flatMap((one) => [...one.keys()]))], severity, false);
  const head = names.map((name) => heading(outcomeWords(name)));
  const cell = (count) => el('td', {}, fixed(count, 0), el('small', {}, `\u2002${fixed((100 * count) / time.length, 1)}\u00a0%`));
  const rows = robots.map((robot, index) => {
    const cells = names.map((name) => cell(counts[index].get(name) ?? 0));
    return el('tr', {}, el('th', { scope: 'row' }, robot.name), ...cells);
  });
  return tableBox('Steps by outcome', [el('tr', {}, heading('Robot', 'text corner'), ...head)], [el('tbody', {}, ...rows)]);
}

// ---------------------------------------------------------------- speeds

/** The speed that a robot is to drive at each time; from the events alone where the scenario does not say it. */
function desiredSpeed({ desired, events, time }, robot) {
  const told = events.filter((event) => isStep(event) && event.robot === robot).map(({ from, value }) => [from, value]);
  const steps = sortRows(desired[robot] ?? told, ([from]) => from, false);
  return time.map((timeS) => steps.findLast(([from]) => from <= timeS + 1e-6)?.[1] ?? NaN);
}

function speedFigure(report) {
  const lines = report.robots.flatMap((robot) => {
    const { name, colour, index } = robot;
    const wanted = { name: `${name}, desired`, colour, kind: 'dotted', values: desiredSpeed(report, index), isBeside: true };
    return [{ name, colour, values: robot.speed }, { ...wanted, width: 1.5 }];
  });
  const spec = { title: 'Speed', lines, unit: 'm/s', digits: 3, beside: { colour: '--quiet', kind: 'dotted', name: 'desired' } };
  return timeFigure(report, spec);
}

function programmeSection(report) {
  if (!hasTimes(report)) return absent('programme', 'The document has no steps over time (figures).');
  const figures = [speedFigure(report), ...slackFigures(report)];
  const [speed, ...slacks] = figures.map(({ node }) => node);
  const strip = el('div');
  const legend = legendOf(OUTCOMES.map(({ kind, colour }) => [swatch(colour), kind]));
  const relaxed = report.maxSlack > 0 ? [note(`A relaxed row gave way by ${anySize(report.maxSlack)} at most, in its units.`)] : [];
  byId('programme-body').append(
    el('figure', {}, el('h3', {}, 'Outcome of each step'), strip, legend),
    el('div', { id: 'counts' }, countTable(report), ...relaxed),
    el('div', { class: 'below' }, speed),
    el('div', { class: 'panels below' }, ...slacks),
    note('A slack is how much a Lyapunov row gave way to the others. What is not above the lower end of an axis lies there.'),
  );
  return () => {
    strip.replaceChildren(stripPicture(report, chartWidth(strip, 1200)));
    figures.forEach(({ draw }) => draw());
  };
}

// ---------------------------------------------------------------- time of a step, age of poses

const STEP_BINS = { perDecade: 20, height: 300 };

function stepBins(values) {
  const logs = values.filter((value) => value > 0).map((value) => Math.log10(value) * STEP_BINS.perDecade);
  const counts = new Map();
  for (const value of logs) counts.set(Math.floor(value), (counts.get(Math.floor(value)) ?? 0) + 1);
  return [...counts].map(([bin, count]) => ({ from: bin / STEP_BINS.perDecade, to: (bin + 1) / STEP_BINS.perDecade, count }));
}

/** Lines to compare with: names stand one below the other where they are close. */
function stepMarks({ loop, rateHz }) {
  const marks = [
    { name: 'median', at: loop.median, kind: 'median' },
    { name: '99 %', at: loop.p99, kind: 'median' },
    { name: 'largest', at: loop.max, kind: 'mean' },
    { name: 'period', at: 1e6 / rateHz, kind: 'mean' },
  ];
  return marks.filter(({ at }) => at > 0 && Number.isFinite(at)).map((mark) => ({ ...mark, place: Math.log10(mark.at) }));
}

function stepPicture(report, bins, caption, width) {
  const marks = stepMarks(report);
  const places = [...bins.flatMap(({ from, to }) => [from, to]), ...marks.map(({ place }) => place)];
  const [low, high] = [Math.floor(Math.min(...places)), Math.ceil(Math.max(...places) + 0.05)];
  const most = Math.max(...bins.map(({ count }) => count));
  const x = { low, high, unit: 'µs', isLog: true, marks: decadeMarks(low, high, 8) };
  const frame = chartFrame(width, STEP_BINS.height, x, { low: 0, high: most * 1.3, unit: 'steps' });
  const { box } = frame;
  const bars = bins.map(({ from, to, count }) => {
    const size = { x: frame.x(from), y: frame.y(count), width: Math.max(frame.x(to) - frame.x(from) - 0.5, 0.5) };
    const range = `${significant(10 ** from)} to ${significant(10 ** to)}\u00a0µs`;
    const bar = svg('rect', { class: 'bar', ...size, height: box.bottom - frame.y(count) }, svg('title', {}, `${range}: ${plural(count, 'step')}`));
    return coloured(bar, 'fill', '--series-0');
  });
  const lines = marks.flatMap(({ name, kind, place }, index) => {
    const [at, y] = [frame.x(place), box.top + 12 + 14 * (index % 4)];
    const isRight = at > box.right - 70;
    const text = { class: 'over value', x: isRight ? at - 5 : at + 5, y, 'text-anchor': isRight ? 'end' : 'start' };
    return [svg('line', { class: kind, x1: at, x2: at, y1: box.top, y2: box.bottom }), svg('text', text, name)];
  });
  return picture(frame, `How long steps took. ${caption}`, [...frame.axes, ...bars, ...lines]);
}

function stepCaption({ loop, rateHz }) {
  const values = [['Median', loop.median], ['99 % within', loop.p99], ['at most', loop.max]].filter(([, value]) => Number.isFinite(value));
  const told = values.map(([name, value]) => `${name} ${quantity(value, 1, 'µs')}`).join(', ');
  const period = Number.isFinite(rateHz) ? ` The period is ${quantity(1000 / rateHz, 1, 'ms')}.` : '';
  const missed = loop.missed > 0 ? ` ${plural(loop.missed, 'step')} took longer than that.` : ' No step took longer.';
  return `${told}.${period}${Number.isFinite(loop.missed) ? missed : ''}`;
}

function stepFigure(report) {
  const bins = stepBins(report.robots.flatMap(({ stepUs }) => stepUs));
  const body = el('div');
  const caption = stepCaption(report);
  const content = bins.length > 0 ? [body, el('figcaption', {}, caption)] : [note('The document has no times of steps (step_us).')];
  const node = el('figure', {}, el('h3', {}, 'Time of a step'), ...content);
  const draw = () => bins.length > 0 && body.replaceChildren(stepPicture(report, bins, caption, chartWidth(body)));
  return { node, draw };
}

function ageFigure(report) {
  const lines = report.robots.map(({ name, colour, age }) => ({ name, colour, values: age.map(millimetres) }));
  return timeFigure(report, { title: 'Age of poses', lines, unit: 'ms', digits: 1, nothing: 'The age of poses is not known.' });
}

function loopSection(report) {
  const timed = report.robots.some(({ stepUs, age }) => stepUs.length > 0 || isKnown(age));
  if (!hasTimes(report) || !timed) return absent('loop', 'The document has no times of steps (figures).');
  const figures = [stepFigure(report), ageFigure(report)];
  byId('loop-body').append(...figures.map(({ node }) => node));
  return () => figures.forEach(({ draw }) => draw());
}
