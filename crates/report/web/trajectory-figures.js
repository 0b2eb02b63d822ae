// ---------------------------------------------------------------- figures 4.4 to 4.11

const PART_S = 300;
const MINUTES_FROM_S = 240;
const MEANT_KMH = 1000;
const WINDOW = { halfS: 5, besideS: 3, height: 190, most: 420 };

/** Speeds over the time of a drive, between the seconds of `view`. */
function timeFigure(drive, { title, caption, lines, y, digits = 1 }, view, width) {
  const from = Math.max(0, Math.round(view.from / drive.stepS));
  const to = Math.min(drive.speed.length, Math.round(view.to / drive.stepS) + 1);
  const inMinutes = view.to - view.from > MINUTES_FROM_S;
  const unit = inMinutes ? 60 : 1;
  const places = Float64Array.from({ length: Math.max(to - from, 0) }, (_, index) => ((from + index) * drive.stepS) / unit);
  const x = { low: view.from / unit, high: view.to / unit, unit: inMinutes ? 'min' : 's' };
  const shown = lines.map((line) => ({ ...line, places, values: line.values.subarray(from, to) }));
  const told = (at) => {
    const index = Math.round((at * unit) / drive.stepS);
    if (!(index >= 0 && index < drive.speed.length)) return null;
    const row = ({ name, values }) => `${name} ${quantity(values[index], digits, y.unit)}`;
    return [clock(index * drive.stepS), lines.map(row)];
  };
  return [linePicture({ label: `${title}. ${caption}`, lines: shown, x, y, told }, width), lineLegend(lines)];
}

// ---------------------------------------------------------------- predictions

const TRIALS = {
  1: { figure: '4.5', name: 'limit, next and last other limit, distances to them' },
  2: { figure: '4.7', name: 'window of limits and last speed' },
  3: { figure: '4.8', name: 'change of speed from the window of limits and past speeds' },
  4: { figure: '4.9', name: 'as trial 3 with a quadratic kernel' },
  5: { figure: '4.11', name: 'as trial 3, all scaled to −1 to 1' },
};

/** How far the prediction is off, and what of it cannot be seen. */
function predictionCaption({ speed, stepS }, predicted, y) {
  let [squares, count, outside, lost] = [0, 0, 0, 0];
  predicted.forEach((value, index) => {
    if (Number.isNaN(value)) lost += 1;
    else {
      count += 1;
      squares += (value - speed[index]) ** 2;
      if (value < y.low || value > y.high) outside += 1;
    }
  });
  const rmse = Math.sqrt(squares / count);
  const words = rmse < MEANT_KMH ? [`RMSE on this drive ${quantity(rmse, 1, 'km/h')}.`] : [];
  const far = quantity(outside * stepS, outside * stepS < 10 ? 1 : 0, 's');
  if (outside > 0) words.push(`For ${far} the prediction lies beyond the axis and is drawn at its edge.`);
  if (lost > 0) words.push(`For ${quantity(lost * stepS, 0, 's')} there is none: the recursion ran away beyond all numbers.`);
  return words.join(' ');
}

function predictionSpec(drive, trial, predicted) {
  const { figure, name } = TRIALS[trial];
  const y = speedAxis([drive.speed, drive.limit ?? []], predicted);
  // What ran away must not hide the rest.
  const lines = [
    { ...PREDICTED, values: predicted },
    ...(drive.limit ? [{ ...LIMIT, values: drive.limit }] : []),
    { ...MEASURED, values: drive.speed },
  ];
  const caption = `${drive.name}. ${predictionCaption(drive, predicted, y)}`;
  return { figure, title: `Figure ${figure}: trial ${trial} (${name})`, caption, lines, y, drive, moves: true };
}

// ---------------------------------------------------------------- the drive learnt from

