// ---------------------------------------------------------------- speed some seconds ahead

const SERIES_COLOURS = 8;
const KINDS = ['dashed', 'dotted'];
const AHEAD = { most: 900, radius: 3.5, beyond: 1.3 };
const PERSISTENCE = 'persistence';

const isTrial = (name) => /^trial-\d+$/.test(name);
const seconds = (horizon) => `${horizon}\u00a0s`;

/** Models, trials and baselines, each with its figures in the order of the horizons, and how it is drawn. */
function readHorizons(doc) {
  const byHorizon = Object.entries(object(doc.horizons)).map(([key, models]) => ({ ahead: Number(key), models: object(models) }));
  const horizons = sortRows(byHorizon.filter(({ ahead }) => ahead > 0), ({ ahead }) => ahead, false);
  const figures = ({ models }, name) => {
    const raw = object(member(models, name));
    const [rmse, skill] = ['rmse_mps', 'skill_pct'].map((key) => number(raw[key]));
    const [interval, oneWidth] = [object(raw.interval), object(raw.one_width)];
    const [half, coverage] = ['half_width_mps', 'coverage_pct'].map((key) => number(interval[key]));
    const score = 100 * (number(interval.score_mps) / number(oneWidth.score_mps) - 1);
    return { rmse, skill, half, coverage, score };
  };
  const entry = (isBaseline) => ([name, raw]) => ({
    name,
    isBaseline,
    isTrial: isTrial(name),
    fitS: number(object(raw).fit_seconds),
    predictS: number(object(raw).predict_seconds),
    figures: horizons.map((horizon) => figures(horizon, name)),
  });
  const entries = (source, isBaseline) => Object.entries(object(source)).map(entry(isBaseline));
  const [models, baselines] = [entries(doc.models, false), entries(doc.baselines, true)];
  const fitted = [...models.filter((model) => !model.isTrial), ...models.filter((model) => model.isTrial)];
  fitted.forEach((model, index) => {
    const shape = SHAPES[index % SHAPES.length];
    model.look = { colour: `--series-${index % SERIES_COLOURS}`, kind: model.isTrial ? 'dotted' : 'solid', shape };
  });
  baselines.sort((a, b) => (b.name === PERSISTENCE) - (a.name === PERSISTENCE));
  baselines.forEach((model, index) => {
    model.look = { colour: '--quiet', kind: KINDS[index % KINDS.length], shape: SHAPES[index % SHAPES.length], hollow: true };
  });
  return { ahead: horizons.map(({ ahead }) => ahead), models: [...fitted, ...baselines] };
}

/** The least error of a horizon, of all that keep to `rule`. */
function bestAt({ models }, index, rule = () => true) {
  const known = models.filter((model) => rule(model) && Number.isFinite(model.figures[index]?.rmse));
  return sortRows(known, (model) => model.figures[index].rmse, false)[0];
}

// ---------------------------------------------------------------- chart

/** The axis holds all that is shown but for what is worse than every baseline by far. */
function errorAxis({ models }, shown) {
  const errors = (some) => some.flatMap(({ figures }) => figures.map(({ rmse }) => rmse)).filter(Number.isFinite);
  const most = AHEAD.beyond * Math.max(0, ...errors(models.filter(({ isBaseline }) => isBaseline)));
  const high = Math.max(0, ...errors(shown));
  return { low: 0, high: 1.06 * (most > 0 ? Math.min(high, most) : high) || 1, unit: 'RMSE, m/s' };
}

function errorLine({ figures, look }, ahead, frame) {
  const points = ahead.map((at, index) => [at, figures[index].rmse]);
  const inside = points.filter(([, rmse]) => rmse <= frame.range.y.high);
  const places = inside.map(([at, rmse]) => [frame.x(at), frame.y(rmse)]);
  return [lineNode(points, frame, { ...look, width: 2 }), markerNode(look.shape, places, AHEAD.radius, look.colour, look.hollow)];
}

