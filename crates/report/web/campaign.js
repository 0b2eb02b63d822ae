// ---------------------------------------------------------------- the document of a campaign

const SCHEMA = 'drivekit/ctrl-campaign/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'runs', 'rows', 'totals', 'histograms', 'violations'];

const PRESET_COLOURS = ['--series-0', '--series-1', '--series-2', '--series-3', '--series-6', '--series-7'];
const MOST_VIOLATIONS = 500;

const millimetres = (metres) => number(metres) * 1000;

function readResult(raw) {
  return {
    ...{ preset: text(raw.preset), disturbance: text(raw.disturbance), testbed: text(raw.testbed), scenario: text(raw.scenario) },
    ...{ runs: number(raw.runs), unsafe: number(raw.unsafe) },
    ...{ departures: number(raw.lane_departures), violations: number(raw.headway_violations) },
    ...{ headway: millimetres(raw.min_h_headway_m), clearance: millimetres(raw.min_lane_clearance_m) },
    ...{ relaxed: number(raw.relaxed_pct), braking: number(raw.braking_pct), speed: number(raw.mean_speed_mps) },
  };
}

function readCounts(source) {
  const raw = object(source);
  const [from, step] = [number(raw.from), number(raw.step)];
  const counts = list(raw.counts).map((count) => Math.max(number(count) || 0, 0));
  if (!(step > 0 && Number.isFinite(from))) return [];
  return counts.map((count, index) => ({ from: from + index * step, to: from + (index + 1) * step, count }));
}

function readHistogram(raw) {
  return {
    ...{ preset: text(raw.preset), disturbance: text(raw.disturbance) },
    ...{ headway: readCounts(raw.headway_mm), clearance: readCounts(raw.clearance_mm) },
  };
}

function readViolation(raw) {
  return {
    ...{ preset: text(raw.preset), testbed: text(raw.testbed), scenario: text(raw.scenario), disturbance: text(raw.disturbance) },
    ...{ seed: text(raw.seed), command: text(raw.command), first: number(raw.first_unsafe_s) },
    ...{ headway: millimetres(raw.min_h_headway_m), clearance: millimetres(raw.lane_clearance_m) },
  };
}

const valuesOf = (rows, key) => [...new Set(rows.map((row) => row[key]))].filter((value) => value !== '');

function readCampaign(source) {
  const doc = object(source);
  const totals = list(doc.totals).map(object).map(readResult);
  const histograms = list(doc.histograms).map(object).map(readHistogram);
  const presets = valuesOf([...totals, ...histograms], 'preset').map((name, index) => {
    return { name, colour: PRESET_COLOURS[index % PRESET_COLOURS.length] };
  });
  return {
    ...readFrame(doc, SCHEMA_KEYS),
    ...{ seed: number(doc.seed), runs: number(doc.runs), durationS: number(doc.duration_s), simulatedS: number(doc.simulated_s) },
    ...{ seconds: number(doc.seconds), pace: number(doc.simulated_s_per_s) },
    rows: list(doc.rows).map(object).map(readResult),
    violations: list(doc.violations).map(object).map(readViolation),
    ...{ totals, histograms, presets },
  };
}

// ---------------------------------------------------------------- totals

const SHARES = { most: 900, title: 24, bar: 14, pitch: 20, gap: 12, bottom: 40, left: 90, right: 96 };

const unsafeShare = ({ unsafe, runs }) => (100 * unsafe) / runs;

function resultColumns(names) {
  return [
    ...names,
    { label: 'Runs', value: ({ runs }) => runs, digits: 0 },
    { label: 'Left the lane', unit: 'runs', value: ({ departures }) => departures, digits: 0 },
    { label: 'Too close', unit: 'runs', value: ({ violations }) => violations, digits: 0 },
    { label: 'Headway h', unit: 'least, mm', value: ({ headway }) => headway, digits: 1 },
    { label: 'To the edge', unit: 'least, mm', value: ({ clearance }) => clearance, digits: 1 },
    { label: 'Mean speed', unit: 'm/s', value: ({ speed }) => speed, digits: 3 },
    { label: 'Relaxed', unit: '% of steps', value: ({ relaxed }) => relaxed, digits: 2 },
    { label: 'Braking', unit: '% of steps', value: ({ braking }) => braking, digits: 2 },
  ];
}

