// ---------------------------------------------------------------- the trajectory document

const SCHEMA = 'drivekit/evaluate/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'horizons', 'models', 'baselines', 'verdicts', 'trials', 'curves'];
const KNOWLEDGE = [
  { key: 'expected', label: 'limits, stops' },
  { key: 'known', label: 'also where the driver slowed down' },
];

const megajoules = (energyJ) => number(energyJ) / 1e6;

function readTrajectory(source) {
  const doc = object(source);
  return {
    ...readFrame(doc, SCHEMA_KEYS),
    drives: number(doc.drives),
    units: list(doc.units).length,
    origins: number(doc.origins),
    bandKmh: number(doc.band_kmh),
    horizons: readHorizons(doc),
    verdicts: list(doc.verdicts).map(object).map(readVerdict),
    leftOut: Object.entries(object(doc.left_out)).map(([name, reason]) => [name, text(reason)]),
    trials: list(doc.trials).map(object).filter(({ trial }) => Number.isFinite(trial)),
    freeRun: doc.free_run ? readFreeRun(object(doc.free_run)) : null,
    curves: readCurves(object(doc.curves)),
  };
}

function readVerdict(raw) {
  const [low, high] = list(raw.square_difference_interval).map(number);
  return {
    ahead: number(raw.horizon_s),
    model: text(raw.model),
    baseline: text(raw.baseline),
    difference: number(raw.difference_mps),
    low: low ?? NaN,
    high: high ?? NaN,
    verdict: text(raw.verdict),
  };
}

function readCurves(raw) {
  const motion = (source) => ({
    speed: Float64Array.from(list(object(source).speed_mps), kmh),
    distance: Float64Array.from(list(object(source).distance_m), (value) => number(value) / 1000),
  });
  const run = raw.free_run ? object(raw.free_run) : null;
  return {
    shown: readDrive(raw.shown),
    learnt: readDrive(raw.learnt),
    predicted: list(raw.predicted).map(object).map((one) => ({ trial: number(one.trial), speed: Float64Array.from(list(one.speed_mps), kmh) })),
    freeRun: run && { name: text(run.name), measured: motion(run.measured), predicted: motion(run.predicted) },
  };
}

// ---------------------------------------------------------------- Table 4.1

function trialTable({ trials, bandKmh }) {
  const columns = [
    { label: 'Trial', value: ({ trial }) => String(trial) },
    { label: 'E', unit: 'MJ', value: ({ energy_j }) => megajoules(energy_j), digits: 3 },
    { label: 'ΔE', unit: 'MJ', value: ({ energy_difference_j }) => megajoules(energy_difference_j), digits: 3 },
    { label: '√SSE / n, v', unit: 'km/h per sample', value: ({ sqrt_sse_speed_mps }) => kmh(sqrt_sse_speed_mps), digits: 3 },
    { label: '√SSE / n, a', unit: 'm/s² per sample', value: ({ sqrt_sse_accel_mps2 }) => number(sqrt_sse_accel_mps2), digits: 4 },
    { label: 'In the band', unit: `${fixed(bandKmh, 1)} km/h wide, %`, value: ({ in_band_pct }) => number(in_band_pct), digits: 1 },
    { label: 'RMSE', unit: 'km/h', value: ({ rmse_mps }) => kmh(rmse_mps), digits: 2 },
    { label: 'Distance', unit: 'off by, %', value: ({ abs_distance_error_pct }) => number(abs_distance_error_pct), digits: 1 },
    { label: 'Model', value: ({ trial }) => member(TRIALS, trial)?.name ?? '', wraps: true },
  ];
  return sortableTable('Table 4.1', columns, trials);
}

const SOLVED = [
  { label: 'Samples', value: (fit) => fixed(number(fit.samples), 0) },
  { label: 'Predictors', value: (fit) => fixed(number(fit.predictors), 0) },
  { label: 'C', value: (fit) => significant(fit.box_constraint) },
  { label: 'ε', value: (fit) => significant(fit.tube_epsilon) },
  { label: 'Status', value: (fit) => text(fit.status) || '–' },
  { label: 'Support vectors', value: (fit) => fixed(number(fit.support_vectors), 0) },
  { label: 'Duality gap', unit: 'of the objective', value: (fit) => scientific(number(fit.duality_gap) / Math.abs(number(fit.primal_objective))) },
  { label: 'KKT residual', value: (fit) => scientific(number(fit.kkt_residual)) },
  { label: 'RMSE', unit: 'held out, m/s', value: (fit) => fixed(number(fit.hold_out_rmse_mps), 3) },
  { label: 'Time', unit: 's', value: (fit) => fixed(number(fit.seconds), 2) },
];