function errorsTold(shown, ahead, at) {
  const nearest = ahead.reduce((best, one, index) => (Math.abs(one - at) < Math.abs(ahead[best] - at) ? index : best), 0);
  const known = shown.filter(({ figures }) => Number.isFinite(figures[nearest].rmse));
  const rows = sortRows(known, ({ figures }) => figures[nearest].rmse, false);
  if (rows.length === 0) return null;
  const row = ({ name, figures }) => `${name}: ${quantity(figures[nearest].rmse, 3, 'm/s')}`;
  return [`${seconds(ahead[nearest])} ahead`, rows.map(row)];
}

function errorFigure({ ahead, models }, shown, width) {
  const lines = models.filter(({ name }) => shown.has(name));
  const x = { low: 0, high: 1.03 * Math.max(...ahead), unit: 's ahead' };
  const frame = chartFrame(width, Math.max(280, Math.round(width * 0.45)), x, errorAxis({ models }, lines));
  const at = ({ rmse }, index) => `${fixed(rmse, 2)} at ${seconds(ahead[index])}`;
  const told = lines.map(({ name, figures }) => `${name} ${figures.map(at).join(', ')}`);
  const label = `Root mean square error over seconds ahead, in m/s. ${told.join('; ') || 'No line is shown'}.`;
  // The baselines first, so that the models lie above them.
  const nodes = [...lines].reverse().flatMap((line) => errorLine(line, ahead, frame));
  const { left, right, top, bottom } = frame.box;
  const border = svg('path', { class: 'axis', fill: 'none', d: `M${left} ${top}V${bottom}H${right}` });
  const drawn = picture(frame, label, [...frame.axes, border, ...nodes]);
  const beyond = lines.filter(({ figures }) => figures.some(({ rmse }) => rmse > frame.range.y.high || Number.isNaN(rmse)));
  const words = `Beyond the axis or without a number at some horizon: ${beyond.map(({ name }) => name).join(', ')}.`;
  const caption = beyond.length > 0 ? [el('figcaption', {}, words)] : [];
  return [hoverable(frame, drawn, (horizon) => errorsTold(lines, ahead, horizon)), ...caption];
}

/** The legend, whose entries switch their lines. */
function linePicker({ models }, shown, onChange) {
  const chips = models.map(({ name, look }) => {
    const input = el('input', { type: 'checkbox', autocomplete: 'off', ...(shown.has(name) ? { checked: '' } : {}) });
    input.addEventListener('change', () => {
      if (input.checked) shown.add(name);
      else shown.delete(name);
      onChange();
    });
    const sample = svg('svg', { width: 26, height: 12, viewBox: '0 0 26 12', 'aria-hidden': 'true' });
    const line = svg('path', { d: 'M0 6H26', 'stroke-width': 2, 'stroke-dasharray': DASHES[look.kind] });
    const mark = markerNode(look.shape, [[13, 6]], AHEAD.radius, look.colour, look.hollow);
    sample.append(coloured(line, 'stroke', look.colour), mark);
    return el('label', { class: 'chip' }, input, sample, name);
  });
  byId('horizons-picker').append(...chips);
}

// ---------------------------------------------------------------- tables

function errorTable({ ahead, models }) {
  const printed = (rmse) => Number(rmse.toFixed(3));
  const errors = (k) => models.map(({ figures }) => figures[k].rmse).filter(Number.isFinite);
  const best = ahead.map((_, k) => Math.min(...errors(k).map(printed)));
  const columns = [
    ...ahead.map((at, k) => ({ label: seconds(at), value: ({ figures }) => figures[k].rmse, digits: 3, best: best[k] })),
    { label: 'Fit', unit: 's', value: ({ fitS }) => fitS, digits: 1 },
    { label: 'Predict', unit: 's', value: ({ predictS }) => predictS, digits: 1 },
  ];
  const cell = (model) => ({ value, digits, best: least }) => {
    const shown = fixed(value(model), digits);
    return el('td', {}, printed(value(model)) === least ? el('span', { class: 'best' }, shown) : shown);
  };
  const row = (model) => ({ model, node: el('tr', {}, el('th', { scope: 'row' }, model.name), ...columns.map(cell(model))) });
  const bodies = [false, true].map((isBaseline) => {
    const rows = models.filter((model) => model.isBaseline === isBaseline).map(row);
    const title = el('tr', {}, el('th', { scope: 'rowgroup', colspan: columns.length + 1 }, isBaseline ? 'Baselines' : 'Models'));
    const kind = isBaseline ? 'baselines' : 'models';
    return { rows, title, node: el('tbody', { class: kind }, title, ...rows.map(({ node }) => node)) };
  });
  const headings = columns.map((column) => {
    const node = columnHeading(column, () => {
      const descending = markSorted(headings, node, false);
      for (const { rows, title, node: body } of bodies) {
        body.append(title, ...sortRows(rows, ({ model }) => column.value(model), descending).map((one) => one.node));
      }
    });
    return node;
  });
  const filled = bodies.filter(({ rows }) => rows.length > 0).map(({ node }) => node);
  return tableBox('RMSE by seconds ahead', [el('tr', {}, heading('Model', 'text corner'), ...headings)], filled);
}

