// ---------------------------------------------------------------- the portrait document

const SCHEMA = 'drivekit/portrait/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'driver', 'sentences'];

function readPortrait(source) {
  const doc = object(source);
  return {
    ...readFrame(doc, SCHEMA_KEYS),
    sentences: list(doc.sentences).filter((sentence) => typeof sentence === 'string' && sentence !== ''),
    driver: readDriver(doc.driver),
    fleet: member(doc.fleet, 'drives') === undefined ? null : readDriver(doc.fleet),
  };
}

function readDriver(source) {
  const raw = object(source);
  return {
    drives: number(raw.drives),
    distanceM: number(raw.distance_m),
    durationS: number(raw.duration_s),
    acceleration: readPace(raw.acceleration),
    braking: readPace(raw.braking),
    limits: readLimits(raw.limits),
    headway: readHeadway(raw.headway),
    dynamics: object(raw.dynamics),
    economy: object(raw.economy),
  };
}

function readSpread(source, convert) {
  const [p10, median, p90] = ['p10', 'median', 'p90'].map((key) => convert(member(source, key)));
  return { p10, median, p90 };
}

const isKnown = ({ p10, median, p90 }) => Number.isFinite(p10 + median + p90);

function readPace(source) {
  const raw = object(source);
  const bin = (one) => ({
    from: kmh(one.from_mps),
    to: kmh(one.to_mps),
    samples: number(one.samples),
    ...readSpread(one.accel_mps2, number),
  });
  const bins = list(raw.bins).map(object).map(bin);
  const means = list(raw.means).map((pair) => [kmh(list(pair)[0]), number(list(pair)[1])]);
  return {
    ...readSpread(raw.accel_mps2, number),
    bins: sortRows(bins.filter((one) => one.to > one.from && isKnown(one)), ({ from }) => from, false),
    means: means.filter(([speed, accel]) => Number.isFinite(speed + accel)),
  };
}

function readLimits(source) {
  const row = (raw) => ({
    limit: kmh(raw.limit_mps),
    durationS: number(raw.duration_s),
    ...readSpread(raw.excess_mps, kmh),
  });
  const rows = list(source).map(object).map(row).filter((one) => Number.isFinite(one.limit) && isKnown(one));
  return sortRows(rows, ({ limit }) => limit, false);
}

function readHeadway(source) {
  const raw = object(source);
  const bin = (one) => ({ from: number(one.from_s), to: number(one.to_s), share: number(one.share_pct) });
  const bins = list(raw.bins).map(object).map(bin).filter(({ from, to, share }) => to > from && share >= 0);
  if (bins.length === 0) return null;
  const { p10, median, p90 } = readSpread(raw.headway_s, number);
  return { bins, p10, median, p90, underPct: number(raw.under_1_s_pct), durationS: number(raw.duration_s) };
}

const differencePct = (own, fleet) => (fleet > 0 ? 100 * (own / fleet - 1) : NaN);

// ---------------------------------------------------------------- smoothness and energy

const PER_100KM = 'kWh/100 km';

const FIGURES = [
  { part: 'dynamics', key: 'relative_positive_accel_mps2', name: 'Relative positive acceleration', unit: 'm/s²', digits: 3 },
  { part: 'dynamics', key: 'speed_times_accel_p95_m2ps3', name: 'Speed × acceleration, 95 % below', unit: 'm²/s³', digits: 1 },
  { part: 'dynamics', key: 'accel_rms_mps2', name: 'Acceleration, root mean square', unit: 'm/s²', digits: 2 },
  { part: 'dynamics', key: 'jerk_rms_mps3', name: 'Jerk, root mean square', unit: 'm/s³', digits: 2 },
  { part: 'dynamics', key: 'stops_per_km', name: 'Stops', unit: 'per km', digits: 2 },
  { part: 'dynamics', key: 'steady_pct', name: 'Steady speed', unit: '% of the time in motion', digits: 1 },
  { part: 'economy', key: 'consumption_kwh_per_100km', name: 'Consumption as recorded', unit: PER_100KM, digits: 2 },
  { part: 'economy', key: 'smooth_consumption_kwh_per_100km', name: 'Consumption smoothed', unit: PER_100KM, digits: 2 },
  { part: 'economy', key: 'restless_pct', name: 'Cost of restlessness', unit: '% of the consumption', digits: 1 },
  { part: 'economy', key: 'friction_brake_kwh_per_100km', name: 'Lost in the friction brakes', unit: PER_100KM, digits: 2 },
];

function figureRow({ part, key, name, unit, digits }, { driver, fleet }) {
  const [own, beside] = [driver, fleet].map((one) => number(one?.[part][key]));
  const compared = fleet ? [fixed(beside, digits), signed(differencePct(own, beside), 0)] : [];
  const label = el('th', { scope: 'row' }, name, el('small', {}, unit));
  label.style.whiteSpace = 'normal';
  return el('tr', {}, label, ...[fixed(own, digits), ...compared].map((cell) => el('td', {}, cell)));
}

function figureTable(report) {
  const names = ['Driver', ...(report.fleet ? ['Fleet', 'Difference, %'] : [])];
  const head = el('tr', {}, heading('Figure', 'text corner'), ...names.map((name) => heading(name)));
  return tableBox('Smoothness and energy', [head], [el('tbody', {}, ...FIGURES.map((spec) => figureRow(spec, report)))]);
}