const PRESET = { label: 'Preset', value: ({ preset }) => preset };
const DISTURBANCE = { label: 'Disturbance', value: ({ disturbance }) => disturbance };
const SCENARIO = { label: 'Scenario', value: ({ scenario }) => scenario };
const TESTBED = { label: 'Testbed', value: ({ testbed }) => testbed };
const UNSAFE = { label: 'Unsafe', unit: 'runs', value: ({ unsafe }) => unsafe, digits: 0 };

const countedWords = ({ unsafe, runs }) => `${fixed(unsafe, 0)} of ${fixed(runs, 0)}`;

function shareBar(total, colour, x, y) {
  const share = unsafeShare(total);
  const width = Number.isFinite(share) ? Math.max(x(share) - SHARES.left, 1) : 0;
  const title = svg('title', {}, `${total.preset}, ${total.disturbance}: ${countedWords(total)} runs unsafe, ${quantity(share, 1, '%')}`);
  const bar = coloured(svg('rect', { class: 'bar', x: SHARES.left, y, width, height: SHARES.bar, rx: 1 }, title), 'fill', colour);
  const words = svg('text', { class: 'value', x: SHARES.left + width + 6, y: y + SHARES.bar - 3 }, countedWords(total));
  return [svg('text', { x: SHARES.left - 6, y: y + SHARES.bar - 3, 'text-anchor': 'end' }, total.preset), bar, words];
}

/** For each disturbance the share of unsafe runs of each preset. */
function sharePicture({ totals, presets }, width) {
  const shares = totals.map(unsafeShare).filter(Number.isFinite);
  const high = Math.min(Math.max(1, ...shares) * 1.05, 100);
  const x = linear(0, high, SHARES.left, width - SHARES.right);
  let top = 0;
  const groups = valuesOf(totals, 'disturbance').flatMap((disturbance) => {
    const members = totals.filter((total) => total.disturbance === disturbance);
    const start = top;
    top += SHARES.title + members.length * SHARES.pitch + SHARES.gap;
    const colour = ({ preset }) => presets.find(({ name }) => name === preset)?.colour ?? '--other';
    const bar = (total, index) => shareBar(total, colour(total), x, start + SHARES.title + index * SHARES.pitch);
    return [svg('text', { class: 'name', x: 0, y: start + 15 }, disturbance), ...members.flatMap(bar)];
  });
  const along = ({ value, label }) => [
    svg('line', { class: 'grid', x1: x(value), x2: x(value), y1: 0, y2: top }),
    svg('text', { x: x(value), y: top + 16, 'text-anchor': 'middle' }, label),
  ];
  const told = totals.map((total) => `${total.preset}, ${total.disturbance} ${countedWords(total)}`).join('; ');
  return picture({ width, height: top + SHARES.bottom }, `Unsafe runs. ${told}.`, [
    ...ticks(0, high, Math.max(2, (width - SHARES.left - SHARES.right) / 60)).flatMap(along),
    svg('text', { x: width - SHARES.right, y: top + 34, 'text-anchor': 'end' }, 'unsafe runs, %'),
    ...groups,
  ]);
}

function totalSection(report) {
  if (report.totals.length === 0) return absent('totals', 'The document has no totals (totals).');
  const figure = el('figure');
  const table = sortableTable('Totals', resultColumns([PRESET, DISTURBANCE, UNSAFE]), report.totals);
  byId('totals-body').append(figure, el('div', { class: 'below' }, table));
  return () => figure.replaceChildren(sharePicture(report, chartWidth(figure, SHARES.most)));
}

// ---------------------------------------------------------------- margins

const MARGIN = { left: 44, right: 14, title: 22, bars: 64, gap: 16, bottom: 40 };
const MARGINS = [
  { key: 'headway', title: 'Least headway h of a run' },
  { key: 'clearance', title: 'Least distance to the edge in a run' },
];

