// ---------------------------------------------------------------- main

function bestOf(models) {
  const ranked = models.filter((model) => Number.isFinite(number(model.summary.rmse_mps)));
  return ranked.reduce((best, model) => (best === null || model.summary.rmse_mps < best.summary.rmse_mps ? model : best), null);
}

function headline(report) {
  const baselines = report.models.filter((model) => model.isBaseline);
  const models = report.models.filter((model) => !model.isBaseline);
  const [best, baseline] = [bestOf(models), bestOf(baselines)];
  const contest = `${plural(models.length, 'model')} and ${plural(baselines.length, 'baseline')}`;
  const material = `${plural(report.phases.length, 'phase')} of ${plural(report.inputs.length, 'drive')}`;
  byId('headline').append(`${contest} predicted the speed in ${material}. ${verdict(best, baseline)}`);
  byId('version').append(report.version);
  const facts = [fact('Drives', fixed(report.inputs.length, 0)), fact('Phases', fixed(report.phases.length, 0))];
  if (best) {
    const share = fixed(number(best.summary.in_band_pct), 1);
    const rmse = fixed(kmh(best.summary.rmse_mps), 2);
    facts.push(fact('Best model', best.name), fact('Its mean RMSE', rmse, 'km/h'), fact('In band', share, '%'));
  }
  byId('facts').append(...facts);
}

function verdict(best, baseline) {
  if (best === null) return 'No model has an RMSE.';
  const rmse = (model) => quantity(kmh(model.summary.rmse_mps), 2, 'km/h');
  const half = number(best.summary.band_kmh) / 2;
  const band = Number.isFinite(half) ? `within ±${quantity(half, 1, 'km/h')}` : 'in the band';
  const share = `${quantity(number(best.summary.in_band_pct), 1, '%')} of the samples ${band}`;
  const comparison = baseline === null ? '' : `; the best baseline, ${baseline.name}, has ${rmse(baseline)}`;
  return `The best model, ${best.name}, has a mean RMSE of ${rmse(best)}, with ${share}${comparison}.`;
}

function picker(node, report, shown, onChange) {
  node.append(
    ...report.models.map((model) => {
      const input = el('input', { type: 'checkbox', ...(shown.has(model.name) ? { checked: '' } : {}) });
      input.addEventListener('change', () => {
        if (input.checked) shown.add(model.name);
        else shown.delete(model.name);
        onChange();
      });
      return el('label', { class: 'chip' }, input, swatch(model.colour), model.name);
    }),
  );
  node.hidden = report.models.length === 0;
}

/** Sections that fill themselves and give what draws them anew. */
const SECTIONS = [
  ...[comparisonSection, bandPhase, bandReliability, fitSection, systemSection],
  ...[brakingSection, wholeSection, cruiseSection, followingSection, learningSection],
];

function main() {
  const report = readReport(parseDocument());
  const shown = defaultSelection(report);
  const chart = newChart(report, byId('curves-body'));
  headline(report);
  document.querySelectorAll('.unit').forEach((node) => node.replaceChildren(report.unit));
  problems(report, SCHEMA);
  byId('models-body').append(
    report.models.length > 0 ? summaryTable(report) : note('The document has no models and no baselines.'),
  );
  const sections = SECTIONS.map((section) => section(report));
  const redraw = () => {
    HISTOGRAMS.forEach((spec) => drawHistogram(spec, report, shown));
    drawPanels(chart);
  };
  picker(byId('picker'), report, shown, () => {
    buildPanels(chart, shown);
    redraw();
  });
  byId('groups-body').append(...groupResults(report));
  byId('trips-body').append(...tripResults(report));
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  buildPanels(chart, shown);
  keepDrawn(() => {
    redraw();
    sections.forEach((draw) => draw());
  });
}

main();
