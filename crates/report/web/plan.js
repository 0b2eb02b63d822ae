// ---------------------------------------------------------------- the document of a plan

const SCHEMA = 'drivekit/plan/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'vehicle', 'road', 'plans'];

const BUDGET = [
  ['inertia_j', 'Gaining speed'],
  ['rolling_j', 'Rolling'],
  ['aero_j', 'Air drag'],
  ['grade_j', 'Climbing'],
  ['gear_loss_j', 'Gear loss'],
  ['motor_loss_j', 'Motor loss'],
  ['auxiliary_j', 'Auxiliaries'],
  ['battery_loss_j', 'Battery loss'],
  ['friction_brake_j', 'Friction brakes'],
];

function readRun(source) {
  const raw = object(source);
  const nodes = object(raw.nodes);
  const km = list(nodes.position_m).map((metres) => number(metres) / 1000);
  const along = (key, unit = number) => km.map((_, node) => unit(list(nodes[key])[node]));
  const steps = Math.max(km.length - 1, 0);
  const slopes = along('slope_rad').slice(0, steps).map((slope) => slope || 0);
  const elevations = [0];
  slopes.forEach((slope, step) => elevations.push(elevations[step] + 1000 * (km[step + 1] - km[step]) * Math.tan(slope)));
  const run = {
    ...{ km, slopes, elevations: elevations.slice(0, km.length) },
    ...{ speeds: along('speed_mps', kmh), limits: along('limit_mps', kmh).map((limit) => limit || 0) },
    ...{ seconds: along('arrival_s'), stood: along('stood_s').map((stood) => stood || 0) },
    efforts: list(nodes.effort).slice(0, steps).map(text),
    ...{ energyJ: number(raw.energy_j), timeS: number(raw.time_s), boundJ: number(raw.lower_bound_j) },
    ...{ gapPct: number(raw.gap_pct), bound: text(raw.bound), outcome: text(raw.outcome), priceW: number(raw.price_w) },
    ...{ consumption: number(raw.consumption_kwh_per_100km), budget: object(raw.budget), signals: list(raw.signals).map(readSignal) },
  };
  const isWhole = km.length > 1 && run.efforts.length === steps && [km, run.speeds, run.seconds].flat().every(Number.isFinite);
  return isWhole ? run : null;
}

function readSignal(source) {
  const raw = object(source);
  const green = list(raw.green_s).map((window) => list(window).map(number)).filter(([from, to]) => Number.isFinite(from + to));
  return { km: number(raw.position_m) / 1000, passageS: number(raw.passage_s), green };
}

/** A plan, with its distance from the driver's own way where there is one. */
function readStyled(source) {
  const [raw, run] = [object(source), readRun(source)];
  const distance = object(raw.style_distance);
  const savings = list(raw.saves_most).map(object).map(readSaving).filter(({ words }) => words !== '');
  return run && { ...run, style: text(raw.style), rms: kmh(distance.rms_mps), insidePct: number(distance.inside_band_pct), savings };
}

function readSaving(raw) {
  return { words: text(raw.words), savedJ: number(raw.saved_j), laterS: number(raw.later_s) };
}

function readPlan(source) {
  const doc = object(source);
  const plans = list(doc.plans).map(readStyled).filter((plan) => plan !== null);
  const plan = plans[0] ?? null;
  const point = (raw) => ({ timeS: number(raw.time_s), energyJ: number(raw.energy_j), priceW: number(raw.price_w) });
  return {
    ...readFrame(doc, SCHEMA_KEYS),
    ...{ vehicle: text(doc.vehicle), road: object(doc.road), plans, plan, own: readRun(doc.own) },
    signals: (plan?.signals ?? []).filter(({ km }) => Number.isFinite(km)),
    frontier: list(doc.frontier).map(object).map(point).filter(({ timeS, energyJ }) => Number.isFinite(timeS + energyJ)),
    savings: plan?.savings ?? [],
    obstacle: text(object(doc.obstacle).words),
    assumed: list(doc.findings).map(text).filter((finding) => finding !== ''),
  };
}

/** Shows a section, and the link to it, where it has something in it. */
function show(id, shown) {
  byId(id).hidden = !shown;
  for (const link of document.querySelectorAll(`nav a[href="#${id}"]`)) link.hidden = !shown;
}