const ENERGY_BARS = { most: 720, pitch: 58, text: 14, bar: 18 };

function energyBars(recorded, smooth, width) {
  const x = linear(Math.min(0, recorded, smooth), Math.max(0, recorded, smooth), 0, width);
  const saved = differencePct(smooth, recorded);
  const change = Number.isFinite(saved) ? ` (${signed(saved, 1)}\u00a0%)` : '';
  const row = ({ name, value, words, look }, index) => {
    const y = index * ENERGY_BARS.pitch;
    const [from, to] = [0, value].map(x).sort((a, b) => a - b);
    const bar = { x: from, y: y + ENERGY_BARS.text + 8, width: Math.max(to - from, 1), height: ENERGY_BARS.bar, rx: 2 };
    return [
      svg('text', { class: 'name', x: 0, y: y + ENERGY_BARS.text }, name),
      svg('text', { class: 'value', x: width, y: y + ENERGY_BARS.text, 'text-anchor': 'end' }, words),
      svg('rect', { class: look, ...bar }),
    ];
  };
  const rows = [
    { name: 'As recorded', value: recorded, words: quantity(recorded, 1, PER_100KM), look: 'part' },
    { name: 'Smoothed', value: smooth, words: `${quantity(smooth, 1, PER_100KM)}${change}`, look: 'dot' },
  ];
  const label = `Consumption. ${rows.map(({ name, words }) => `${name} ${words}`).join('; ')}.`;
  return picture({ width, height: rows.length * ENERGY_BARS.pitch - 16 }, label, rows.flatMap(row));
}

function smoothWords({ economy }) {
  const metres = number(economy.largest_deviation_m);
  const near = `, which takes the car never more than ${quantity(metres, 1, 'm')} away from where it was`;
  return [
    `Smoothed: the same drives with the speed averaged over a Hann window of 10\u00a0s${Number.isFinite(metres) ? near : ''}.`,
    'Distance and time stay the same, and so near the traffic would have allowed it. The difference is what restless speed costs.',
  ].join(' ');
}

function smoothSection(report) {
  const { economy } = report.driver;
  const [recorded, smooth] = ['consumption_kwh_per_100km', 'smooth_consumption_kwh_per_100km'].map((key) => number(economy[key]));
  const body = el('div');
  const caption = el('figcaption', {}, smoothWords(report.driver));
  const known = Number.isFinite(recorded + smooth);
  const content = known ? [body, caption] : [note('The document has no consumption to compare.')];
  byId('smoothness-body').append(el('figure', {}, el('h3', {}, 'Consumption'), ...content));
  byId('smoothness-body').append(el('div', { class: 'part' }, el('h3', {}, 'Figures'), figureTable(report)));
  return () => known && body.replaceChildren(energyBars(recorded, smooth, chartWidth(body, ENERGY_BARS.most)));
}

// ---------------------------------------------------------------- main

const driven = ({ drives, distanceM, durationS }) =>
  `${plural(drives, 'drive')}, ${quantity(distanceM / 1000, 0, 'km')} in ${quantity(durationS / 3600, 1, 'h')}`;

/** Numbers stay on a line with their units. */
const unbroken = (sentence) => sentence.replace(/(\d) (?=%|km|kWh|[mhs]\b)/g, '$1\u00a0');

/** The sentences after the first, which is the headline. */
function sentenceList(sentences) {
  const items = sentences.map((sentence) => el('li', {}, unbroken(sentence)));
  const node = el('ul', { id: 'sentences', role: 'list', 'aria-label': 'The driver in sentences' }, ...items);
  const look = { display: 'grid', gap: '0.9em', maxWidth: '46rem', margin: '2rem 0', padding: 0, listStyle: 'none' };
  Object.assign(node.style, look, { fontSize: 'clamp(1.1rem, 1rem + 0.5vw, 1.35rem)', lineHeight: 1.5 });
  return node;
}

function introduce({ version, sentences, driver, fleet }) {
  byId('version').append(version);
  const [opening = `${driven(driver)}.`, ...rest] = sentences;
  byId('headline').append(fleet ? `${opening} Beside a fleet of ${driven(fleet)}.` : opening);
  if (rest.length > 0) byId('headline').after(sentenceList(rest));
  const facts = [
    ['Accelerates, median', driver.acceleration.median, 1, 'm/s²'],
    ['Brakes, median', driver.braking.median, 1, 'm/s²'],
    ['Headway, median', driver.headway?.median, 1, 's'],
    ['At steady speed', number(driver.dynamics.steady_pct), 0, '%'],
    ['Consumption', number(driver.economy.consumption_kwh_per_100km), 1, PER_100KM],
  ].filter(([, value]) => Number.isFinite(value));
  byId('facts').hidden = facts.length === 0;
  byId('facts').append(...facts.map(([term, value, digits, unit]) => fact(term, fixed(value, digits), unit)));
}

function main() {
  const report = readPortrait(parseDocument());
  introduce(report);
  problems(report, SCHEMA);
  const draws = [paceSection, limitSection, headwaySection, smoothSection].map((section) => section(report));
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  keepDrawn(() => draws.forEach((draw) => draw()));
}

main();