/** The bins from the first to the last that is not empty, and zero. */
function marginRange(rows) {
  const filled = rows.flatMap(({ bins }) => bins.filter(({ count }) => count > 0));
  return { low: Math.min(0, ...filled.map(({ from }) => from)), high: Math.max(0, ...filled.map(({ to }) => to)) };
}

function marginRow({ name, colour, bins }, top, x, most, width) {
  const base = top + MARGIN.title + MARGIN.bars;
  const y = linear(0, most, base, top + MARGIN.title);
  const total = bins.reduce((sum, { count }) => sum + count, 0);
  const bars = bins.filter(({ count }) => count > 0).map(({ from, to, count }) => {
    const size = { x: x(from), y: y(count), width: Math.max(x(to) - x(from) - 0.5, 1), height: Math.max(base - y(count), 1) };
    const title = svg('title', {}, `${name}: ${significant(from)} to ${significant(to)}\u00a0mm, ${plural(count, 'run')} of ${fixed(total, 0)}`);
    return coloured(svg('rect', { class: 'bar', ...size }, title), 'fill', to <= 1e-9 ? '--braking' : colour);
  });
  return [
    svg('text', { class: 'name', x: MARGIN.left, y: top + 13 }, name),
    svg('text', { x: width - MARGIN.right, y: top + 13, 'text-anchor': 'end' }, plural(total, 'run')),
    svg('text', { x: MARGIN.left - 6, y: top + MARGIN.title + 8, 'text-anchor': 'end' }, fixed(most, 0)),
    svg('text', { x: MARGIN.left - 6, y: base, 'text-anchor': 'end' }, '0'),
    ...bars,
    svg('line', { class: 'axis', x1: MARGIN.left, x2: width - MARGIN.right, y1: base, y2: base }),
  ];
}

/** A histogram for each preset, all with one axis. */
function marginPicture({ title }, rows, width) {
  const { low, high } = marginRange(rows);
  const x = linear(low, high, MARGIN.left, width - MARGIN.right);
  const most = Math.max(1, ...rows.flatMap(({ bins }) => bins.map(({ count }) => count)));
  const pitch = MARGIN.title + MARGIN.bars + MARGIN.gap;
  const bottom = rows.length * pitch - MARGIN.gap;
  const below = ({ bins }) => bins.reduce((sum, { to, count }) => sum + (to <= 1e-9 ? count : 0), 0);
  const label = `${title}, histograms in mm. ${rows.map((row) => `${row.name}: ${plural(below(row), 'run')} below zero`).join('; ')}.`;
  const along = ({ value, label: words }) => [
    svg('line', { class: value === 0 ? 'mean' : 'grid', x1: x(value), x2: x(value), y1: MARGIN.title, y2: bottom }),
    svg('text', { ...labelPlace(x(value), width), y: bottom + 16 }, words),
  ];
  return picture({ width, height: bottom + MARGIN.bottom }, label, [
    ...ticks(low, high, Math.max(3, width / 70)).flatMap(along),
    svg('text', { x: width - MARGIN.right, y: bottom + 34, 'text-anchor': 'end' }, 'mm'),
    ...rows.flatMap((row, index) => marginRow(row, index * pitch, x, most, width)),
  ]);
}

function marginRows({ histograms, presets }, { key }, disturbance) {
  return presets.flatMap(({ name, colour }) => {
    const histogram = histograms.find((one) => one.preset === name && one.disturbance === disturbance);
    const bins = histogram?.[key] ?? [];
    return bins.some(({ count }) => count > 0) ? [{ name, colour, bins }] : [];
  });
}