// ---------------------------------------------------------------- energy against time

function frontierPicture({ frontier, own, plan }, width) {
  const points = frontier.map(({ timeS, energyJ }) => [timeS, kwh(energyJ)]);
  const beside = [own, plan].filter((run) => run !== null).map((run) => [run.timeS, kwh(run.energyJ)]);
  const axis = (index, unit) => ({ ...rangeOf([...points, ...beside].map((point) => point[index]), 0.08), unit });
  const frame = chartFrame(width, Math.max(260, Math.round(width * 0.4)), axis(0, 's'), axis(1, 'kWh'), 60);
  const places = (some) => some.map(([timeS, energy]) => [frame.x(timeS), frame.y(energy)]);
  const label = `Energy against time: ${points.map(([timeS, energy]) => `${fixed(energy, 3)} kWh in ${fixed(timeS, 0)} s`).join('; ')}.`;
  const nodes = [
    lineNode(points, frame, { colour: '--series-0' }),
    markerNode('circle', places(points), 3, '--series-0'),
    ...(own ? [markerNode('diamond', places([[own.timeS, kwh(own.energyJ)]]), 5, '--quiet')] : []),
    ...(plan ? [markerNode('square', places([[plan.timeS, kwh(plan.energyJ)]]), 4, '--series-1')] : []),
  ];
  const nearest = (timeS) => frontier[nearestIndex(frontier.map((point) => point.timeS), timeS)];
  return hoverable(frame, picture(frame, label, [...frame.axes, ...nodes]), (timeS) => {
    const point = nearest(timeS);
    return [quantity(point.timeS, 1, 's'), [quantity(kwh(point.energyJ), 3, 'kWh'), `price ${quantity(point.priceW / 1000, 2, 'kJ/s')}`]];
  });
}

function frontierSection(report) {
  const { frontier, own, plan } = report;
  const shown = frontier.length > 1;
  show('frontier', shown);
  if (!shown) return () => {};
  const body = el('div');
  const entries = [['cheapest plans', '--series-0'], ...(own ? [['own run', '--quiet']] : []), ...(plan ? [['this plan', '--series-1']] : [])];
  const legend = legendOf(entries.map(([name, colour]) => [swatch(colour), name]));
  byId('frontier-body').append(el('figure', {}, body, legend));
  return () => body.replaceChildren(frontierPicture(report, chartWidth(body, 900)));
}

// ---------------------------------------------------------------- words and tables

const savedPct = (plan, own) => (own && own.energyJ > 0 ? 100 * (1 - plan.energyJ / own.energyJ) : NaN);

function plansSection({ plans, own }) {
  show('plans', plans.length > 1);
  if (plans.length < 2) return;
  const columns = [
    { label: 'Style', unit: 'half-widths', value: ({ style }) => style },
    { label: 'Arrival', unit: 's', value: ({ timeS }) => timeS, digits: 1 },
    { label: 'From the cells', unit: 'kWh', value: ({ energyJ }) => kwh(energyJ), digits: 4 },
    { label: 'Saved', unit: '% of the own run', value: (plan) => savedPct(plan, own), digits: 1 },
    { label: 'Gap to the bound', unit: '%', value: ({ gapPct }) => gapPct, digits: 4 },
    { label: 'From the own speed', unit: 'km/h, root mean square', value: ({ rms }) => rms, digits: 1 },
    { label: 'Inside the band', unit: '% of the road', value: ({ insidePct }) => insidePct, digits: 0 },
  ];
  byId('plans-body').append(sortableTable('Plans compared', columns, plans));
}

function savingsSection({ savings }) {
  show('savings', savings.length > 0);
  const time = (laterS) => (Number.isFinite(laterS) ? `${fixed(Math.abs(laterS), 1)}\u00a0s ${laterS < 0 ? 'sooner' : 'later'}` : '–');
  const rows = savings.map(({ words, savedJ, laterS }) => [words, `${quantity(savedJ / 1000, 1, 'kJ')}`, time(laterS)]);
  if (rows.length > 0) byId('savings-body').append(textTable('Where the plan saves most', ['Advice', 'Saves', 'Passes'], rows));
}

