// ---------------------------------------------------------------- fits of functions

const FIT = { points: 240, shades: 6, least: 0.1, most: 0.6, tail: 0.001 };
const FAMILIES = ['inverse', 'exponential', 'exponential-amplitude'];
const FITTED_TO = [
  { key: 'means', title: 'Fitted to segment means', row: 'segment means' },
  { key: 'samples', title: 'Fitted to all samples', row: 'all samples' },
];

function readFits(source, label) {
  const raw = object(source);
  const density = object(raw.density);
  const fits = list(raw.fits).map(object).map((fit) => ({
    model: text(fit.kind),
    fittedTo: text(fit.fitted_to),
    p: [number(fit.p0), number(fit.p1), number(fit.p2)],
    points: number(fit.points),
    residual: number(fit.residual_sum_of_squares),
  }));
  const cells = list(density.cells).map((cell) => list(cell).map(number));
  return {
    label,
    fits,
    means: list(raw.means).map((pair) => [kmh(list(pair)[0]), number(list(pair)[1])]).filter(([v, a]) => Number.isFinite(v + a)),
    cells: cells.filter(([i, j, count]) => Number.isFinite(i + j) && count > 0),
    step: [kmh(density.speed_step_mps), number(density.accel_step_mps2)],
  };
}

/** The acceleration in m/s² that a fit gives at a speed in m/s. */
function fitted({ model, p: [p0, p1, p2] }, speed) {
  if (model === 'inverse') return p1 * speed + p2 > 0 ? 1 / (p1 * speed + p2) : NaN;
  const amplitude = Number.isFinite(p0) ? p0 : 1;
  return amplitude * Math.exp(-p1 * speed) + p2;
}

const fitKind = (model) => ['solid', 'dashed', 'dotted'][Math.max(FAMILIES.indexOf(model), 0)];

function fitLines(report, fits, frame) {
  const { low, high } = frame.range.x;
  const speeds = Array.from({ length: FIT.points + 1 }, (_, index) => low + ((high - low) * index) / FIT.points);
  const curves = fits.map((fit) => ({ fit, points: speeds.map((speed) => [speed, fitted(fit, speed / 3.6)]) }));
  const halos = curves.map(({ points }) => lineNode(points, frame, { colour: '--paper', width: 5 }));
  const look = ({ model }) => ({ colour: colourOf(report, model), kind: fitKind(model), width: 2.25 });
  return [...halos, ...curves.map(({ fit, points }) => lineNode(points, frame, look(fit)))];
}

const fitAxis = { x: 'km/h', y: 'm/s²' };

function fitFrame(width, speed, accel) {
  const y = { ...accel, unit: fitAxis.y };
  return chartFrame(width, Math.round(Math.max(260, width * 0.62)), { low: 0, high: speed || 1, unit: fitAxis.x }, y);
}

function fitPicture(report, frame, fits, nodes, what, describe) {
  const told = fits.map(({ model, residual }) => `${model}: residual sum of squares ${fixed(residual, 1)} (m/s²)²`);
  const label = `${what}, and fitted curves. ${told.join('; ') || 'No fits'}.`;
  const drawn = picture(frame, label, [...frame.axes, ...nodes, ...fitLines(report, fits, frame)]);
  return hoverable(frame, drawn, (speed, accel) => {
    const values = fits.map((fit) => `${fit.model} ${quantity(fitted(fit, speed / 3.6), 2, fitAxis.y)}`);
    return [quantity(speed, 1, 'km/h'), [...values, ...describe(speed, accel)]];
  });
}

function meansFigure(report, data, fits, width) {
  if (data.means.length === 0) return [note('This evaluation has no segment means (means).')];
  const frame = fitFrame(width, rangeOf(data.means.map(([v]) => v)).high, rangeOf([0, ...data.means.map(([, a]) => a)]));
  const places = data.means.map(([v, a]) => [frame.x(v), frame.y(a)]);
  const points = markerNode('circle', places, 2, '--measured');
  points.setAttribute('fill-opacity', 0.45);
  const what = `${plural(data.means.length, 'segment mean')} of ${data.label.toLowerCase()} over speed`;
  return [fitPicture(report, frame, fits, [points], what, () => []), el('figcaption', {}, `${what}.`)];
}

/** The range of acceleration that leaves out a thousandth of the samples at either end. */
function densityRange(cells, step) {
  const rows = [...cells].sort((a, b) => a[1] - b[1]);
  const total = rows.reduce((sum, [, , count]) => sum + count, 0);
  let [seen, low, high] = [0, rows[0][1], rows[rows.length - 1][1]];
  for (const [, j, count] of rows) {
    if (seen <= FIT.tail * total) low = j;
    if (seen <= (1 - FIT.tail) * total) high = j;
    seen += count;
  }
  return { low: Math.min(low * step, 0), high: Math.max((high + 1) * step, step) };
}

/** One path for each shade; the shades follow the logarithm of the count. */
function densityNodes(cells, [wide, tall], { x, y }, most) {
  const shade = (count) => Math.min(Math.floor((Math.log(count) / Math.log(most + 1)) * FIT.shades), FIT.shades - 1);
  const paths = new Array(FIT.shades).fill('');
  for (const [i, j, count] of cells) {
    const [left, right, top, bottom] = [x(i * wide), x((i + 1) * wide), y((j + 1) * tall), y(j * tall)];
    paths[Math.max(shade(count), 0)] += `M${left.toFixed(1)} ${top.toFixed(1)}H${right.toFixed(1)}V${bottom.toFixed(1)}H${left.toFixed(1)}z`;
  }
  const opacity = linear(0, FIT.shades - 1, FIT.least, FIT.most);
  return paths.flatMap((d, index) => (d === '' ? [] : [coloured(svg('path', { d, 'fill-opacity': opacity(index) }), 'fill', '--measured')]));
}