const significant = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(3))) : '–');
const scientific = (value) => (Number.isFinite(value) ? value.toExponential(1).replaceAll('-', '\u2212') : '–');

function solvedTable(trials) {
  const head = el('tr', {}, heading('Trial, fold', 'text corner'), ...SOLVED.map(({ label, unit }) => el('th', { scope: 'col' }, label, el('small', {}, unit ?? ''))));
  const row = (trial) => (fit, index) => {
    const cells = SOLVED.map(({ value }) => el('td', {}, value(object(fit))));
    return el('tr', {}, el('th', { scope: 'row' }, `${trial}, ${index + 1}`), ...cells);
  };
  const rows = trials.flatMap(({ trial, fits }) => list(fits).map(row(trial)));
  return tableBox('How the regressions were solved', [head], [el('tbody', {}, ...rows)]);
}

function trialSection(report) {
  const { trials } = report;
  byId('solved').hidden = trials.length === 0;
  if (trials.length === 0) return absent('trials', 'Some drive has no limits, so that the trials of the thesis are left out.');
  const [{ measured_energy_j: measuredJ, trips }] = trials;
  const count = list(trips).length;
  const words = [
    `Measured: ${quantity(megajoules(measuredJ), 3, 'MJ')} on ${plural(count, 'drive')}; E is the sum over them, ΔE measured less predicted.`,
    'The other columns are means over drives. The band lies around the measured speed.',
  ];
  byId('trials-body').append(trialTable(report), note(words.join(' ')));
  byId('solved-body').append(solvedTable(trials));
  return () => {};
}

// ---------------------------------------------------------------- free run

const ERRORS = [
  { key: 'distance', label: 'Distance', trip: 'distance_error_pct' },
  { key: 'energy', label: 'Energy', trip: 'energy_error_pct' },
  { key: 'time_at_distance', label: 'Time at equal distance', trip: 'time_at_distance_error_pct' },
  { key: 'energy_at_distance', label: 'Energy at equal distance', trip: 'energy_at_distance_error_pct' },
];

function readFreeRun(raw) {
  const rows = KNOWLEDGE.map(({ key, label }) => ({ label, figures: object(raw[key]), trips: list(object(raw[key]).by_trip).map(object) }));
  return { rows, leftOut: Object.entries(object(raw.left_out)).map(([log, reason]) => [log, text(reason)]) };
}

function freeRunTable({ rows }) {
  const groups = ERRORS.map(({ label }) => el('th', { scope: 'colgroup', colspan: 3 }, label));
  const names = ERRORS.flatMap(() => ['mean', 'magnitude', 'largest'].map((name) => el('th', { scope: 'col' }, name, el('small', {}, '%'))));
  const cells = (errors) => {
    const [bias, size, largest] = ['mean_pct', 'mean_abs_pct', 'max_abs_pct'].map((key) => number(object(errors)[key]));
    return [signed(bias, 1), fixed(size, 1), fixed(largest, 1)].map((cell) => el('td', {}, cell));
  };
  const row = ({ label, figures }) => {
    const trips = el('td', {}, fixed(number(figures.trips), 0));
    return el('tr', {}, el('th', { scope: 'row' }, label), trips, ...ERRORS.flatMap(({ key }) => cells(figures[key])));
  };
  const head = [
    el('tr', {}, el('td', { colspan: 2 }), ...groups),
    el('tr', {}, heading('The road knows', 'text corner'), heading('Trips'), ...names),
  ];
  return tableBox('Errors of the free run', head, [el('tbody', {}, ...rows.map(row))]);
}

function freeRunTrips({ label, trips }) {
  const columns = [
    { label: 'Log', value: ({ log }) => text(log) },
    { label: 'Time', unit: 'min', value: ({ duration_s }) => number(duration_s) / 60, digits: 1 },
    { label: 'Distance', unit: 'km', value: ({ distance_m }) => number(distance_m) / 1000, digits: 2 },
    { label: 'Energy', unit: 'kWh', value: ({ energy_j }) => kwh(energy_j), digits: 2 },
    ...ERRORS.map((error) => ({ label: error.label, unit: 'error, %', value: (trip) => number(trip[error.trip]), digits: 1 })),
  ];
  return sortableTable(`Free run by trip, ${label}`, columns, trips);
}

const PICTURES = [
  { title: 'Speed over distance', places: ({ distance }) => distance, unit: 'km', where: (at) => quantity(at, 2, 'km') },
  {
    title: 'Speed over time',
    places: ({ speed }) => Float64Array.from(speed, (_, index) => index / 60),
    unit: 'min',
    where: (at) => clock(60 * at),
  },
];

