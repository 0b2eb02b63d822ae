// ---------------------------------------------------------------- histograms

const ROW = { title: 20, bars: 60, gap: 16 };
const MARGIN = { left: 38, right: 14, bottom: 38 };

const HISTOGRAMS = [
  {
    id: 'energy',
    title: 'Energy per phase',
    axis: 'Energy, kJ',
    unit: 'kJ',
    digits: 1,
    measured: (phase) => phase.energyKj,
    value: (phase, name) => kilojoules(prediction(phase, name).energy_j),
    caption: 'Energy of the measured speed above, of the predicted speeds below, through the same vehicle model.',
  },
  {
    id: 'energy-difference',
    title: 'Energy difference',
    axis: 'Measured − predicted energy, kJ',
    unit: 'kJ',
    digits: 2,
    zero: true,
    value: (phase, name) => phase.energyKj - kilojoules(prediction(phase, name).energy_j),
    caption: 'Positive where the prediction used less energy than the drive.',
  },
  {
    id: 'band',
    title: 'Share of samples in the band',
    axis: 'Samples in the band, %',
    unit: '%',
    digits: 1,
    bins: { low: 0, width: 5, count: 20 },
    value: (phase, name) => number(prediction(phase, name).in_band_pct),
    caption: 'Share of a phase in which the predicted speed lies within the band around the measured one. More is better.',
  },
  {
    id: 'squared-error',
    title: '√SSE / n',
    axis: '√SSE / n, km/h',
    unit: 'km/h',
    digits: 3,
    value: (phase, name) => kmh(prediction(phase, name).sqrt_sse_per_sample_mps),
    caption: 'Root of the sum of squared errors over the number of samples of the phase. Less is better.',
  },
];

function histogramRows(spec, report, shown) {
  const row = (name, colour, value) => ({ name, colour, values: report.phases.map(value).filter(Number.isFinite) });
  const models = report.models.filter((model) => shown.has(model.name));
  const rows = models.map(({ name, colour }) => row(name, colour, (phase) => spec.value(phase, name)));
  return spec.measured ? [row('measured', '--measured', spec.measured), ...rows] : rows;
}

/** Bins over all rows. The axis leaves out the outermost half percent where that would stretch it by more than a half. */
function histogramBins(spec, rows) {
  if (spec.bins) return spec.bins;
  const sorted = Float64Array.from(rows.flatMap((row) => row.values)).sort();
  const [least, most] = [sorted[0], sorted[sorted.length - 1]];
  const [inner, outer] = [quantile(sorted, 0.005), quantile(sorted, 0.995)];
  const [low, high] = most - least > 1.5 * (outer - inner) && outer > inner ? [inner, outer] : [least, most];
  const width = niceStep(high - low, 60);
  const first = Math.floor(low / width + 1e-9);
  return { low: first * width, width, count: Math.max(Math.floor(high / width + 1e-9) - first + 1, 1) };
}

function countBins(values, bins) {
  const counts = new Array(bins.count).fill(0);
  let beyond = 0;
  for (const value of values) {
    const position = (value - bins.low) / bins.width + 1e-9;
    // The upper end belongs to the last bin: 100 % is a value like any other.
    const index = position <= bins.count + 1e-6 ? Math.min(Math.floor(position), bins.count - 1) : -1;
    if (index >= 0) counts[index] += 1;
    else beyond += 1;
  }
  return { counts, beyond };
}

function histogramBars(row, bins, tally, x, y, spec) {
  const gap = x(bins.low + bins.width) - x(bins.low) > 5 ? 1 : 0;
  const digits = stepDigits(bins.width);
  return tally.counts.flatMap((count, index) => {
    if (count === 0) return [];
    const [from, to] = [bins.low + index * bins.width, bins.low + (index + 1) * bins.width];
    const range = `${fixed(from, digits)} to ${quantity(to, digits, spec.unit)}`;
    const title = `${row.name}: ${range}, ${plural(count, 'phase')} of ${fixed(row.values.length, 0)}`;
    const width = Math.max(x(to) - x(from) - gap, 1);
    const bar = svg('rect', { class: 'bar', x: x(from), y: y(count), width, height: y(0) - y(count) }, svg('title', {}, title));
    bar.style.fill = `var(${row.colour})`;
    return [bar];
  });
}

