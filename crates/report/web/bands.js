// ---------------------------------------------------------------- the band around one phase

const BAND = { width: 3, radius: 2.6, apart: 6 };

/** Speeds in km/h of a phase with the two bands: that around the measured speed and the predicted one, where there is one. */
function bandData(report, phase, model) {
  const predicted = predictedCurve(phase, model.name);
  const half = (number(model.summary.band_kmh) || number(report.config?.band) || BAND.width) / 2;
  const raw = prediction(phase, model.name);
  const [low, high] = [speedCurve(raw.low_mps), speedCurve(raw.high_mps)];
  const hasBand = low.length > 1 && high.length > 1;
  const places = timesOf(phase).map((_, index) => index).filter((index) => Number.isFinite(predicted[index] - phase.measured[index]));
  const within = (index) => Math.abs(predicted[index] - phase.measured[index]) <= half + 1e-6;
  const caught = places.filter((index) => phase.measured[index] >= low[index] && phase.measured[index] <= high[index]);
  return { phase, predicted, half, low, high, hasBand, places, within, inside: places.filter(within).length, caught: caught.length };
}

function bandAreas({ phase, half, low, high, hasBand }, colour) {
  const times = timesOf(phase);
  return (frame) => {
    const around = areaNode(times, phase.measured.map((v) => v - half), phase.measured.map((v) => v + half), frame, '--measured', 0.16);
    if (!hasBand) return [around];
    const edge = (values) => lineNode(zipped(times, values), frame, { colour, kind: 'dashed', width: 1 });
    return [around, areaNode(times, low, high, frame, colour, 0.14), edge(low), edge(high)];
  };
}

/** Every sample that there is room for, as a dot inside the band and as a cross outside. */
function bandMarkers({ phase, predicted, places, within }, stride) {
  return ({ x, y }) => {
    const marked = places.filter((_, order) => order % stride === 0);
    const at = (index) => [x(index * phase.stepS), y(predicted[index])];
    const inside = marked.filter(within).map(at);
    const outside = marked.filter((index) => !within(index)).map(at);
    return [
      markerNode('circle', inside, BAND.radius, '--acceleration'),
      markerNode('cross', outside, BAND.radius + 0.4, '--braking'),
    ];
  };
}

const share = (count, of) => `${fixed(count, 0)} of ${fixed(of, 0)} samples (${quantity((100 * count) / of, 1, '%')})`;

function bandCaption(data, model, stride) {
  const { phase, half, hasBand, places, inside, caught } = data;
  const sentences = [
    `${phaseName(phase)}.`,
    `${model.name}: ${share(inside, places.length)} within ±${quantity(half, 1, 'km/h')}.`,
    ...(hasBand ? [`The 90\u00a0% predictive band holds ${share(caught, places.length)} of the measured speed.`] : []),
    ...(stride > 1 ? [`One sample in ${fixed(stride, 0)} is marked.`] : []),
  ];
  return sentences.join(' ');
}

function bandLegend(model, { hasBand }) {
  const sign = (content, colour) => coloured(el('span', { 'aria-hidden': 'true' }, content), 'color', colour);
  return legendOf([
    [strokeSample('--measured'), 'measured, with the band around it'],
    [sign('● ', '--acceleration'), 'predicted, inside'],
    [sign('✕ ', '--braking'), 'predicted, outside'],
    ...(hasBand ? [[strokeSample(model.colour, 'dashed'), '90\u00a0% predictive band']] : []),
  ]);
}

function bandFigure(report, phase, model, width) {
  const data = bandData(report, phase, model);
  const times = timesOf(phase);
  const stride = Math.max(1, Math.ceil((times.length * BAND.apart) / (width - CHART.left - CHART.right)));
  const lines = [
    { name: 'measured', colour: '--measured', width: 2, values: phase.measured },
    { name: model.name, colour: model.colour, width: 0.75, values: data.predicted },
  ];
  const caption = bandCaption(data, model, stride);
  const edges = data.hasBand ? [...data.low, ...data.high] : [];
  const remarks = (index) => {
    const difference = data.predicted[index] - phase.measured[index];
    const range = `90 % band ${fixed(number(data.low[index]), 1)} to ${quantity(number(data.high[index]), 1, 'km/h')}`;
    return [`difference ${signed(difference, 1)}\u00a0km/h`, ...(data.hasBand ? [range] : [])];
  };
  const chart = timeChart({
    label: `Measured and predicted speed of one phase with the band. ${caption}`,
    ...{ width, timeS: times, lines, unit: 'km/h', digits: 1, along: 's since the phase began' },
    also: [...phase.measured].flatMap((speed) => [speed - data.half, speed + data.half]).concat(edges),
    ...{ under: bandAreas(data, model.colour), over: bandMarkers(data, stride), remarks },
  });
  return [chart, bandLegend(model, data), el('figcaption', {}, caption)];
}

/** The place of the phase whose share in the band is nearest to the mean of its model. */
function typicalPlace(report, phases, model) {
  const distance = (index) => {
    const off = Math.abs(number(prediction(report.phases[index], model.name).in_band_pct) - number(model.summary.in_band_pct));
    return Number.isFinite(off) ? off : Infinity;
  };
  return phases.reduce((best, index, place) => (distance(index) < distance(phases[best]) ? place : best), 0);
}

function bandPhase(report) {
  const choices = report.models
    .map((model) => ({ label: model.name, model, phases: predictedPhases(report, model.name) }))
    .filter(({ phases }) => phases.length > 0);
  const body = byId('bands-phase');
  if (choices.length === 0) {
    body.replaceChildren(note('This evaluation has no predicted phases.'));
    return () => {};
  }
  const withBand = ({ model, phases }) => list(prediction(report.phases[phases[0]], model.name).low_mps).length > 0;
  const best = bestOf(choices.filter(withBand).map(({ model }) => model)) ?? bestOf(choices.map(({ model }) => model));
  let chosen = choices.find(({ model }) => model === best) ?? choices[0];
  const figure = el('figure');
  const stepper = phaseStepper('Phase shown with its band', (place) => {
    const phase = report.phases[chosen.phases[place]];
    figure.replaceChildren(...bandFigure(report, phase, chosen.model, chartWidth(figure)));
  });
  const pick = (choice) => {
    const kept = choice.phases.indexOf(chosen.phases[stepper.place()]);
    const start = choice === chosen || kept < 0 ? typicalPlace(report, choice.phases, choice.model) : kept;
    chosen = choice;
    stepper.restart(choice.phases.length, start);
  };
  const models = picklist('Model', [['Models and baselines', choices]], pick, chosen);
  body.replaceChildren(el('div', { class: 'controls' }, models, stepper.node), figure);
  pick(chosen);
  return stepper.redraw;
}