function marginSection(report) {
  const choices = valuesOf(report.histograms, 'disturbance').map((label) => ({ label }));
  if (choices.length === 0) return absent('margins', 'The document has no histograms (histograms).');
  let [shown] = choices;
  const figures = MARGINS.map((spec) => ({ spec, body: el('div') }));
  byId('margins-body').append(...figures.map(({ spec, body }) => el('figure', {}, el('h3', {}, spec.title), body)));
  const draw = () =>
    figures.forEach(({ spec, body }) => {
      const rows = marginRows(report, spec, shown.label);
      const caption = el('figcaption', {}, `Disturbance: ${shown.label}.`);
      const drawn = rows.length > 0 ? marginPicture(spec, rows, chartWidth(body)) : note('No runs with this disturbance.');
      body.replaceChildren(drawn, caption);
    });
  const pick = (choice) => {
    shown = choice;
    draw();
  };
  byId('margins-controls').append(radios('Disturbance', 'disturbance', choices, pick));
  return draw;
}

// ---------------------------------------------------------------- tables

function scenarioSection({ rows }) {
  if (rows.length === 0) return absent('scenarios', 'The document has no rows (rows).');
  const unsafe = rows.some((row) => Number.isFinite(row.unsafe)) ? [UNSAFE] : [];
  byId('scenarios-body').append(sortableTable('Scenarios', resultColumns([SCENARIO, TESTBED, PRESET, DISTURBANCE, ...unsafe]), rows));
  return () => {};
}

function violationSection({ violations, runs }) {
  if (violations.length === 0) {
    byId('violations-body').append(note(runs > 0 ? 'The document lists no unsafe run.' : 'The document has no runs.'));
    return () => {};
  }
  const headings = ['Seed', 'Preset', 'Testbed', 'Scenario', 'Disturbance', 'At, s', 'Headway h, mm', 'To the edge, mm', 'Command'];
  const row = ({ seed, preset, testbed, scenario, disturbance, first, headway, clearance, command }) => {
    const values = [fixed(first, 2), fixed(headway, 1), fixed(clearance, 1)];
    const names = [seed, preset, testbed, scenario, disturbance].map((name) => name || '–');
    return [...names, ...values, el('code', {}, command || '–')];
  };
  const shown = violations.slice(0, MOST_VIOLATIONS);
  const rest = violations.length - shown.length;
  const more = rest > 0 ? [note(`${plural(rest, 'more run')} in the document.`)] : [];
  byId('violations-body').append(textTable('Unsafe runs', headings, shown.map(row)), ...more);
  return () => {};
}

// ---------------------------------------------------------------- main

function presetWords({ totals, presets }) {
  const words = presets.flatMap(({ name }) => {
    const own = totals.filter(({ preset, unsafe, runs }) => preset === name && Number.isFinite(unsafe + runs));
    const [unsafe, runs] = ['unsafe', 'runs'].map((key) => own.reduce((sum, total) => sum + total[key], 0));
    return runs > 0 ? [`${name}: ${unsafe === 0 ? 'none' : fixed(unsafe, 0)} of ${plural(runs, 'run')} unsafe`] : [];
  });
  return words.length > 0 ? ` ${words.join('; ')}.` : '';
}

function introduce(report) {
  const { version, runs, durationS, simulatedS, seconds, pace, seed } = report;
  byId('version').append(version);
  const each = Number.isFinite(durationS) ? ` of ${quantity(durationS, 0, 's')}` : '';
  const words = `${plural(runs, 'run')}${each}.${presetWords(report)}`;
  byId('headline').append(Number.isFinite(runs) ? words : 'How many runs there were is not known.');
  const facts = [
    ['Simulated', simulatedS / 3600, 1, 'h'],
    ['Took', seconds, 1, 's'],
    ['Faster than real time', pace, 0, '×'],
    ['First seed', seed, 0, ''],
  ].filter(([, value]) => Number.isFinite(value));
  byId('facts').hidden = facts.length === 0;
  byId('facts').append(...facts.map(([term, value, digits, unit]) => fact(term, fixed(value, digits), unit)));
}

function main() {
  const report = readCampaign(parseDocument());
  introduce(report);
  problems(report, SCHEMA);
  const draws = [totalSection, marginSection, scenarioSection, violationSection].map((section) => section(report));
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  keepDrawn(() => draws.forEach((draw) => draw()));
}

main();
