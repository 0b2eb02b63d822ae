// ---------------------------------------------------------------- the trajectory document

const SCHEMA = 'drivekit/evaluate/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'horizons', 'models', 'baselines', 'verdicts', 'trials', 'curves'];

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
  const prediction = (one) => ({ trial: number(one.trial), speed: Float64Array.from(list(one.speed_mps), kmh) });
  return {
    shown: readDrive(raw.shown),
    learnt: readDrive(raw.learnt),
    predicted: list(raw.predicted).map(object).map(prediction),
    freeRun: run && { name: text(run.name), measured: motion(run.measured), predicted: motion(run.predicted) },
  };
}

// ---------------------------------------------------------------- Table 4.1

function trialTable({ trials, bandKmh }) {
  const band = `${fixed(bandKmh, 1)} km/h wide, %`;
  const columns = [
    { label: 'Trial', value: ({ trial }) => String(trial) },
    { label: 'E', unit: 'MJ', value: ({ energy_j }) => megajoules(energy_j), digits: 3 },
    { label: 'ΔE', unit: 'MJ', value: ({ energy_difference_j }) => megajoules(energy_difference_j), digits: 3 },
    { label: '√SSE / n, v', unit: 'km/h per sample', value: ({ sqrt_sse_speed_mps }) => kmh(sqrt_sse_speed_mps), digits: 3 },
    { label: '√SSE / n, a', unit: 'm/s² per sample', value: ({ sqrt_sse_accel_mps2 }) => number(sqrt_sse_accel_mps2), digits: 4 },
    { label: 'In the band', unit: band, value: ({ in_band_pct }) => number(in_band_pct), digits: 1 },
    { label: 'RMSE', unit: 'km/h', value: ({ rmse_mps }) => kmh(rmse_mps), digits: 2 },
    { label: 'Distance', unit: 'off by, %', value: ({ abs_distance_error_pct }) => number(abs_distance_error_pct), digits: 1 },
    { label: 'Model', value: ({ trial }) => member(TRIALS, trial)?.name ?? '', wraps: true },
  ];
  return sortableTable('Table 4.1', columns, trials);
}

const relativeGap = (fit) => number(fit.duality_gap) / Math.abs(number(fit.primal_objective));

const SOLVED = [
  { label: 'Samples', value: (fit) => fixed(number(fit.samples), 0) },
  { label: 'Predictors', value: (fit) => fixed(number(fit.predictors), 0) },
  { label: 'C', value: (fit) => significant(fit.box_constraint) },
  { label: 'ε', value: (fit) => significant(fit.tube_epsilon) },
  { label: 'Status', value: (fit) => text(fit.status) || '–' },
  { label: 'Support vectors', value: (fit) => fixed(number(fit.support_vectors), 0) },
  { label: 'Duality gap', unit: 'of the objective', value: (fit) => scientific(relativeGap(fit)) },
  { label: 'KKT residual', value: (fit) => scientific(number(fit.kkt_residual)) },
  { label: 'RMSE', unit: 'held out, m/s', value: (fit) => fixed(number(fit.hold_out_rmse_mps), 3) },
  { label: 'Time', unit: 's', value: (fit) => fixed(number(fit.seconds), 2) },
];

function solvedTable(trials) {
  const titles = SOLVED.map(({ label, unit }) => el('th', { scope: 'col' }, label, el('small', {}, unit ?? '')));
  const head = el('tr', {}, heading('Trial, fold', 'text corner'), ...titles);
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
  const [{ measured_energy_j: measuredJ, by_trip: trips }] = trials;
  const count = list(trips).length;
  const words = [
    `Measured: ${quantity(megajoules(measuredJ), 3, 'MJ')} on ${plural(count, 'drive')}.`,
    'E is the sum over them, ΔE measured less predicted.',
    'The other columns are means over drives. The band lies around the measured speed.',
  ];
  byId('trials-body').append(trialTable(report), note(words.join(' ')));
  byId('solved-body').append(solvedTable(trials));
  return () => {};
}

// ---------------------------------------------------------------- main

function verdictWords({ horizons, verdicts }) {
  const last = verdicts.at(-1);
  if (!last) return '';
  const index = horizons.ahead.indexOf(last.ahead);
  const skill = horizons.models.find(({ name }) => name === last.model)?.figures[index]?.skill ?? NaN;
  const share = `${quantity(Math.abs(skill), 0, '%')} ${skill < 0 ? 'above' : 'below'}`;
  const words = Number.isFinite(skill) ? `, ${share} the error of persistence` : '';
  return ` The best model at ${seconds(last.ahead)} is ${last.model}${words}.`;
}

function introduce(report) {
  const { horizons, drives, units, origins } = report;
  byId('version').append(report.version);
  const held = Number.isFinite(units) && units > 0 ? `, each of ${plural(units, 'unit')} held out once` : '';
  byId('headline').append(`${plural(drives, 'drive')}, ${plural(origins, 'moment')} to predict from${held}.${verdictWords(report)}`);
  const fitted = ({ isBaseline }) => !isBaseline;
  const best = horizons.ahead.map((ahead, index) => [ahead, bestAt(horizons, index, fitted)?.figures[index].rmse]);
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
