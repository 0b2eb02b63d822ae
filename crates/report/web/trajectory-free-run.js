// ---------------------------------------------------------------- free run

const KNOWLEDGE = [
  { key: 'expected', label: 'limits, stops' },
  { key: 'known', label: 'also where the driver slowed down' },
];

const ERRORS = [
  { key: 'distance', label: 'Distance', trip: 'distance_error_pct' },
  { key: 'energy', label: 'Energy', trip: 'energy_error_pct' },
  { key: 'time_at_distance', label: 'Time at equal distance', trip: 'time_at_distance_error_pct' },
  { key: 'energy_at_distance', label: 'Energy at equal distance', trip: 'energy_at_distance_error_pct' },
];

function readFreeRun(raw) {
  const rows = KNOWLEDGE.map(({ key, label }) => {
    const figures = object(raw[key]);
    return { label, figures, trips: list(figures.by_trip).map(object) };
  });
  return { rows, leftOut: Object.entries(object(raw.left_out)).map(([log, reason]) => [log, text(reason)]) };
}

function freeRunTable({ rows }) {
  const groups = ERRORS.map(({ label }) => el('th', { scope: 'colgroup', colspan: 3 }, label));
  const title = (name) => el('th', { scope: 'col' }, name, el('small', {}, '%'));
  const names = ERRORS.flatMap(() => ['mean', 'magnitude', 'largest'].map(title));
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
  const [distance, energy] = ['distance_error_pct', 'energy_error_pct'].map((key) => signed(number(trip?.[key]), 1));
  const off = trip ? ` Distance off by ${distance}\u00a0%, energy by ${energy}\u00a0%.` : '';
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
  return { node, draw: () => body.replaceChildren(linePicture({ label, lines, x, y, told }, chartWidth(body))) };
}

function freeRunSection({ freeRun, curves }) {
  const holders = ['free-run-figures', 'free-run-trips'].map(byId);
  holders.forEach((node) => {
    node.hidden = freeRun === null;
  });
  if (freeRun === null) return absent('free-run', 'Too few drives have limits and are long enough for a free run.');
  const remark = [
    'Predicted less measured. Distance and energy at equal time, up to 15\u00a0min;',
    '“mean” keeps the signs, “magnitude” is the mean without them.',
  ].join(' ');
  const leftOut = freeRun.leftOut.map(([log, reason]) => note(`${log} is left out: ${reason}.`));
  byId('free-run-body').append(freeRunTable(freeRun), note(remark), ...leftOut);
  const tables = freeRun.rows.filter(({ trips }) => trips.length > 0);
  byId('free-run-trips').append(
    ...tables.map((row) => collapsible(`By trip: ${row.label}`, plural(row.trips.length, 'trip'), () => freeRunTrips(row))),
  );
  const run = curves.freeRun;
  const drawable = run && run.measured.speed.length > 1 && run.predicted.speed.length > 1;
  const figures = drawable ? PICTURES.map((one) => freeRunFigure(run, freeRun, one)) : [];
  byId('free-run-figures').append(...figures.map(({ node }) => node));
  byId('free-run-figures').hidden = figures.length === 0;
  return () => figures.forEach(({ draw }) => draw());
}
