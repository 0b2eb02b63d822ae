// ---------------------------------------------------------------- the calibration document

const SCHEMA = 'drivekit/calibrate/1';
const SCHEMA_KEYS = [
  ...['schema', 'version', 'config', 'inputs', 'vehicle'],
  ...['parameters', 'correlation', 'trips', 'summary', 'residuals'],
];
const STAGES = [
  ['start', 'Before'],
  ['fitted', 'Fitted'],
  ['held_out', 'Held out'],
];

function readCalibration(source) {
  const doc = object(source);
  const correlation = object(doc.correlation);
  return {
    ...readFrame(doc, SCHEMA_KEYS),
    vehicle: text(doc.vehicle),
    parameters: list(doc.parameters).map(readParameter),
    correlation: {
      keys: list(correlation.keys).map(text),
      matrix: list(correlation.matrix).map((row) => list(row).map(number)),
    },
    trips: list(doc.trips).map(readTrip),
    leftOut: list(doc.left_out_drives).map((raw) => `${text(object(raw).log)} (${text(object(raw).reason)})`),
    summary: object(doc.summary),
    residuals: object(doc.residuals),
  };
}

function readParameter(source) {
  const raw = object(source);
  const interval = list(raw.ci95).map(number);
  return {
    key: text(raw.key) || 'not named',
    unit: text(raw.unit),
    start: number(raw.start),
    value: number(raw.value),
    bounds: [number(raw.lower), number(raw.upper)],
    stdError: number(raw.std_error),
    interval: interval.length === 2 && interval.every(Number.isFinite) ? interval : null,
    identified: raw.identified === true,
    remark: text(raw.remark),
    sensitivity: number(raw.sensitivity),
  };
}

function readTrip(source) {
  const raw = object(source);
  return {
    name: text(raw.name) || 'not named',
    measuredKwh: kwh(raw.measured_terminal_energy_j),
    powerKw: kilowatts(raw.mean_power_w),
    ambientC: number(raw.ambient_degc),
    startPct: number(raw.start_error_pct),
    fittedPct: number(raw.fitted_error_pct),
    heldOutPct: number(raw.held_out_error_pct),
    fittedKw: kilowatts(raw.fitted_power_rmse_w),
    heldOutKw: kilowatts(raw.held_out_power_rmse_w),
  };
}

// ---------------------------------------------------------------- before and after

const FIGURES = [
  { label: 'Mean absolute error', unit: 'per trip, %', shown: (s) => fixed(number(s.mean_abs_error_pct), 2) },
  { label: 'Error of the sum', unit: '%', shown: (s) => signed(number(s.total_error_pct), 2) },
  { label: 'Median power RMSE', unit: 'kW', shown: (s) => fixed(kilowatts(s.median_power_rmse_w), 3) },
];

const stage = (report, key) => object(member(report.summary, key));
const meanError = (report, key) => number(stage(report, key).mean_abs_error_pct);

function summaryTable(report) {
  const column = ({ label, unit }) => el('th', { scope: 'col' }, label, el('small', {}, unit));
  const row = ([key, name]) => {
    const cells = FIGURES.map(({ shown }) => el('td', {}, shown(stage(report, key))));
    return el('tr', {}, el('th', { scope: 'row' }, name), ...cells);
  };
  const head = el('tr', {}, heading('Parameters', 'text corner'), ...FIGURES.map(column));
  return tableBox('Before and after', [head], [el('tbody', {}, ...STAGES.map(row))]);
}

// ---------------------------------------------------------------- trips

const TRIP_COLUMNS = [
  { label: 'Trip', value: (trip) => trip.name },
  { label: 'Measured', unit: 'kWh', value: (trip) => trip.measuredKwh, digits: 3 },
  { label: 'Mean power', unit: 'kW', value: (trip) => trip.powerKw, digits: 2, optional: true },
  { label: 'Outside', unit: '°C', value: (trip) => trip.ambientC, digits: 1, optional: true },
  { label: 'Error', unit: 'before, %', value: (trip) => trip.startPct, digits: 1, optional: true },
  { label: 'Error', unit: 'fitted, %', value: (trip) => trip.fittedPct, digits: 1 },
  { label: 'Error', unit: 'held out, %', value: (trip) => trip.heldOutPct, digits: 1 },
  { label: 'Power RMSE', unit: 'fitted, kW', value: (trip) => trip.fittedKw, digits: 2 },
  { label: 'Power RMSE', unit: 'held out, kW', value: (trip) => trip.heldOutKw, digits: 2 },
];

/** What only some documents have gets a column where a trip has it. */
function tripTable({ trips, leftOut }) {
  const columns = TRIP_COLUMNS.filter(({ optional, value }) => !optional || trips.some((trip) => Number.isFinite(value(trip))));
  const left = leftOut.length > 0 ? [note(`Left out: ${leftOut.join(', ')}.`)] : [];
  return [...(trips.length > 0 ? [sortableTable('Errors by trip', columns, trips)] : []), ...left];
}

const DOTS = { top: 8, bottom: 40, right: 14, most: 60 };

