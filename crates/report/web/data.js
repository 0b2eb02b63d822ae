// ---------------------------------------------------------------- the evaluation document

const SCHEMA = 'drivekit/evaluate/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'models', 'baselines', 'folds', 'phases'];
const SHOWN_AT_FIRST = ['inverse', 'rise-time', 'profile'];
const SERIES_COLOURS = 8;

const kilojoules = (energyJ) => number(energyJ) / 1000;

function readReport(source) {
  const doc = object(source);
  const report = { ...readFrame(doc, SCHEMA_KEYS), ...readEvaluation(doc) };
  return {
    ...report,
    unit: ['trip', 'file', 'driver'].find((unit) => unit === doc.hold_out) ?? 'trip',
    braking: readBraking(doc.braking, report),
    whole: object(doc.whole_phases),
    fits: object(doc.function_fits),
    systems: object(doc.system_identification),
    cruise: object(doc.cruise),
    following: object(doc.following),
    learning: object(doc.learning_curve),
  };
}

/** What acceleration and braking both have. */
function readEvaluation(source) {
  const models = [...readSummaries(source.models, false), ...readSummaries(source.baselines, true)];
  assignColours(models);
  return {
    models,
    phases: list(source.phases).map(readPhase),
    folds: list(source.folds).map(object),
    paired: list(source.paired).map(readPair).filter((pair) => Number.isFinite(pair.difference)),
    bands: readBands(source.bands),
  };
}

/** A model has the colour here that it has in acceleration. */
function readBraking(source, acceleration) {
  const braking = readEvaluation(object(source));
  for (const model of braking.models) {
    const same = acceleration.models.find(({ name }) => name === model.name);
    if (same) model.colour = same.colour;
  }
  return braking;
}

function readPair(source) {
  const raw = object(source);
  return {
    model: text(raw.model),
    against: text(raw.against),
    units: number(raw.units),
    phases: number(raw.phases),
    difference: kmh(raw.difference_rmse_mps),
    low: kmh(raw.low_mps),
    high: kmh(raw.high_mps),
    better: number(raw.better_units),
    worse: number(raw.worse_units),
    verdict: text(raw.verdict),
  };
}

function readBands(source) {
  const level = (raw) => ({
    level: number(raw.level_pct),
    inside: number(raw.inside_pct),
    width: kmh(raw.mean_width_mps),
    groups: object(raw.groups),
  });
  return Object.entries(object(source))
    .map(([name, levels]) => ({ name, levels: list(levels).map(object).map(level).filter((one) => Number.isFinite(one.level + one.inside)) }))
    .filter(({ levels }) => levels.length > 0);
}

/** The models shown at first get the clearest colours; the baselines share one of their own. */
function assignColours(models) {
  models.forEach((model) => {
    model.colour = '--baseline';
  });
  const first = (model) => SHOWN_AT_FIRST.includes(model.name);
  models
    .filter((model) => !model.isBaseline)
    .sort((a, b) => first(b) - first(a))
    .forEach((model, index) => {
      model.colour = `--series-${index % SERIES_COLOURS}`;
    });
}

function readSummaries(source, isBaseline) {
  return Object.entries(object(source)).map(([name, summary]) => ({ name, isBaseline, summary: object(summary) }));
}

function readPhase(source) {
  const raw = object(source);
  const measured = speedCurve(raw.measured_mps);
  const stepS = number(raw.step_s);
  return {
    trip: text(raw.trip),
    group: text(raw.group),
    startS: number(raw.start_s),
    stepS,
    durationS: measured.length > 0 ? (measured.length - 1) * stepS : NaN,
    measured,
    energyKj: kilojoules(raw.energy_j),
    predictions: object(raw.predictions),
    predicted: new Map(),
  };
}

function speedCurve(speedMps) {
  return Float32Array.from(list(speedMps), kmh);
}

const prediction = (phase, name) => object(member(phase.predictions, name));

/** The predicted speed in km/h, converted when first asked for. */
function predictedCurve(phase, name) {
  let curve = phase.predicted.get(name);
  if (curve === undefined) {
    curve = speedCurve(prediction(phase, name).speed_mps);
    phase.predicted.set(name, curve);
  }
  return curve;
}

/** The phases of which a model has a prediction, by their places. */
function predictedPhases(report, name) {
  const has = (phase) => phase.measured.length > 1 && phase.stepS > 0 && list(prediction(phase, name).speed_mps).length > 1;
  return report.phases.map((phase, index) => (has(phase) ? index : -1)).filter((index) => index >= 0);
}

const colourOf = (report, name) => report.models.find((model) => model.name === name)?.colour ?? '--series-0';
const namesOf = (report) => report.models.map((model) => model.name);

/** Names in the order of the table of models, unknown ones last. */
function inTableOrder(report, names) {
  const known = namesOf(report).filter((name) => names.includes(name));
  return [...known, ...[...new Set(names)].filter((name) => !known.includes(name))];
}

function defaultSelection(report) {
  const names = report.models.map((model) => model.name);
  const preferred = SHOWN_AT_FIRST.filter((name) => names.includes(name));
  return new Set(preferred.length > 0 ? preferred : names.slice(0, 3));
}
