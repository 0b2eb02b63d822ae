// ---------------------------------------------------------------- the energy document

const SCHEMA = 'drivekit/energy/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'totals', 'logs'];

/** The terms of the budget in the order of the flow, each with the part of the car that it leaves. */
const TERMS = [
  { key: 'battery_loss_j', name: 'Battery loss', part: 'battery', colour: '--series-1' },
  { key: 'auxiliary_j', name: 'Auxiliaries', part: 'drive', colour: '--series-3' },
  { key: 'motor_loss_j', name: 'Motor loss', part: 'drive', colour: '--series-1' },
  { key: 'gear_loss_j', name: 'Gear loss', part: 'drive', colour: '--series-1' },
  { key: 'aero_j', name: 'Air drag', part: 'wheels', colour: '--series-0' },
  { key: 'rolling_j', name: 'Rolling', part: 'wheels', colour: '--series-0' },
  { key: 'grade_j', name: 'Climbing', inflow: 'Descending', part: 'wheels', colour: '--series-5' },
  { key: 'inertia_j', name: 'Gaining speed', inflow: 'Losing speed', part: 'wheels', colour: '--series-5' },
  { key: 'friction_brake_j', name: 'Friction brakes', part: 'wheels', colour: '--series-4' },
];

const sumOf = (values) => values.reduce((sum, value) => sum + value, 0);

function readEnergy(source) {
  const doc = object(source);
  const logs = list(doc.logs).map(readEntry);
  const totals = list(doc.totals).map(readEntry);
  return { ...readFrame(doc, SCHEMA_KEYS), logs, totals };
}

/** A trip, or the total of a vehicle, with the keys that they share and those of either. */
function readEntry(source) {
  const raw = object(source);
  const [budget, limited, slope, auxiliaries] = [raw.budget, raw.limited, raw.slope, raw.auxiliaries].map(object);
  return {
    name: text(raw.name),
    vehicle: text(raw.vehicle),
    trips: number(raw.trips),
    distanceM: number(raw.distance_m),
    durationS: number(raw.duration_s),
    cellsJ: number(raw.battery_energy_j),
    terminalJ: number(raw.terminal_energy_j),
    wallJ: number(raw.wall_energy_j),
    consumption: number(raw.consumption_kwh_per_100km),
    budget,
    regeneratedJ: number(budget.regenerated_j),
    undeliveredJ: number(limited.undelivered_j),
    limitedS: number(limited.torque_s) + number(limited.battery_s),
    brakedJ: number(object(raw.wheel).braked_j),
    measuredJ: number(raw.measured_terminal_energy_j),
    errorPct: number(raw.error_pct),
    meanErrorPct: number(raw.mean_abs_error_pct),
    rmseW: number(raw.power_rmse_w ?? raw.median_power_rmse_w),
    slopeSource: text(slope.source),
    slopeJ: number(slope.energy_j ?? raw.slope_energy_j),
    auxSource: text(auxiliaries.source),
    auxW: number(auxiliaries.mean_w),
    ambientC: number(raw.ambient_degc),
    socPct: [number(raw.soc_start_pct), number(raw.soc_end_pct)],
    curve: readCurve(raw.curve),
  };
}

function readCurve(source) {
  const raw = object(source);
  const timeS = Float64Array.from(list(raw.time_s), number);
  const along = (values, unit) => Float64Array.from(timeS, (_, index) => unit(list(values)[index]));
  return {
    timeS,
    speed: along(raw.speed_mps, kmh),
    modelled: along(raw.modelled_w, kilowatts),
    measured: list(raw.measured_w).some(Number.isFinite) ? along(raw.measured_w, kilowatts) : null,
  };
}

const perKm = (energyJ, entry) => (entry.distanceM > 0 ? energyJ / 3600 / (entry.distanceM / 1000) : NaN);
const percentOf = (part, whole) => (whole > 0 ? (100 * part) / whole : NaN);
const severalVehicles = (report) => new Set([...report.logs, ...report.totals].map((entry) => entry.vehicle)).size > 1;

const entryName = (entry) => [entry.name, entry.vehicle].filter((part) => part !== '').join(' · ') || 'Not named';

/** Totals and trips as choices of a list. */
function entryGroups(totals, trips, several) {
  const trip = (entry) => ({ entry, label: [entry.name || 'not named', ...(several ? [entry.vehicle] : [])].join(' · ') });
  const total = (entry) => ({ entry, label: entry.vehicle || 'vehicle not named' });
  return [
    ['All trips', totals.map(total)],
    ['Single trips', trips.map(trip)],
  ];
}

// ---------------------------------------------------------------- trips

const slopePct = (entry) => (entry.terminalJ === 0 ? NaN : (100 * entry.slopeJ) / Math.abs(entry.terminalJ));

function auxiliaries(entry) {
  const power = Number.isFinite(entry.auxW) ? quantity(entry.auxW, 0, 'W') : '';
  return [entry.auxSource, power].filter((part) => part !== '').join(', ');
}

function tripTable(report) {
  const columns = [
    { label: 'Trip', value: (e) => e.name },
    ...(severalVehicles(report) ? [{ label: 'Vehicle', value: (e) => e.vehicle }] : []),
    { label: 'Distance', unit: 'km', value: (e) => e.distanceM / 1000, digits: 1 },
    { label: 'Consumption', unit: 'kWh/100 km', value: (e) => e.consumption, digits: 2 },
    { label: 'Terminals', unit: 'kWh', value: (e) => kwh(e.terminalJ), digits: 3 },
    { label: 'Measured', unit: 'kWh', value: (e) => kwh(e.measuredJ), digits: 3 },
    { label: 'Error', unit: '%', value: (e) => e.errorPct, digits: 1 },
    { label: 'Power RMSE', unit: 'kW', value: (e) => kilowatts(e.rmseW), digits: 2 },
    { label: 'On slope', unit: '%', value: slopePct, digits: 1 },
    { label: 'Slope from', value: (e) => e.slopeSource },
    { label: 'Auxiliaries from', value: auxiliaries, wraps: true },
  ];
  return sortableTable('Results by trip', columns, report.logs);
}