/** A row per trip in the order of the held-out error: a dot for it, and a ring for the error with the trip in the fit. */
function dotPlot(trips, width) {
  const shown = sortRows(trips, (trip) => (Number.isNaN(trip.heldOutPct) ? trip.fittedPct : trip.heldOutPct), false);
  const named = shown.length <= DOTS.most;
  const pitch = named ? 20 : 7;
  const left = named ? Math.min(width * 0.36, 8 + 7 * Math.max(...shown.map((trip) => trip.name.length))) : 10;
  const errors = shown.flatMap((trip) => [trip.heldOutPct, trip.fittedPct]).filter(Number.isFinite);
  const [low, high] = [Math.min(0, ...errors), Math.max(0, ...errors)];
  const margin = (high - low || 1) * 0.04;
  const x = linear(low - margin, high + margin, left, width - DOTS.right);
  const bottom = DOTS.top + shown.length * pitch;
  const marks = ticks(low - margin, high + margin, Math.max(3, (width - left) / 60));
  const grid = ({ value, label }) => [
    svg('line', { class: value === 0 ? 'axis' : 'grid', x1: x(value), x2: x(value), y1: DOTS.top, y2: bottom }),
    svg('text', { x: x(value), y: bottom + 16, 'text-anchor': 'middle' }, label),
  ];
  const row = (trip, index) => tripDots(trip, DOTS.top + (index + 0.5) * pitch, x, { left, named });
  const height = bottom + DOTS.bottom;
  return svg(
    'svg',
    { viewBox: `0 0 ${width} ${height}`, width, height, role: 'img', 'aria-label': 'Error of each trip' },
    ...marks.flatMap(grid),
    ...shown.flatMap(row),
    svg('text', { x: (left + width - DOTS.right) / 2, y: bottom + 34, 'text-anchor': 'middle' }, 'Error of the energy, %'),
  );
}

function tripDots(trip, y, x, { left, named }) {
  const [fitted, heldOut] = [trip.fittedPct, trip.heldOutPct];
  const title = svg('title', {}, `${trip.name}: held out ${signed(heldOut, 2)} %, fitted ${signed(fitted, 2)} %`);
  const parts = [title];
  if (named) parts.push(svg('text', { x: left - 10, y: y + 4, 'text-anchor': 'end' }, shorten(trip.name, (left - 10) / 6.6)));
  if (Number.isFinite(heldOut + fitted)) parts.push(svg('line', { class: 'cut', x1: x(fitted), x2: x(heldOut), y1: y, y2: y }));
  if (Number.isFinite(fitted)) parts.push(svg('circle', { class: 'ring', cx: x(fitted), cy: y, r: named ? 3.5 : 2.5 }));
  if (Number.isFinite(heldOut)) parts.push(svg('circle', { class: 'dot', cx: x(heldOut), cy: y, r: named ? 4 : 3 }));
  return [svg('g', {}, ...parts)];
}

function drawTrips(report) {
  const body = byId('trips-body');
  if (report.trips.length === 0) return body.replaceChildren(note('The document has no trips.'));
  const width = Math.min(Math.max(Math.floor(body.clientWidth), 280), 900);
  const errors = report.trips.map((trip) => trip.heldOutPct).filter(Number.isFinite);
  const within = errors.filter((error) => Math.abs(error) <= 5).length;
  const count = `Held out, ${fixed(within, 0)} of ${plural(errors.length, 'trip')} are within 5\u00a0% of the measurement.`;
  const order = 'In the order of the error held out (dots); rings: with the trip in the fit.';
  const caption = errors.length > 0 ? `${order} ${count}` : 'Rings: with the trip in the fit. No trip was held out.';
  return body.replaceChildren(el('figure', {}, dotPlot(report.trips, width), el('figcaption', {}, caption)));
}

// ---------------------------------------------------------------- main

function introduce(report) {
  byId('version').append(report.version);
  const vague = report.parameters.filter((parameter) => !parameter.identified);
  const [before, fitted, heldOut] = STAGES.map(([key]) => meanError(report, key));
  const count = report.parameters.length;
  const fit = `${plural(count, 'parameter')} of ${report.vehicle || 'a vehicle'}`;
  const sentences = [`${fit} fitted to the measured power of ${plural(report.trips.length, 'trip')}.`];
  if (Number.isFinite(before + fitted)) {
    const unseen = Number.isFinite(heldOut) ? `, and to ${quantity(heldOut, 1, '%')} on trips held out of the fit` : '';
    const change = `from ${quantity(before, 1, '%')} to ${quantity(fitted, 1, '%')}${unseen}`;
    sentences.push(`The mean absolute error of the energy of a trip goes ${change}.`);
  }
  if (vague.length > 0) {
    const names = vague.map((parameter) => parameter.key).join(', ');
    sentences.push(`The data do not identify ${fixed(vague.length, 0)} of them, which keep their values: ${names}.`);
  }
  byId('headline').append(sentences.join(' '));
  byId('facts').append(
    fact('Trips', fixed(report.trips.length, 0)),
    fact('Error before', fixed(before, 1), '%'),
    fact('Error fitted', fixed(fitted, 1), '%'),
    fact('Error held out', fixed(heldOut, 1), '%'),
    fact('Power RMSE held out', fixed(kilowatts(stage(report, 'held_out').median_power_rmse_w), 2), 'kW'),
    fact('Parameters identified', [count - vague.length, count].map((some) => fixed(some, 0)).join(' of ')),
  );
}

function main() {
  const report = readCalibration(parseDocument());
  introduce(report);
  problems(report, SCHEMA);
  const summarised = STAGES.some(([key]) => Object.keys(stage(report, key)).length > 0);
  byId('summary-body').append(summarised ? summaryTable(report) : note('The document has no summary.'));
  parameterSection(report);
  correlationSection(report);
  byId('trips-table').append(...tripTable(report));
  byId('residuals-table').append(...residualTables(report));
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  keepDrawn(() => {
    drawSensitivity(report);
    drawTrips(report);
    drawResiduals(report);
  });
}

main();
