// ---------------------------------------------------------------- scores

const energyError = (key) => (summary) => kilojoules(object(summary.energy_error_j)[key]);

const SUMMARY_COLUMNS = [
  { label: 'Phases', value: (s) => number(s.phases), digits: 0 },
  { label: 'RMSE', unit: 'mean, km/h', value: (s) => kmh(s.rmse_mps), digits: 2, better: 'low' },
  { label: 'RMSE', unit: 'median, km/h', value: (s) => kmh(s.rmse_median_mps), digits: 2, better: 'low' },
  { label: '√SSE / n', unit: 'km/h', value: (s) => kmh(s.sqrt_sse_per_sample_mps), digits: 3, better: 'low' },
  { label: 'In band', unit: '%', value: (s) => number(s.in_band_pct), digits: 1, better: 'high' },
  { label: 'Out of band', unit: '%', value: (s) => number(s.out_of_band_pct), digits: 1, better: 'low' },
  { label: 'Energy diff.', unit: 'mean, kJ', value: energyError('mean'), digits: 2, better: 'zero' },
  { label: 'Energy diff.', unit: 'median, kJ', value: energyError('median'), digits: 2, better: 'zero' },
  { label: 'Energy diff.', unit: 'mean abs., kJ', value: energyError('mean_abs'), digits: 2, better: 'low' },
  { label: 'Final speed', unit: 'error, km/h', value: (s) => kmh(s.final_speed_error_mps), digits: 2, better: 'zero' },
  { label: 'Fit', unit: 's', value: (s) => number(s.fit_seconds), digits: 3 },
  { label: 'Predict', unit: 's', value: (s) => number(s.predict_seconds), digits: 3 },
];

const METRICS = [
  { label: 'RMSE, km/h', value: (s) => kmh(s.rmse_mps), digits: 2, better: 'low' },
  { label: 'In band, %', value: (s) => number(s.in_band_pct), digits: 1, better: 'high' },
];

/** What to minimise so that the best value comes first. */
function cost(value, better) {
  if (better === 'high') return -value;
  return better === 'zero' ? Math.abs(value) : value;
}

/** The best of the values as they are printed, so that a tie on the page is a tie; null without an order. */
function bestCost(values, { better, digits }) {
  const costs = values.filter(Number.isFinite).map((value) => cost(Number(value.toFixed(digits)), better));
  return better === undefined || costs.length === 0 ? null : Math.min(...costs);
}

function valueCell(value, column, best, kind = '') {
  const isBest = best !== null && cost(Number(value.toFixed(column.digits)), column.better) === best;
  const shown = fixed(value, column.digits);
  return el('td', { class: kind }, isBest ? el('span', { class: 'best' }, shown) : shown);
}

function summaryRow(model, columns) {
  const name = el('th', { scope: 'row' }, swatch(model.colour), model.name);
  const knows = el('td', { class: 'text' }, text(model.summary.knows) || '–');
  const cells = columns.map((column) => valueCell(column.value(model.summary), column, column.best));
  return el('tr', {}, name, knows, ...cells);
}

function summaryTable(report, label = 'Models and baselines') {
  const columns = SUMMARY_COLUMNS.map((column) => ({
    ...column,
    best: bestCost(
      report.models.map((model) => column.value(model.summary)),
      column,
    ),
  }));
  const bodies = [false, true].map((isBaseline) => {
    const rows = report.models
      .filter((model) => model.isBaseline === isBaseline)
      .map((model) => ({ model, node: summaryRow(model, columns) }));
    const title = el('tr', {}, el('th', { scope: 'rowgroup', colspan: columns.length + 2 }, isBaseline ? 'Baselines' : 'Models'));
    const node = el('tbody', { class: isBaseline ? 'baselines' : 'models' }, title, ...rows.map((row) => row.node));
    return { rows, title, node };
  });
  const key = (column) => (row) => column.value(row.model.summary);
  const headings = columns.map((column) => columnHeading(column, () => sortBy(column)));
  const sortBy = (column) => {
    const descending = markSorted(headings, headings[columns.indexOf(column)], column.better === 'high');
    for (const body of bodies) {
      body.node.append(body.title, ...sortRows(body.rows, key(column), descending).map((row) => row.node));
    }
  };
  sortBy(columns[1]);
  const head = el('tr', {}, heading('Model', 'text corner'), heading('Knows', 'text'), ...headings);
  const filled = bodies.filter((body) => body.rows.length > 0).map((body) => body.node);
  return tableBox(label, [head], filled);
}

