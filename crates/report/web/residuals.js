// ---------------------------------------------------------------- residuals

const RESIDUAL = { left: 44, right: 12, top: 22, bottom: 40, height: 230 };

const RESIDUALS = [
  { key: 'speed', title: 'By speed', unit: 'km/h', convert: kmh, digits: 0 },
  { key: 'power', title: 'By measured power', unit: 'kW', convert: kilowatts, digits: 1 },
  { key: 'temperature', title: 'By temperature outside', unit: '°C', convert: number, digits: 1 },
];

function readBins(report, { key, convert }) {
  const bins = list(member(report.residuals, key)).map((source) => {
    const raw = object(source);
    return {
      from: convert(raw.from),
      to: convert(raw.to),
      count: number(raw.count),
      mean: kilowatts(raw.mean_w),
      rms: kilowatts(raw.rms_w),
    };
  });
  return bins.filter((bin) => bin.to > bin.from && Number.isFinite(bin.mean));
}

function binTitle(bin, { unit, digits }) {
  const range = `${fixed(bin.from, digits)} to ${quantity(bin.to, digits, unit)}`;
  const figures = `mean ${signed(bin.mean, 2)}\u00a0kW, RMS ${quantity(bin.rms, 2, 'kW')}`;
  return `${range}: ${figures}, ${plural(bin.count, 'sample')}`;
}

function binNodes(bin, spec, x, y) {
  const [from, to] = [x(bin.from) + 0.5, x(bin.to) - 0.5];
  const width = Math.max(to - from, 1);
  const spread = bin.rms || 0;
  const top = y(bin.mean + spread);
  return svg(
    'g',
    { class: 'bar' },
    svg('title', {}, binTitle(bin, spec)),
    svg('rect', { class: 'range', x: from, y: top, width, height: Math.max(y(bin.mean - spread) - top, 1) }),
    svg('rect', { class: 'dot', x: from, y: y(bin.mean) - 1.25, width, height: 2.5 }),
  );
}

function residualChart(spec, bins, width) {
  const ends = bins.flatMap(({ mean: middle, rms }) => [middle - (rms || 0), middle + (rms || 0)]);
  const [low, high] = [Math.min(0, ...ends), Math.max(0, ...ends)];
  const [left, right, bottom] = [RESIDUAL.left, width - RESIDUAL.right, RESIDUAL.height - RESIDUAL.bottom];
  const [first, last] = [Math.min(...bins.map((bin) => bin.from)), Math.max(...bins.map((bin) => bin.to))];
  const x = linear(first, last, left, right);
  const y = linear(low, high === low ? low + 1 : high, bottom, RESIDUAL.top);
  const across = ({ value, label }) => [
    svg('line', { class: value === 0 ? 'zero' : 'grid', x1: left, x2: right, y1: y(value), y2: y(value) }),
    svg('text', { x: left - 6, y: y(value) + 4, 'text-anchor': 'end' }, label),
  ];
  const along = ({ value, label }) => [
    svg('line', { class: 'axis', x1: x(value), x2: x(value), y1: bottom, y2: bottom + 4 }),
    svg('text', { x: x(value), y: bottom + 17, 'text-anchor': 'middle' }, label),
  ];
  const size = { viewBox: `0 0 ${width} ${RESIDUAL.height}`, width, height: RESIDUAL.height };
  return svg(
    'svg',
    { ...size, role: 'img', 'aria-label': `Residual power ${spec.title.toLowerCase()}, mean and root mean square` },
    ...ticks(low, high, 5).flatMap(across),
    ...ticks(first, last, Math.max(3, (right - left) / 55)).flatMap(along),
    svg('text', { x: 0, y: 10 }, 'kW'),
    svg('text', { x: right, y: bottom + 34, 'text-anchor': 'end' }, spec.unit),
    ...bins.map((bin) => binNodes(bin, spec, x, y)),
  );
}

function drawResiduals(report) {
  const body = byId('residuals-body');
  const figures = RESIDUALS.map((spec) => ({ spec, figure: el('figure', {}, el('h3', {}, spec.title)) }));
  body.replaceChildren(...figures.map(({ figure }) => figure));
  for (const { spec, figure } of figures) {
    const bins = readBins(report, spec);
    const width = Math.max(Math.floor(figure.clientWidth), 240);
    figure.append(bins.length > 0 ? residualChart(spec, bins, width) : note('The document has no bins for it.'));
  }
}

function residualTables(report) {
  return RESIDUALS.flatMap((spec) => {
    const bins = readBins(report, spec);
    if (bins.length === 0) return [];
    const columns = [
      { label: 'From', unit: spec.unit, value: (bin) => bin.from, digits: spec.digits },
      { label: 'To', unit: spec.unit, value: (bin) => bin.to, digits: spec.digits },
      { label: 'Samples', value: (bin) => bin.count, digits: 0 },
      { label: 'Mean', unit: 'kW', value: (bin) => bin.mean, digits: 3 },
      { label: 'RMS', unit: 'kW', value: (bin) => bin.rms, digits: 3 },
    ];
    const label = `Residuals ${spec.title.toLowerCase()}`;
    return [collapsible(spec.title, plural(bins.length, 'bin'), () => sortableTable(label, columns, bins))];
  });
}