// ---------------------------------------------------------------- vehicles

/** What is compared; `difference` says whether a difference in per cent has a meaning. */
const MEASURES = [
  { label: 'Consumption, kWh/100 km', value: (t) => t.consumption, digits: 2, difference: true },
  { label: 'At the terminals, kWh', value: (t) => kwh(t.terminalJ), digits: 2, difference: true },
  { label: 'Out of the cells, kWh', value: (t) => kwh(t.cellsJ), digits: 2, difference: true },
  { label: 'From the wall, kWh', value: (t) => kwh(t.wallJ), digits: 2, difference: true },
  ...TERMS.map(({ key, name, inflow }) => {
    const label = inflow ? `${name}, net, Wh/km` : `${name}, Wh/km`;
    return { label, value: (t) => perKm(number(t.budget[key]), t), digits: 1, difference: inflow === undefined };
  }),
  { label: 'Regenerated, Wh/km', value: (t) => perKm(t.regeneratedJ, t), digits: 1, difference: true },
  { label: 'Of the slope, Wh/km', value: (t) => perKm(t.slopeJ, t), digits: 1 },
  { label: 'Limited, s', value: (t) => t.limitedS, digits: 1 },
  { label: 'Error, %', value: (t) => t.errorPct, digits: 1 },
  { label: 'Mean absolute error, %', value: (t) => t.meanErrorPct, digits: 1 },
  { label: 'Median power RMSE, kW', value: (t) => kilowatts(t.rmseW), digits: 2 },
];

function vehicleTable(totals) {
  const [first, ...others] = totals;
  const named = (total) => heading(total.vehicle || 'not named');
  const names = [named(first), ...others.flatMap((total) => [named(total), heading('Difference, %')])];
  const row = ({ label, value, digits, difference }) => {
    const base = value(first);
    const change = (total) => (difference && base > 0 ? 100 * (value(total) / base - 1) : NaN);
    const cells = others.flatMap((total) => [fixed(value(total), digits), signed(change(total), 1)]);
    const nodes = [fixed(base, digits), ...cells].map((cell) => el('td', {}, cell));
    return el('tr', {}, el('th', { scope: 'row' }, label), ...nodes);
  };
  const head = el('tr', {}, heading('Measure', 'text corner'), ...names);
  return tableBox('Vehicles compared', [head], [el('tbody', {}, ...MEASURES.map(row))]);
}

function compareVehicles(report) {
  const several = report.totals.length > 1;
  byId('vehicles').hidden = !several;
  for (const link of document.querySelectorAll('nav a[href="#vehicles"]')) link.hidden = !several;
  if (several) byId('vehicles-body').append(vehicleTable(report.totals));
}

// ---------------------------------------------------------------- main

function verdict(total) {
  if (!Number.isFinite(total.errorPct)) return 'There is no measured power to compare with.';
  const average = quantity(total.meanErrorPct, 1, '%');
  const tripwise = Number.isFinite(total.meanErrorPct) ? `, and ${average} off on average per trip` : '';
  const direction = total.errorPct < 0 ? 'below' : 'above';
  return `The model is ${quantity(Math.abs(total.errorPct), 1, '%')} ${direction} the measured energy${tripwise}.`;
}

function introduce(report) {
  byId('version').append(report.version);
  const [total] = report.totals;
  byId('facts').hidden = total === undefined;
  if (total === undefined) {
    byId('headline').append(`${plural(report.logs.length, 'result')}, without totals.`);
    return;
  }
  const energy = (term) => number(total.budget[term.key]);
  const [most] = sortRows(TERMS, energy, true).filter((term) => energy(term) > 0);
  const largest = most ? ` The largest use is ${most.name.toLowerCase()}, ${quantity(kwh(energy(most)), 2, 'kWh')}.` : '';
  const trips = `${plural(total.trips, 'trip')} over ${quantity(total.distanceM / 1000, 1, 'km')}`;
  const others = report.totals.length > 1 ? `, the first of ${plural(report.totals.length, 'vehicle')}` : '';
  const consumption = `${quantity(total.consumption, 2, 'kWh')} per 100\u00a0km at the battery terminals`;
  const vehicle = total.vehicle || 'the vehicle';
  byId('headline').append(`${trips} with ${vehicle}${others}: ${consumption}.${largest} ${verdict(total)}`);
  byId('facts').append(
    fact('Trips', fixed(total.trips, 0)),
    fact('Distance', fixed(total.distanceM / 1000, 1), 'km'),
    fact('Consumption', fixed(total.consumption, 2), 'kWh/100 km'),
    fact('From the wall', fixed(kwh(total.wallJ), 2), 'kWh'),
    fact('Error', signed(total.errorPct, 1), '%'),
    fact('Median power RMSE', fixed(kilowatts(total.rmseW), 2), 'kW'),
  );
}

function main() {
  const report = readEnergy(parseDocument());
  introduce(report);
  problems(report, SCHEMA);
  const drawFlow = flowSection(report);
  const drawPower = powerSection(report);
  byId('trips-body').append(report.logs.length > 0 ? tripTable(report) : note('The document has no logs.'));
  compareVehicles(report);
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  keepDrawn(() => {
    drawFlow();
    drawPower();
  });
}

main();