function verdictTable(verdicts, { ahead, models }) {
  const skill = (row) => models.find(({ name }) => name === row.model)?.figures[ahead.indexOf(row.ahead)]?.skill ?? NaN;
  const interval = ({ low, high }) => (Number.isFinite(low + high) ? `${signed(low, 3)} to ${signed(high, 3)}` : '–');
  return sortableTable(
    'Best model against best baseline',
    [
      { label: 'Ahead', value: (row) => seconds(row.ahead) },
      { label: 'Model', value: ({ model }) => model },
      { label: 'Baseline', value: ({ baseline }) => baseline },
      { label: 'Difference', unit: 'RMSE, m/s', value: ({ difference }) => difference, digits: 3 },
      { label: 'Difference of squares', unit: '95 % interval, (m/s)²', value: interval },
      { label: 'Below persistence', unit: '%', value: skill, digits: 1 },
      { label: 'Verdict', value: ({ verdict }) => verdict },
    ],
    verdicts,
  );
}

function coverageTable({ ahead, models }) {
  const banded = models.filter(({ figures }) => figures.some(({ coverage }) => Number.isFinite(coverage)));
  if (banded.length === 0) return note('No model has a band.');
  const groups = ahead.map((at) => el('th', { scope: 'colgroup', colspan: 3 }, `${seconds(at)} ahead`));
  const columns = () => [
    el('th', { scope: 'col' }, 'inside', el('small', {}, '%')),
    el('th', { scope: 'col' }, 'half width', el('small', {}, 'm/s')),
    el('th', { scope: 'col' }, 'score', el('small', {}, '% of one width')),
  ];
  const cells = ({ coverage, half, score }) => [
    el('td', {}, fixed(coverage, 1)),
    el('td', {}, fixed(half, 2)),
    el('td', {}, Number.isFinite(score) ? signed(score, 1) : '–'),
  ];
  const rows = banded.map(({ name, figures }) => el('tr', {}, el('th', { scope: 'row' }, name), ...figures.flatMap(cells)));
  const head = [el('tr', {}, el('td'), ...groups), el('tr', {}, heading('Model', 'text corner'), ...ahead.flatMap(columns))];
  return tableBox('90 % intervals by seconds ahead: mean half width, and interval score beside intervals of one width', head, [el('tbody', {}, ...rows)], rows.length > TALL_ROWS);
}

function horizonSection({ horizons, verdicts, leftOut }) {
  if (horizons.ahead.length === 0 || horizons.models.length === 0) {
    byId('horizons-picker').hidden = true;
    document.querySelectorAll('#horizons > section').forEach((section) => {
      section.hidden = true;
    });
    return absent('horizons', 'The document has no errors by seconds ahead (horizons).');
  }
  const shown = new Set(horizons.models.filter((model) => !model.isTrial).map(({ name }) => name));
  const figure = el('figure');
  const draw = () => figure.replaceChildren(...errorFigure(horizons, shown, chartWidth(figure, AHEAD.most)));
  linePicker(horizons, shown, draw);
  byId('horizons-body').append(figure);
  const remarks = leftOut.map(([name, reason]) => note(`${name} is left out: ${reason}.`));
  const compared = verdicts.length > 0 ? verdictTable(verdicts, horizons) : note('The document has no verdicts.');
  byId('horizons-errors-body').append(errorTable(horizons), ...remarks);
  byId('horizons-verdicts-body').append(compared);
  byId('horizons-coverage-body').append(coverageTable(horizons));
  return draw;
}