function densityFigure(report, { cells, step, label }, fits, width) {
  const [wide, tall] = step;
  if (cells.length === 0 || !(wide > 0 && tall > 0)) return [note('This evaluation has no density of the samples (density).')];
  const range = densityRange(cells, tall);
  const frame = fitFrame(width, cells.reduce((top, [i]) => Math.max(top, (i + 1) * wide), 0), range);
  const within = ([i, j]) => i >= 0 && (j + 0.5) * tall > range.low && (j + 0.5) * tall < range.high;
  const counted = (some) => some.reduce((sum, [, , count]) => sum + count, 0);
  const shown = cells.filter(within);
  const counts = new Map(shown.map(([i, j, count]) => [`${i} ${j}`, count]));
  const most = shown.reduce((top, [, , count]) => Math.max(top, count), 1);
  const [all, seen] = [counted(cells), counted(shown)];
  const what = `${plural(all, 'sample')} of ${label.toLowerCase()} over speed`;
  const beyond = all > seen ? ` ${plural(all - seen, 'sample')} beyond the axis.` : '';
  const size = `Cells of ${quantity(wide, 1, 'km/h')} by ${quantity(tall, 2, 'm/s²')}, the densest with ${plural(most, 'sample')}`;
  const describe = (speed, accel) => [plural(counts.get(`${Math.floor(speed / wide)} ${Math.floor(accel / tall)}`) ?? 0, 'sample')];
  const chart = fitPicture(report, frame, fits, densityNodes(shown, step, frame, most), what, describe);
  return [chart, el('figcaption', {}, `${what}. ${size}, shaded by the logarithm of the count.${beyond}`)];
}

/** Table 3.6: residual sums of squares. */
function residualTable({ fits, label }) {
  const models = [...new Set(fits.map(({ model }) => model))];
  const column = { better: 'low', digits: 2 };
  const rows = FITTED_TO.map(({ key, row }) => {
    const values = models.map((model) => fits.find((fit) => fit.model === model && fit.fittedTo === key)?.residual ?? NaN);
    const points = fits.find((fit) => fit.fittedTo === key)?.points ?? NaN;
    const best = bestCost(values, column);
    const cells = values.map((value) => valueCell(value, column, best));
    return el('tr', {}, el('th', { scope: 'row' }, row), el('td', {}, fixed(points, 0)), ...cells);
  });
  const named = models.map((model) => el('th', { scope: 'col' }, model, el('small', {}, '(m/s²)²')));
  const head = el('tr', {}, heading('Fitted to', 'text corner'), heading('Points'), ...named);
  return tableBox(`Residual sums of squares, ${label.toLowerCase()}`, [head], [el('tbody', {}, ...rows)]);
}

function fitParameters({ fits, label }) {
  const parameter = (index, unit) => ({ label: `p${index}`, unit, value: ({ p }) => p[index], digits: 5 });
  const columns = [
    { label: 'Model', value: ({ model }) => model },
    { label: 'Fitted to', value: ({ fittedTo }) => fittedTo },
    ...[parameter(0, 'm/s²'), parameter(1, 's³/m² or s/m'), parameter(2, 's²/m or m/s²')],
  ];
  const content = () => sortableTable(`Fitted parameters, ${label.toLowerCase()}`, columns, fits);
  return collapsible('Fitted parameters', plural(fits.length, 'fit'), content);
}

function fitLegend(report, fits) {
  const models = [...new Set(fits.map(({ model }) => model))];
  return legendOf(models.map((model) => [strokeSample(colourOf(report, model), fitKind(model)), model]));
}

function fitSection(report) {
  const sets = ['acceleration', 'braking']
    .filter((key) => Object.keys(object(report.fits[key])).length > 0)
    .map((key) => readFits(report.fits[key], key === 'braking' ? 'Braking' : 'Acceleration'));
  if (sets.length === 0) return absent('fits', 'This evaluation has no fits of functions (function_fits).');
  let shown = sets[0];
  const figures = FITTED_TO.map(({ key, title }) => ({ key, node: el('figure'), title }));
  const [legend, tables] = [el('div'), el('div', { class: 'below' })];
  const draw = () => {
    for (const { key, node, title } of figures) {
      const fits = shown.fits.filter(({ fittedTo }) => fittedTo === key);
      const drawn = (key === 'means' ? meansFigure : densityFigure)(report, shown, fits, chartWidth(node));
      node.replaceChildren(el('h3', {}, title), ...drawn);
    }
  };
  const show = (set) => {
    shown = set;
    legend.replaceChildren(fitLegend(report, set.fits));
    tables.replaceChildren(residualTable(set), fitParameters(set));
    draw();
  };
  const choice = sets.length > 1 ? [radios('Phases', 'fits-phases', sets, show)] : [];
  byId('fits-body').replaceChildren(...choice, legend, el('div', { class: 'pair' }, ...figures.map(({ node }) => node)), tables);
  show(sets[0]);
  return draw;
}
