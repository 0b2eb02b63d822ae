// ---------------------------------------------------------------- the evaluation document

const SCHEMA = 'drivekit/evaluate/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'models', 'baselines', 'folds', 'phases'];
const SHOWN_AT_FIRST = ['inverse', 'rise-time', 'profile'];
const SERIES_COLOURS = 6;

const kilojoules = (energyJ) => number(energyJ) / 1000;

function readReport(source) {
  const doc = object(source);
  const models = [...readSummaries(doc.models, false), ...readSummaries(doc.baselines, true)];
  assignColours(models);
  return {
    ...readFrame(doc, SCHEMA_KEYS),
    models,
    phases: list(doc.phases).map(readPhase),
    folds: list(doc.folds).map(object),
  };
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

function defaultSelection(report) {
  const names = report.models.map((model) => model.name);
  const preferred = SHOWN_AT_FIRST.filter((name) => names.includes(name));
  return new Set(preferred.length > 0 ? preferred : names.slice(0, 3));
}
