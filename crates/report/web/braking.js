// ---------------------------------------------------------------- braking

/** A part of the section that hides where it has nothing to show. */
function brakingPart(id, present, fill) {
  byId(id).hidden = !present;
  return present ? fill(byId(`${id}-body`)) : () => {};
}

function brakingCurves(report) {
  const shown = defaultSelection(report);
  const chart = newChart(report, byId('braking-curves-body'));
  picker(byId('braking-picker'), report, shown, () => {
    buildPanels(chart, shown);
    drawPanels(chart);
  });
  buildPanels(chart, shown);
  return () => drawPanels(chart);
}

function brakingSection(report) {
  const { braking, unit, config } = report;
  const given = { ...braking, unit, config };
  const has = { models: braking.models.length > 0, phases: braking.phases.length > 0 };
  const parts = [
    brakingPart('braking-comparison', braking.paired.length > 0, (node) => comparison(node, given, 'Braking')),
    brakingPart('braking-bands', braking.bands.length > 0, (node) => reliability(node, given, 'Predictive bands, braking')),
    brakingPart('braking-curves', has.models && has.phases, () => brakingCurves(given)),
  ];
  if (!has.models) absent('braking', 'This evaluation has no braking phases (braking).');
  else byId('braking-body').append(summaryTable(given, 'Models and baselines, braking'));
  return () => parts.forEach((draw) => draw());
}