/** The speed at a place, between the samples beside it: the places ascend. */
function speedAt(places, speeds, at) {
  let above = places.findIndex((place) => place >= at);
  if (above < 0 || at < places[0]) return NaN;
  above = Math.max(above, 1);
  return linear(places[above - 1], places[above], speeds[above - 1], speeds[above])(at);
}

/** The trip of the pictures in the first row of the table. */
function freeRunCaption(run, { rows }) {
  const trip = rows[0].trips.find(({ log }) => log === run.name);
  const off = trip ? ` Distance off by ${signed(number(trip.distance_error_pct), 1)}\u00a0%, energy by ${signed(number(trip.energy_error_pct), 1)}\u00a0%.` : '';
  return `${run.name}, the road known with limits and stops.${off}`;
}

function freeRunFigure(run, freeRun, { title, places, unit, where }) {
  const lines = [
    { ...MEASURED, values: run.measured.speed, places: places(run.measured) },
    { ...PREDICTED, values: run.predicted.speed, places: places(run.predicted) },
  ];
  const x = { low: 0, high: Math.max(...lines.map((line) => extent(line.places).high)), unit };
  const y = speedAxis([run.measured.speed], run.predicted.speed);
  const told = (at) => {
    const row = (line) => `${line.name} ${quantity(speedAt(line.places, line.values, at), 1, 'km/h')}`;
    return [where(at), lines.map(row)];
  };
  const label = `${title} of ${run.name}, measured and predicted.`;
  const body = el('div');
  const node = el('figure', {}, el('h3', {}, title), body, lineLegend(lines), el('figcaption', {}, freeRunCaption(run, freeRun)));
  return { node, draw: () => body.replaceChildren(speedPicture({ label, lines, x, y, told }, chartWidth(body))) };
}

function freeRunSection({ freeRun, curves }) {
  const holders = ['free-run-figures', 'free-run-trips'].map(byId);
  holders.forEach((node) => {
    node.hidden = freeRun === null;
  });
  if (freeRun === null) return absent('free-run', 'Too few drives have limits and are long enough for a free run.');
  const remark = 'Predicted less measured. Distance and energy at equal time, up to 15\u00a0min; “mean” keeps the signs, “magnitude” does not.';
  const leftOut = freeRun.leftOut.map(([log, reason]) => note(`${log} is left out: ${reason}.`));
  byId('free-run-body').append(freeRunTable(freeRun), note(remark), ...leftOut);
  const tables = freeRun.rows.filter(({ trips }) => trips.length > 0);
  byId('free-run-trips').append(
    ...tables.map((row) => collapsible(`By trip: ${row.label}`, plural(row.trips.length, 'trip'), () => freeRunTrips(row))),
  );
  const run = curves.freeRun;
  const figures = run && run.measured.speed.length > 1 && run.predicted.speed.length > 1 ? PICTURES.map((one) => freeRunFigure(run, freeRun, one)) : [];
  byId('free-run-figures').append(...figures.map(({ node }) => node));
  byId('free-run-figures').hidden = figures.length === 0;
  return () => figures.forEach(({ draw }) => draw());
}

// ---------------------------------------------------------------- main

function verdictWords({ horizons, verdicts }) {
  const last = verdicts.at(-1);
  if (!last) return '';
  const index = horizons.ahead.indexOf(last.ahead);
  const skill = horizons.models.find(({ name }) => name === last.model)?.figures[index]?.skill ?? NaN;
  const below = Number.isFinite(skill) ? `, ${quantity(Math.abs(skill), 0, '%')} ${skill < 0 ? 'above' : 'below'} the error of persistence` : '';
  return ` The best model at ${seconds(last.ahead)} is ${last.model}${below}.`;
}

function introduce(report) {
  const { horizons, drives, units, origins } = report;
  byId('version').append(report.version);
  const held = Number.isFinite(units) && units > 0 ? `, each of ${plural(units, 'unit')} held out once` : '';
  byId('headline').append(`${plural(drives, 'drive')}, ${plural(origins, 'moment')} to predict from${held}.${verdictWords(report)}`);
  const best = horizons.ahead.map((ahead, index) => [ahead, bestAt(horizons, index, ({ isBaseline }) => !isBaseline)?.figures[index].rmse]);
  const facts = best.filter(([, rmse]) => Number.isFinite(rmse)).slice(0, 6);
  byId('facts').hidden = facts.length === 0;
  byId('facts').append(...facts.map(([ahead, rmse]) => fact(`Best model at ${seconds(ahead)}`, fixed(rmse, 2), 'm/s')));
}

function main() {
  const report = readTrajectory(parseDocument());
  introduce(report);
  problems(report, SCHEMA);
  const draws = [horizonSection, trialSection, figureSection, freeRunSection].map((section) => section(report));
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  keepDrawn(() => draws.forEach((draw) => draw()));
}

main();