function histogramRow(row, spec, bins, tally, x, top, most, width) {
  const base = top + ROW.title + ROW.bars;
  const y = linear(0, most, base, top + ROW.title);
  const centres = [{ kind: 'mean', at: mean(row.values) }];
  if (spec.median) centres.push({ kind: 'median', at: medianOf(row.values) });
  const named = centres.map(({ kind, at }) => `${kind} ${fixed(at, spec.digits)}`).join(', ');
  const roomy = centres.length === 1 || width >= 420;
  const summary = row.values.length > 0 ? `${named}${roomy ? `\u00a0${spec.unit}` : ''}` : 'no values';
  const parts = [
    svg('text', { class: 'name', x: MARGIN.left, y: top + 12 }, row.name),
    svg('text', { x: width - MARGIN.right, y: top + 12, 'text-anchor': 'end' }, summary),
    svg('text', { x: MARGIN.left - 6, y: top + ROW.title + 10, 'text-anchor': 'end' }, fixed(most, 0)),
    svg('text', { x: MARGIN.left - 6, y: base, 'text-anchor': 'end' }, '0'),
    ...histogramBars(row, bins, tally, x, y, spec),
    svg('line', { class: 'axis', x1: MARGIN.left, x2: width - MARGIN.right, y1: base, y2: base }),
  ];
  for (const { kind, at } of centres) {
    const inside = at >= bins.low && at <= bins.low + bins.count * bins.width;
    if (inside) parts.push(svg('line', { class: kind, x1: x(at), x2: x(at), y1: base, y2: top + ROW.title - 3 }));
  }
  return svg('g', {}, ...parts);
}

/** A column of histograms with one axis of values and one scale of counts. */
function histogram(spec, rows, bins, tallies, width) {
  const most = Math.max(1, ...tallies.flatMap((tally) => tally.counts));
  const high = bins.low + bins.count * bins.width;
  const x = linear(bins.low, high, MARGIN.left, width - MARGIN.right);
  const pitch = ROW.title + ROW.bars + ROW.gap;
  const bottom = rows.length * pitch - ROW.gap;
  const height = bottom + MARGIN.bottom;
  const marks = ticks(bins.low, high, Math.max(3, Math.floor(width / 55)));
  const middle = (values) => (spec.median ? `, median ${quantity(medianOf(values), spec.digits, spec.unit)}` : '');
  const means = rows.map((row) => `${row.name}: mean ${quantity(mean(row.values), spec.digits, spec.unit)}${middle(row.values)}`);
  const label = `${spec.title}, histograms over phases. ${means.join('; ')}.`;
  const gridLine = ({ value }) => {
    const kind = spec.zero && value === 0 ? 'zero' : 'grid';
    return svg('line', { class: kind, x1: x(value), x2: x(value), y1: ROW.title, y2: bottom });
  };
  const axisText = (position, below, content) =>
    svg('text', { ...labelPlace(position, width), y: bottom + below }, content);
  return svg(
    'svg',
    { viewBox: `0 0 ${width} ${height}`, width, height, role: 'img', 'aria-label': label },
    ...marks.map(gridLine),
    ...rows.map((row, index) => histogramRow(row, spec, bins, tallies[index], x, index * pitch, most, width)),
    ...marks.map((mark) => axisText(x(mark.value), 16, mark.label)),
    axisText((MARGIN.left + width - MARGIN.right) / 2, 34, spec.axis),
  );
}

function drawHistogram(spec, report, shown) {
  const body = byId(`${spec.id}-body`);
  const rows = histogramRows(spec, report, shown);
  if (rows.every((row) => row.values.length === 0)) {
    body.replaceChildren(note(report.phases.length === 0 ? 'The document has no phases.' : 'No values for the chosen models.'));
    return;
  }
  const bins = histogramBins(spec, rows);
  const tallies = rows.map((row) => countBins(row.values, bins));
  const picture = histogram(spec, rows, bins, tallies, Math.max(Math.floor(body.clientWidth), 240));
  body.replaceChildren(el('figure', {}, picture, el('figcaption', {}, histogramCaption(spec, rows, bins, tallies))));
}

function histogramCaption(spec, rows, bins, tallies) {
  const counts = rows.map((row, index) => ({ name: row.name, count: tallies[index].beyond })).filter(({ count }) => count > 0);
  const beyond = counts.map(({ name, count }) => `${name} ${fixed(count, 0)}`);
  const width = quantity(bins.width, stepDigits(bins.width), spec.unit);
  const left = beyond.length > 0 ? ` Phases beyond the axis: ${beyond.join(', ')}.` : '';
  const lines = `the vertical line is the mean${spec.median ? ', the dashed one the median' : ''}`;
  return `${spec.caption} Bins of ${width}; heights are counts of phases; ${lines}.${left}`;
}
