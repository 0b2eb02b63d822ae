// ---------------------------------------------------------------- acceleration and braking

const FLEET = { colour: '--quiet', kind: 'dashed', width: 2 };
const MANY_POINTS = 1000;
const PACES = [
  { key: 'acceleration', title: 'Acceleration', colour: '--acceleration' },
  { key: 'braking', title: 'Braking', colour: '--braking' },
];

const spreadWords = ({ p10, median, p90 }, digits) => `${fixed(median, digits)} (${fixed(p10, digits)} to ${fixed(p90, digits)})`;

/** Bins beside each other, as lines go on over them, from the first edge to the last. */
function stretches(bins) {
  const runs = [];
  for (const bin of bins) {
    const last = runs.at(-1);
    if (last && Math.abs(last.at(-1).to - bin.from) < 0.01) last.push(bin);
    else runs.push([bin]);
  }
  return runs.map((run) => [
    { ...run[0], at: run[0].from },
    ...run.map((bin) => ({ ...bin, at: (bin.from + bin.to) / 2 })),
    { ...run.at(-1), at: run.at(-1).to },
  ]);
}

const medians = (stations) => stations.map(({ at, median }) => [at, median]);

/** The axes that both figures share: the speeds of the driver, and accelerations that single stretches may be beyond. */
function paceAxes({ driver, fleet }) {
  const paces = PACES.map(({ key }) => driver[key]);
  const bins = paces.flatMap((pace) => pace.bins);
  const means = bins.length > 0 ? [] : paces.flatMap((pace) => pace.means);
  const fastest = Math.max(...bins.map(({ to }) => to), ...means.map(([speed]) => speed));
  const beside = fleet ? PACES.flatMap(({ key }) => fleet[key].bins) : [];
  const reached = beside.filter(({ to }) => to <= fastest + 0.01).map(({ median }) => median);
  const hardest = Math.max(...bins.map(({ p90 }) => p90), ...means.map(([, accel]) => accel), ...reached);
  if (!(fastest > 0 && hardest > 0)) return null;
  return { x: { low: 0, high: fastest, unit: 'km/h' }, y: { low: 0, high: 1.25 * hardest, unit: 'm/s²' } };
}

function pointCloud(points, { x, y }, colour) {
  const places = points.map(([speed, accel]) => [x(speed), y(accel)]);
  const cloud = markerNode('circle', places, points.length > MANY_POINTS ? 1.25 : 2, colour);
  cloud.style.fillOpacity = 0.3;
  return cloud;
}

function bandNode(stations, frame, colour) {
  const [places, lower, upper] = ['at', 'p10', 'p90'].map((key) => stations.map((station) => station[key]));
  return areaNode(places, lower, upper, frame, colour, 0.25);
}

function paceLabel({ title }, pace, fleet) {
  const bins = pace.bins.map((bin) => `${fixed(bin.from, 0)} to ${fixed(bin.to, 0)} km/h ${spreadWords(bin, 1)}`).join('; ');
  const all = `${fixed(pace.median, 1)} m/s² at the median${fleet ? `, the fleet ${fixed(fleet.median, 1)}` : ''}`;
  return `${title} over speed: ${all}. Median and range from 10 to 90 % in m/s²: ${bins}.`;
}

function paceTold(pace, fleet, speed) {
  const within = ({ from, to }) => speed >= from && speed < to;
  const bin = pace.bins.find(within);
  if (!bin) return null;
  const beside = fleet?.bins.find(within);
  return [
    `${fixed(bin.from, 0)} to ${quantity(bin.to, 0, 'km/h')}`,
    [
      `median ${quantity(bin.median, 2, 'm/s²')}`,
      `10 to 90\u00a0%: ${fixed(bin.p10, 2)} to ${fixed(bin.p90, 2)}`,
      ...(beside ? [`fleet ${fixed(beside.median, 2)}`] : []),
      plural(bin.samples, 'sample'),
    ],
  ];
}

function paceLegend({ colour }, fleet) {
  const [point, shade] = [swatch(colour), swatch(colour)];
  Object.assign(point.style, { borderRadius: '50%', opacity: 0.5 });
  shade.style.opacity = 0.25;
  const own = [[point, 'one stretch'], [strokeSample(colour), 'median'], [shade, '10 to 90\u00a0%']];
  return legendOf([...own, ...(fleet ? [[strokeSample(FLEET.colour, FLEET.kind), 'median of the fleet']] : [])]);
}