function learntSpecs(drive) {
  const limit = drive.limit;
  const known = [...(limit ? [{ ...LIMIT, values: limit }] : []), { ...MEASURED, values: drive.speed }];
  const scaled = (values) => {
    const { low, high } = extent(values);
    return values.map((value) => (high > low ? (2 * (value - low)) / (high - low) - 1 : 0));
  };
  const zero = limit ? ' The limit is drawn as the trials see it, 0 where the car stands.' : ' It has no limits.';
  return [
    {
      figure: '4.4',
      title: 'Figure 4.4: a trajectory learnt from',
      caption: `${drive.name}, ${quantity(drive.speed.length, 0, 'samples')} of ${quantity(drive.stepS, 1, 's')}.${zero}`,
      lines: known,
      y: speedAxis([drive.speed, limit ?? []], []),
      drive,
    },
    {
      figure: '4.10',
      title: 'Figure 4.10: the trajectory of figure 4.4, scaled to −1 to 1',
      caption: 'Here by the least and the greatest of this drive; trial 5 takes those of all drives that it learns from.',
      lines: known.map((line) => ({ ...line, values: scaled(line.values) })),
      y: { low: -1.1, high: 1.1, unit: 'scaled' },
      digits: 2,
      drive,
    },
  ];
}

// ---------------------------------------------------------------- windows of limits

/** Moments before, at and after one change of the limit and one standstill, or two of a kind. */
function windowMoments({ limit, stepS, speed }) {
  const half = Math.round(WINDOW.halfS / stepS);
  const beside = Math.round(WINDOW.besideS / stepS);
  const changes = [];
  for (let k = 2 * half; k < limit.length - 2 * half; k += 1) {
    const [before, after] = [limit[k - 1], limit[k]];
    if (before !== after) changes.push({ at: k, stands: Math.min(before, after) === 0, size: Math.abs(after - before) });
  }
  // Those of the limit itself, the largest first, and then where the car comes to stand.
  const moving = sortRows(changes.filter(({ stands }) => !stands), ({ size }) => size, true);
  const halts = changes.filter(({ at, stands }) => stands && limit[at] === 0);
  const chosen = [...moving.slice(0, halts.length > 0 ? 1 : 2), ...halts.slice(0, moving.length > 0 ? 1 : 2)];
  return chosen.flatMap(({ at, stands }) =>
    [-beside, 0, beside].map((shift) => ({ at: at + shift, shift: shift * stepS, stands, half, speed: speed[at + shift] })),
  );
}

function windowTitle({ shift, stands }) {
  const what = stands ? 'the stop' : 'the change';
  if (shift === 0) return `at ${what}`;
  return `${quantity(Math.abs(shift), 0, 's')} ${shift < 0 ? 'before' : 'after'} ${what}`;
}

function windowPicture({ limit, stepS }, moment, y, width) {
  const frame = chartFrame(width, WINDOW.height, { low: -WINDOW.halfS, high: WINDOW.halfS, unit: 's from now' }, y);
  const sample = (_, index) => Math.min(Math.max(moment.at + index - moment.half, 0), limit.length - 1);
  const held = Array.from({ length: 2 * moment.half + 1 }, sample);
  const steps = held.flatMap((at, index) => {
    const time = (index - moment.half) * stepS;
    return index === 0 ? [[time, limit[at]]] : [[time, limit[held[index - 1]]], [time, limit[at]]];
  });
  const title = `${clock(moment.at * stepS)}, ${windowTitle(moment)}`;
  const levels = [...new Set(held.map((at) => fixed(limit[at], 0)))].join(', then ');
  const label = `Window of limits at ${title}: ${levels} km/h; the speed is ${fixed(moment.speed, 0)} km/h.`;
  return picture(frame, label, [
    ...frame.axes,
    svg('text', { class: 'name', x: frame.box.right, y: 14, 'text-anchor': 'end' }, title),
    lineNode(steps, frame, { ...LIMIT, width: 2.5 }),
    markerNode('circle', [[frame.x(0), frame.y(Math.max(moment.speed, 0))]], 4, MEASURED.colour),
  ]);
}