/** A table of one metric, with a row per group or trip and a column per model; `score(row, model)` finds the summary. */
function scoreTable(label, rows, models, score, metric) {
  const shade = (model) => (model.isBaseline ? 'baseline' : '');
  const groups = [false, true].flatMap((isBaseline) => {
    const group = models.filter((model) => model.isBaseline === isBaseline);
    const attributes = { scope: 'colgroup', colspan: group.length, class: isBaseline ? 'baseline' : '' };
    return group.length > 0 ? [el('th', attributes, isBaseline ? 'Baselines' : 'Models')] : [];
  });
  const names = models.map((model) => heading(model.name, shade(model)));
  const head = [
    el('tr', {}, el('td', { colspan: 2 }), ...groups),
    el('tr', {}, heading(label, 'text corner'), heading('Phases'), ...names),
  ];
  const body = rows.map((row) => {
    const values = models.map((model) => metric.value(score(row, model)));
    const best = bestCost(values, metric);
    const counts = models.map((model) => number(score(row, model).phases)).filter(Number.isFinite);
    const phases = counts.length > 0 ? Math.max(...counts) : NaN;
    const cells = values.map((value, index) => valueCell(value, metric, best, shade(models[index])));
    return el('tr', {}, el('th', { scope: 'row' }, row), el('td', {}, fixed(phases, 0)), ...cells);
  });
  return tableBox(`${label}, ${metric.label}`, head, [el('tbody', {}, ...body)], rows.length > TALL_ROWS);
}

/** A score table under a choice of the metric. */
function scoreTables(id, label, rows, models, score) {
  const holder = el('div');
  const show = (metric) => holder.replaceChildren(scoreTable(label, rows, models, score, metric));
  show(METRICS[0]);
  return [radios('Metric', `${id}-metric`, METRICS, show), holder];
}

function groupResults(report) {
  const models = report.models.filter((model) => Object.keys(object(model.summary.groups)).length > 0);
  const groups = [...new Set(models.flatMap((model) => Object.keys(model.summary.groups)))];
  if (groups.length === 0) return [note('The document has no results by speed group (models.*.groups).')];
  groups.sort((a, b) => a.localeCompare(b, 'en', { numeric: true }));
  return scoreTables('groups', 'Group', groups, models, (group, model) => object(member(model.summary.groups, group)));
}

function tripResults(report) {
  const trips = [...new Set(report.folds.map((fold) => text(fold.held_out)))];
  if (trips.length === 0) return [note('The document has no results by held-out trip (folds).')];
  trips.sort((a, b) => a.localeCompare(b, 'en', { numeric: true }));
  const scores = new Map(report.folds.map((fold) => [`${text(fold.held_out)}\n${text(fold.model)}`, fold]));
  const score = (trip, model) => object(scores.get(`${trip}\n${model.name}`));
  const models = report.models.filter((model) => trips.some((trip) => scores.has(`${trip}\n${model.name}`)));
  return [...scoreTables('trips', `Held-out ${report.unit}`, trips, models, score), foldDetails(report)];
}

function foldDetails({ folds, unit }) {
  const noteworthy = folds.filter((fold) => list(fold.notes).length > 0 || Object.keys(object(fold.parameters)).length > 0);
  if (noteworthy.length === 0) return note('No fitted parameters or notes were recorded.');
  const notes = folds.reduce((sum, fold) => sum + list(fold.notes).length, 0);
  const title = 'Fitted parameters and notes';
  const row = (fold) => {
    const remarks = list(fold.notes).map(text).join('; ');
    return [text(fold.held_out), text(fold.model), el('code', {}, parameters(fold.parameters)), remarks];
  };
  const headings = [`Held-out ${unit}`, 'Model', 'Parameters', 'Notes'];
  return collapsible(title, plural(notes, 'note'), () => textTable(title, headings, noteworthy.map(row)));
}

function parameters(source) {
  const short = (_, value) => (typeof value === 'number' ? Number(value.toPrecision(5)) : value);
  return Object.entries(object(source))
    .map(([name, value]) => `${name} = ${JSON.stringify(value, short)}`)
    .join(', ');
}