function paceCaption(pace, fleet, beyond) {
  const beside = fleet ? `, the fleet ${fixed(fleet.median, 2)}` : '';
  const parts = [`Over all speeds ${quantity(pace.median, 2, 'm/s²')} at the median${beside}.`];
  if (beyond > 0) parts.push(`${fixed(beyond, 0)} of ${plural(pace.means.length, 'point')} lie outside the picture.`);
  return parts.join(' ');
}

function paceFigure(kind, report, { x, y }, width) {
  const [pace, fleet] = [report.driver[kind.key], report.fleet?.[kind.key]];
  if (pace.bins.length + pace.means.length === 0) return [note('No log has a stretch of it.')];
  const frame = chartFrame(width, Math.max(260, Math.round(width * 0.58)), x, y);
  const points = pace.means.filter(([speed, accel]) => speed >= 0 && speed <= x.high && accel >= 0 && accel <= y.high);
  const runs = stretches(pace.bins);
  const beside = stretches((fleet?.bins ?? []).filter(({ to }) => to <= x.high + 0.01));
  const drawn = picture(frame, paceLabel(kind, pace, fleet), [
    ...frame.axes,
    pointCloud(points, frame, kind.colour),
    ...runs.map((stations) => bandNode(stations, frame, kind.colour)),
    ...beside.map((stations) => lineNode(medians(stations), frame, FLEET)),
    ...runs.map((stations) => lineNode(medians(stations), frame, { colour: kind.colour, width: 2.5 })),
  ]);
  const caption = paceCaption(pace, fleet, pace.means.length - points.length);
  const chart = hoverable(frame, drawn, (speed) => paceTold(pace, fleet, speed));
  return [chart, paceLegend(kind, fleet), el('figcaption', {}, caption)];
}

function paceTable({ key, title }, { driver, fleet }) {
  const besides = (bin) => fleet?.[key].bins.find(({ from }) => Math.abs(from - bin.from) < 0.01)?.median;
  const columns = [
    { label: 'From', unit: 'km/h', value: ({ from }) => from, digits: 0 },
    { label: 'To', unit: 'km/h', value: ({ to }) => to, digits: 0 },
    { label: 'Samples', value: ({ samples }) => samples, digits: 0 },
    { label: '10 %', unit: 'm/s²', value: ({ p10 }) => p10, digits: 2 },
    { label: 'Median', unit: 'm/s²', value: ({ median }) => median, digits: 2 },
    { label: '90 %', unit: 'm/s²', value: ({ p90 }) => p90, digits: 2 },
    ...(fleet ? [{ label: 'Fleet', unit: 'median, m/s²', value: (bin) => besides(bin) ?? NaN, digits: 2 }] : []),
  ];
  return sortableTable(`${title} by speed`, columns, driver[key].bins);
}

function paceSection(report) {
  const axes = paceAxes(report);
  if (axes === null) return absent('pace', 'No log has a stretch of acceleration or braking on a free road.');
  const figures = PACES.map((kind) => ({ kind, body: el('div') }));
  byId('pace-body').append(...figures.map(({ kind, body }) => el('figure', {}, el('h3', {}, kind.title), body)));
  const tabled = PACES.filter(({ key }) => report.driver[key].bins.length > 0);
  const table = (kind) =>
    collapsible(`${kind.title} by speed`, plural(report.driver[kind.key].bins.length, 'bin'), () => paceTable(kind, report));
  byId('pace-table').append(...tabled.map(table));
  return () => figures.forEach(({ kind, body }) => body.replaceChildren(...paceFigure(kind, report, axes, chartWidth(body))));
}

// ---------------------------------------------------------------- limits

const LIMITS = { most: 760, pitch: 46, top: 30, bottom: 46, left: 78, right: 72, bar: 10 };

function lasting(seconds) {
  if (Number.isNaN(seconds)) return '–';
  if (seconds < 60) return quantity(seconds, 0, 's');
  return seconds < 3600 ? quantity(seconds / 60, 0, 'min') : quantity(seconds / 3600, 1, 'h');
}

