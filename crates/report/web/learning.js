// ---------------------------------------------------------------- learning curve

const TRAININGS = {
  own: { colour: '--series-0', kind: 'solid', shape: 'circle' },
  'own and prior': { colour: '--series-1', kind: 'dashed', shape: 'square' },
  prior: { colour: '--quiet', kind: 'dotted', shape: 'diamond' },
};
const OTHER_TRAINING = { colour: '--series-3', kind: 'dashed', shape: 'up' };
const LEARNING = { most: 720, radius: 4 };

function readLearning(source) {
  const row = (raw) => ({
    model: text(raw.model),
    own: number(raw.own_trips),
    training: text(raw.training),
    phases: number(raw.phases),
    rmse: kmh(raw.rmse_mps),
    inBand: number(raw.in_band_pct),
  });
  const rows = list(source.rows).map(object).map(row).filter(({ own, rmse }) => Number.isFinite(own + rmse));
  return { rows, priorTrips: number(source.prior_trips), priorWeight: number(source.prior_weight) };
}

/** The rows of a model by kind of training, in the order of own trips. */
function learningLines(rows, model) {
  const mine = sortRows(rows.filter((row) => row.model === model), ({ own }) => own, false);
  const kinds = [...new Set([...Object.keys(TRAININGS), ...mine.map(({ training }) => training)])];
  return kinds
    .map((training) => ({ training, look: Object.hasOwn(TRAININGS, training) ? TRAININGS[training] : OTHER_TRAINING }))
    .map((line) => ({ ...line, points: mine.filter(({ training }) => training === line.training) }))
    .filter(({ points }) => points.length > 0);
}

const learningTitle = ({ training, own, rmse, phases }) =>
  `${training}, ${plural(own, 'own trip')}: RMSE ${quantity(rmse, 2, 'km/h')} over ${plural(phases, 'phase')}`;

function learningNodes({ look, points }, frame) {
  const { low, high } = frame.range.x;
  const at = points.map(({ own, rmse }) => [own, rmse]);
  // What is fitted to no own trip is one value at any count of them.
  const line = at.length === 1 ? [[low, at[0][1]], [high, at[0][1]]] : at;
  const marks = points.map((point) => {
    const mark = markerNode(look.shape, [[frame.x(point.own), frame.y(point.rmse)]], LEARNING.radius, look.colour);
    mark.append(svg('title', {}, learningTitle(point)));
    return mark;
  });
  return [lineNode(line, frame, { ...look, width: 2 }), ...marks];
}

function learningFigure(rows, model, width) {
  const lines = learningLines(rows, model);
  const points = lines.flatMap((line) => line.points);
  const x = { low: 0, high: Math.max(1, ...points.map(({ own }) => own)), unit: 'own trips' };
  const y = { ...rangeOf(points.map(({ rmse }) => rmse), 0.1), unit: 'RMSE, km/h' };
  const frame = chartFrame(width, Math.max(260, Math.round(width * 0.5)), x, y);
  const told = lines.map((line) => line.points.map(learningTitle).join('; ')).join('; ');
  const drawn = picture(frame, `Learning curve of ${model}. ${told}.`, [...frame.axes, ...lines.flatMap((line) => learningNodes(line, frame))]);
  return [drawn, legendOf(lines.map(({ training, look }) => [strokeSample(look.colour, look.kind), training]))];
}

function learningTable(rows) {
  const columns = [
    { label: 'Model', value: ({ model }) => model },
    { label: 'Training', value: ({ training }) => training },
    { label: 'Own trips', value: ({ own }) => own, digits: 0 },
    { label: 'Phases', value: ({ phases }) => phases, digits: 0 },
    { label: 'RMSE', unit: 'km/h', value: ({ rmse }) => rmse, digits: 2 },
    { label: 'In band', unit: '%', value: ({ inBand }) => inBand, digits: 1 },
  ];
  return sortableTable('Learning curve', columns, rows);
}

function learningSection(report) {
  const { rows, priorTrips, priorWeight } = readLearning(report.learning);
  if (rows.length === 0) return absent('learning', 'This evaluation has no learning curve (learning_curve).');
  const prior = [
    ...(Number.isFinite(priorTrips) ? [`The prior holds ${plural(priorTrips, 'trip')} of other drivers.`] : []),
    ...(Number.isFinite(priorWeight) ? [`It weighs ${fixed(priorWeight, 2)} of what an own trip does.`] : []),
  ];
  const choices = inTableOrder(report, rows.map(({ model }) => model)).map((name) => ({ label: name }));
  const best = bestOf(report.models.filter(({ name }) => choices.some(({ label }) => label === name)));
  let chosen = choices.find(({ label }) => label === best?.name) ?? choices[0];
  const figure = el('figure');
  const draw = () => figure.replaceChildren(...learningFigure(rows, chosen.label, chartWidth(figure, LEARNING.most)));
  const pick = (choice) => {
    chosen = choice;
    draw();
  };
  const table = el('div', { class: 'below' }, learningTable(rows));
  const remark = prior.length > 0 ? [note(prior.join(' '))] : [];
  const controls = el('div', { class: 'controls' }, picklist('Model', [['Models', choices]], pick, chosen));
  byId('learning-body').append(...remark, controls, figure, table);
  draw();
  return draw;
}