function windowFigure(drive) {
  const moments = windowMoments(drive);
  const count = 2 * Math.round(WINDOW.halfS / drive.stepS) + 1;
  const y = speedAxis([drive.limit, drive.speed], []);
  const panels = moments.map(() => el('div'));
  const dot = swatch(MEASURED.colour);
  dot.style.borderRadius = '50%';
  const caption = [
    `${drive.name}. What trials 2 to 5 know of the limits: ${fixed(count, 0)} values of 10\u00a0s, half of them of what is still to come.`,
    'Where the car will stand within 5\u00a0s, the window says so.',
  ].join(' ');
  const legend = legendOf([[strokeSample(LIMIT.colour), 'limit'], [dot, 'speed now']]);
  const body =
    moments.length > 0
      ? [el('div', { class: 'panels' }, ...panels), legend, el('figcaption', {}, caption)]
      : [note('The limit of this drive never changes.')];
  const node = el('figure', {}, el('h3', {}, 'Figure 4.6: the window of limits'), ...body);
  const drawn = (panel, index) => windowPicture(drive, moments[index], y, chartWidth(panel, WINDOW.most));
  const draw = () => panels.forEach((panel, index) => panel.replaceChildren(drawn(panel, index)));
  return { figure: '4.6', node, draw };
}

// ---------------------------------------------------------------- the section

/** The whole of a drive, or five minutes of it. */
function partsOf({ durationS }) {
  const count = durationS > 1.5 * PART_S ? Math.ceil(durationS / PART_S) : 0;
  const part = (_, index) => {
    const [from, to] = [index * PART_S, Math.min((index + 1) * PART_S, durationS)];
    return { label: `minutes ${fixed(from / 60, 0)} to ${fixed(to / 60, to % 60 === 0 ? 0 : 1)}`, from, to };
  };
  const parts = Array.from({ length: count }, part).filter(({ from, to }) => to - from >= 30);
  return [{ label: 'all of it', from: 0, to: durationS }, ...parts];
}

function figureSection({ trials, curves }) {
  if (trials.length === 0) return absent('figures', 'Some drive has no limits, so that there are no trials to draw.');
  const { shown, learnt, predicted } = curves;
  const known = isDrawable(shown) ? predicted.filter((one) => TRIALS[one.trial] && one.speed.length === shown.speed.length) : [];
  const parts = partsOf(shown);
  let view = parts[0];
  const predictions = known.map(({ trial, speed }) => predictionSpec(shown, trial, speed));
  const timed = [...(isDrawable(learnt) ? learntSpecs(learnt) : []), ...predictions];
  const figures = timed.map((spec) => {
    const body = el('div');
    const node = el('figure', {}, el('h3', {}, spec.title), body, el('figcaption', {}, spec.caption));
    const all = { from: 0, to: spec.drive.durationS };
    const drawn = () => timeFigure(spec.drive, spec, spec.moves ? view : all, chartWidth(body, 1200));
    return { ...spec, node, draw: () => body.replaceChildren(...drawn()) };
  });
  if (isDrawable(shown) && shown.limit) figures.push(windowFigure(shown));
  if (figures.length === 0) return absent('figures', 'The document has no drives to draw (curves).');
  const pick = (part) => {
    view = part;
    figures.filter(({ moves }) => moves).forEach(({ draw }) => draw());
  };
  const controls =
    parts.length > 1 && known.length > 0
      ? [el('div', { class: 'controls' }, picklist('Part of the predicted drive', [['Time', parts]], pick))]
      : [];
  byId('figures-remark').append(
    'One drive that trials learnt from, and another, the longest, as each trial, fitted on other drives, predicts it from its limits.',
  );
  const numbered = sortRows(figures, ({ figure }) => Number(figure.split('.')[1]), false);
  byId('figures-body').append(...controls, ...numbered.map(({ node }) => node));
  return () => figures.forEach(({ draw }) => draw());
}