/** Each limit of the driver with the median of the fleet under it. */
function limitRows({ driver, fleet }) {
  const beside = (row) => fleet?.limits.find(({ limit }) => Math.round(limit) === Math.round(row.limit))?.median;
  return driver.limits.map((row) => ({ ...row, fleet: beside(row) ?? NaN }));
}

function limitWords({ limit, durationS, p10, median, p90, fleet }) {
  const range = `median ${signed(median, 1)}, from ${signed(p10, 1)} to ${signed(p90, 1)} km/h`;
  const beside = Number.isFinite(fleet) ? `, fleet ${signed(fleet, 1)}` : '';
  return `Limit ${quantity(limit, 0, 'km/h')}: ${range}${beside}, over ${lasting(durationS)}`;
}

/** Wider than the dot, so as to be seen around it. */
function fleetRing(cx, cy) {
  const ring = svg('circle', { class: 'ring', cx, cy, r: 7.5 });
  ring.style.fill = 'none';
  return ring;
}

function limitNodes(row, index, x, width) {
  const middle = LIMITS.top + (index + 0.6) * LIMITS.pitch;
  const [from, to] = [x(row.p10), x(row.p90)];
  const bar = { x: from, y: middle - LIMITS.bar / 2, width: Math.max(to - from, 2), height: LIMITS.bar, rx: LIMITS.bar / 2 };
  const parts = [
    svg('title', {}, limitWords(row)),
    svg('text', { class: 'name', x: 0, y: middle + 4 }, quantity(row.limit, 0, 'km/h')),
    svg('text', { x: width, y: middle + 4, 'text-anchor': 'end' }, lasting(row.durationS)),
    svg('rect', { class: 'range', ...bar }),
    svg('circle', { class: 'dot', cx: x(row.median), cy: middle, r: 5.5 }),
    svg('text', { class: 'value over', x: x(row.median), y: middle - 12, 'text-anchor': 'middle' }, signed(row.median, 1)),
  ];
  return svg('g', {}, ...parts, ...(Number.isFinite(row.fleet) ? [fleetRing(x(row.fleet), middle)] : []));
}

function limitChart(rows, width) {
  const ends = rows.flatMap(({ p10, median, p90, fleet }) => [p10, median, p90, ...(Number.isFinite(fleet) ? [fleet] : [])]);
  const [low, high] = [Math.min(-1, ...ends), Math.max(1, ...ends)];
  const [left, right, bottom] = [LIMITS.left + 8, width - LIMITS.right - 8, LIMITS.top + rows.length * LIMITS.pitch];
  const x = linear(low, high, left, right);
  const along = ({ value, label }) => [
    svg('line', { class: value === 0 ? 'mean' : 'grid', x1: x(value), x2: x(value), y1: LIMITS.top, y2: bottom }),
    svg('text', { x: x(value), y: bottom + 16, 'text-anchor': 'middle' }, value > 0 ? `+${label}` : label),
  ];
  const label = `Speed less limit while cruising. ${rows.map(limitWords).join('; ')}.`;
  return picture({ width, height: bottom + LIMITS.bottom }, label, [
    ...ticks(low, high, Math.max(5, (right - left) / 60)).flatMap(along),
    svg('text', { class: 'name', x: x(0), y: LIMITS.top - 8, 'text-anchor': 'middle' }, 'limit'),
    svg('text', { x: right, y: bottom + 36, 'text-anchor': 'end' }, 'speed less limit, km/h'),
    ...rows.map((row, index) => limitNodes(row, index, x, width)),
  ]);
}

function limitLegend(rows, fleet) {
  if (!fleet) return [];
  if (!rows.some((row) => Number.isFinite(row.fleet))) return [note('The fleet has none of these limits.')];
  const [dot, ring] = [swatch('--accent'), swatch('--paper')];
  for (const sample of [dot, ring]) sample.style.borderRadius = '50%';
  ring.style.boxShadow = 'inset 0 0 0 1.5px var(--quiet)';
  return [legendOf([[dot, 'median'], [ring, 'median of the fleet']])];
}

function limitSection(report) {
  const rows = limitRows(report);
  if (rows.length === 0) return absent('limits', 'No log has speed limits, or none that the driver cruises under for 10\u00a0s.');
  const body = el('figure');
  byId('limits-body').append(body);
  return () => body.replaceChildren(limitChart(rows, chartWidth(body, LIMITS.most)), ...limitLegend(rows, report.fleet));
}