function budgetSection({ plan, own }) {
  if (!plan) return absent('budget', 'The document has no plan with a budget.');
  const runs = own ? [plan, own] : [plan];
  const names = own ? ['Plan, kWh', 'Wh/km', 'Own run, kWh', 'Wh/km'] : ['kWh', 'Wh/km'];
  const distance = plan.km.at(-1) - plan.km[0];
  const cells = (energyJ) => [fixed(kwh(energyJ), 4), fixed(energyJ / 3600 / distance, 1)];
  const row = (name, of) => {
    const values = runs.flatMap((run) => cells(of(run)));
    return el('tr', {}, el('th', { scope: 'row' }, name), ...values.map((value) => el('td', {}, value)));
  };
  const terms = BUDGET.map(([key, name]) => row(name, ({ budget }) => number(budget[key])));
  const sum = row('From the cells', ({ energyJ }) => energyJ);
  const back = row('Regenerated on the way', ({ budget }) => number(budget.regenerated_j));
  const head = el('tr', {}, heading('Energy', 'text corner'), ...names.map((name) => heading(name)));
  const bodies = [el('tbody', {}, ...terms), el('tbody', { class: 'baselines' }, sum, back)];
  byId('budget-body').append(tableBox('Energy budget', [head], bodies));
  return () => {};
}

function assumedSection({ assumed, plan }) {
  const isBounded = Number.isFinite(plan?.boundJ);
  const words = [
    'Energy is that of the model of the car, not a measured one.',
    'Road, limits and signals are known beforehand and as stated; there is no other traffic than the leader, if one is given.',
    ...(isBounded && plan.bound === 'proven' ? ['That no other plan takes less than the bound is proven for the nodes of the road and the formulas of the car, but for rounding.'] : []),
    ...(isBounded && plan.bound === 'numerical' ? ['The bound was searched numerically; it is no proof.'] : []),
    ...assumed,
  ];
  byId('assumed-body').append(el('ul', {}, ...words.map((line) => el('li', {}, line))));
}

// ---------------------------------------------------------------- main

function introduce({ version, vehicle, plan, own, obstacle, frontier, road }) {
  byId('version').append(version);
  const headline = byId('headline');
  byId('facts').hidden = plan === null;
  if (plan === null) {
    if (obstacle !== '') headline.append(`Nothing can be driven: ${obstacle}.`);
    else headline.append(`${plural(frontier.length, 'plan')} over ${quantity(number(road.length_m) / 1000, 2, 'km')} with ${vehicle}.`);
    return;
  }
  const early = plan.outcome === 'early' ? ', before it has to: later would not be cheaper' : '';
  const least = quantity(kwh(plan.boundJ), 4, 'kWh');
  const bound = Number.isFinite(plan.boundJ) ? `No other plan that arrives by then takes less than ${least}.` : 'How much less another plan could take is not known.';
  headline.append(
    `${quantity(plan.km.at(-1) - plan.km[0], 2, 'km')} with ${vehicle} in ${quantity(plan.timeS, 1, 's')}${early}, for ${quantity(kwh(plan.energyJ), 4, 'kWh')} from the cells by the model. ${bound}`,
  );
  const saved = savedPct(plan, own);
  byId('facts').append(
    fact('Arrival', fixed(plan.timeS, 1), 's'),
    fact('From the cells', fixed(kwh(plan.energyJ), 3), 'kWh'),
    fact('Consumption', fixed(plan.consumption, 1), 'kWh/100 km'),
    fact('Gap to the bound', fixed(plan.gapPct, 4), '%'),
    fact('A second later saves', fixed(plan.priceW / 1000, 2), 'kJ'),
    ...(Number.isFinite(saved) ? [fact('Less than the own run', fixed(saved, 1), '%')] : []),
  );
}

function main() {
  const report = readPlan(parseDocument());
  introduce(report);
  problems(report, SCHEMA);
  const draws = [roadSection(report), frontierSection(report)];
  plansSection(report);
  savingsSection(report);
  budgetSection(report);
  assumedSection(report);
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  keepDrawn(() => draws.forEach((draw) => draw()));
}

main();