// ---------------------------------------------------------------- headway

const HEADWAY = { most: 760, near: 1 };

function headwayFrame(headway, fleet, width) {
  const bins = [...headway.bins, ...(fleet?.bins ?? [])];
  const x = { low: 0, high: Math.max(...bins.map(({ to }) => to)), unit: 'headway, s' };
  const y = { low: 0, high: 1.1 * Math.max(...bins.map(({ share }) => share)) || 1, unit: '% of time' };
  return chartFrame(width, Math.max(250, Math.round(width * 0.42)), x, y);
}

function shareBar({ from, to, share }, { x, y, box }) {
  const place = { x: x(from) + 0.5, y: y(share), width: Math.max(x(to) - x(from) - 1, 1), height: box.bottom - y(share) };
  const title = `${fixed(from, 2)} to ${quantity(to, 2, 's')}: ${quantity(share, 1, '%')} of the time`;
  return coloured(svg('rect', { class: 'bar', ...place }, svg('title', {}, title)), 'fill', '--series-5');
}

function outlineNode(bins, frame) {
  const corners = bins.flatMap(({ from, to, share }) => [[from, share], [to, share]]);
  return lineNode([[bins[0].from, 0], ...corners, [bins.at(-1).to, 0]], frame, FLEET);
}

function nearNode({ x, box }) {
  const place = { x: box.left, y: box.top, width: Math.min(x(HEADWAY.near), box.right) - box.left, height: box.bottom - box.top };
  return coloured(svg('rect', { ...place, 'fill-opacity': 0.14 }), 'fill', '--braking');
}

function headwayMark(median, { x, box }) {
  if (!(median >= 0 && x(median) <= box.right)) return [];
  const at = x(median);
  const anchor = at < (box.left + box.right) / 2 ? 'start' : 'end';
  return [
    svg('line', { class: 'mean', x1: at, x2: at, y1: box.top - 4, y2: box.bottom }),
    svg('text', { class: 'name', x: at, y: box.top - 9, 'text-anchor': anchor }, `median ${quantity(median, 1, 's')}`),
  ];
}

function headwayLegend({ underPct }, fleet) {
  const shade = swatch('--braking');
  shade.style.opacity = 0.3;
  const near = Number.isFinite(underPct) ? `, ${quantity(underPct, 0, '%')} of the time` : '';
  const own = [[swatch('--series-5'), 'share of the time'], [shade, `under 1\u00a0s${near}`]];
  const beside = fleet ? `fleet, median ${quantity(fleet.median, 1, 's')}` : '';
  return legendOf([...own, ...(fleet ? [[strokeSample(FLEET.colour, FLEET.kind), beside]] : [])]);
}

function headwayLabel(headway, fleet) {
  const eightTenths = `from ${fixed(headway.p10, 1)} to ${fixed(headway.p90, 1)} s for eight tenths of the time`;
  const beside = fleet ? `; the fleet ${fixed(fleet.median, 1)} s at the median` : '';
  const near = `under 1 s for ${fixed(headway.underPct, 0)} %`;
  return `Time headway: median ${fixed(headway.median, 1)} s, ${eightTenths}, ${near}${beside}.`;
}

function headwayFigure(headway, fleet, width) {
  const frame = headwayFrame(headway, fleet, width);
  const drawn = picture(frame, headwayLabel(headway, fleet), [
    nearNode(frame),
    ...frame.axes,
    ...headway.bins.map((bin) => shareBar(bin, frame)),
    ...(fleet ? [outlineNode(fleet.bins, frame)] : []),
    ...headwayMark(headway.median, frame),
  ]);
  const caption = `${lasting(headway.durationS)} behind a vehicle.`;
  return [drawn, headwayLegend(headway, fleet), ...(headway.durationS >= 0 ? [el('figcaption', {}, caption)] : [])];
}

function headwaySection({ driver, fleet }) {
  if (driver.headway === null) return absent('headway', 'No log has a gap to a vehicle ahead that is near enough.');
  const body = el('figure');
  byId('headway-body').append(body);
  return () => body.replaceChildren(...headwayFigure(driver.headway, fleet?.headway, chartWidth(body, HEADWAY.most)));
}
