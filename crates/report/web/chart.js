// ---------------------------------------------------------------- charts

const CHART = { left: 48, right: 14, top: 26, bottom: 42, least: 240 };
const DASHES = { solid: 'none', dashed: '6 4', dotted: '2 3' };

const chartWidth = (node, most = 900) => Math.min(Math.max(Math.floor(node.clientWidth), CHART.least), most);

/** Scales and axes of a picture; the axes `x` and `y` are given by `low`, `high` and the `unit` that stands beside them. */
function chartFrame(width, height, x, y, left = CHART.left) {
  const box = { left, right: width - CHART.right, top: CHART.top, bottom: height - CHART.bottom };
  const frame = {
    width,
    height,
    box,
    range: { x, y },
    x: linear(x.low, x.high, box.left, box.right),
    y: linear(y.low, y.high, box.bottom, box.top),
  };
  return { ...frame, axes: [...axisAlong(frame), ...axisUp(frame)] };
}

/** The line of a tick; the zero stands out where values lie on both sides of it. */
const gridLine = (value, { low, isLog }, x1, x2, y1, y2) =>
  svg('line', { class: value === 0 && low < 0 && !isLog ? 'zero' : 'grid', x1, x2, y1, y2 });

/** Where the label of a tick goes: in the middle under it, but never past the right edge. */
const labelPlace = (x, edge) => (x > edge - 30 ? { x: edge, 'text-anchor': 'end' } : { x, 'text-anchor': 'middle' });

/** The ticks of an axis: `marks` of its own, or those of a linear one. */
const marksOf = ({ low, high, marks }, count) => marks ?? ticks(low, high, count);

function axisAlong({ box, x, range }) {
  const marks = marksOf(range.x, Math.max(3, (box.right - box.left) / 60));
  const along = ({ value, label }) => [
    gridLine(value, range.x, x(value), x(value), box.top, box.bottom),
    svg('text', { ...labelPlace(x(value), box.right + CHART.right), y: box.bottom + 16 }, label),
  ];
  return [...marks.flatMap(along), svg('text', { x: box.right, y: box.bottom + 34, 'text-anchor': 'end' }, range.x.unit)];
}

function axisUp({ box, y, range }) {
  const marks = marksOf(range.y, Math.max(3, (box.bottom - box.top) / 38));
  const across = ({ value, label }) => [
    gridLine(value, range.y, box.left, box.right, y(value), y(value)),
    svg('text', { x: box.left - 6, y: y(value) + 4, 'text-anchor': 'end' }, label),
  ];
  return [...marks.flatMap(across), svg('text', { x: 0, y: 12 }, range.y.unit)];
}

function extent(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return { low, high };
}

/** From the least to the most of some values, with a share of that around them. */
function rangeOf(values, pad = 0.04) {
  const { low, high } = extent(values);
  if (!(high >= low)) return { low: 0, high: 1 };
  const margin = (high - low || 1) * pad;
  return { low: low - margin, high: high + margin };
}

function nearestIndex(places, wanted) {
  let nearest = 0;
  places.forEach((place, index) => {
    if (Math.abs(place - wanted) < Math.abs(places[nearest] - wanted)) nearest = index;
  });
  return nearest;
}

function picture({ width, height }, label, nodes) {
  return svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height, role: 'img', 'aria-label': label }, ...nodes);
}

function coloured(node, property, colour) {
  node.style[property] = `var(${colour})`;
  return node;
}

/** A line through points in the units of the axes, with gaps where one is not defined or beyond the axes. */
function lineNode(points, { x, y, range }, { colour, kind = 'solid', width = 1.75 }) {
  const slack = 1e-6 * (range.y.high - range.y.low);
  const inside = ([at, value]) => Number.isFinite(at) && value >= range.y.low - slack && value <= range.y.high + slack;
  let [d, drawing] = ['', false];
  for (const point of points) {
    if (inside(point)) d += `${drawing ? 'L' : 'M'}${x(point[0]).toFixed(1)} ${y(point[1]).toFixed(1)}`;
    drawing = inside(point);
  }
  const attributes = { d, fill: 'none', 'stroke-width': width, 'stroke-linejoin': 'round', 'stroke-dasharray': DASHES[kind] };
  return coloured(svg('path', attributes), 'stroke', colour);
}

/** At most two points a pixel: the least and the most of each stretch. Where nothing is known there is a gap. */
function thinned(places, values, width) {
  const stride = Math.max(1, Math.floor(values.length / Math.max(2 * width, 1)));
  const points = [];
  for (let start = 0; start < values.length; start += stride) {
    let [least, most] = [-1, -1];
    for (let i = start; i < Math.min(start + stride, values.length); i += 1) {
      if (Number.isNaN(values[i])) continue;
      if (least < 0 || values[i] < values[least]) least = i;
      if (most < 0 || values[i] > values[most]) most = i;
    }
    if (least < 0) points.push([NaN, NaN]);
    else for (const i of new Set(least < most ? [least, most] : [most, least])) points.push([places[i], values[i]]);
  }
  return points;
}

/** The area between two curves over the same places, cut off at the axes. */
function areaNode(places, lower, upper, { x, y, range }, colour, opacity) {
  const within = (value) => Math.min(Math.max(value, range.y.low), range.y.high);
  const known = places.map((_, index) => index).filter((index) => Number.isFinite(lower[index] + upper[index]));
  const corner = (values) => (index) => `${x(places[index]).toFixed(1)},${y(within(values[index])).toFixed(1)}`;
  const points = [...known.map(corner(upper)), ...known.reverse().map(corner(lower))].join(' ');
  return coloured(svg('polygon', { points, 'fill-opacity': opacity }), 'fill', colour);
}

const MARKERS = {
  circle: (x, y, r) => `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0z`,
  square: (x, y, r) => `M${x - r} ${y - r}h${2 * r}v${2 * r}h${-2 * r}z`,
  diamond: (x, y, r) => `M${x} ${y - 1.3 * r}l${1.3 * r} ${1.3 * r}l${-1.3 * r} ${1.3 * r}l${-1.3 * r} ${-1.3 * r}z`,
  up: (x, y, r) => `M${x} ${y - 1.2 * r}l${1.2 * r} ${2.2 * r}h${-2.4 * r}z`,
  down: (x, y, r) => `M${x} ${y + 1.2 * r}l${1.2 * r} ${-2.2 * r}h${-2.4 * r}z`,
  left: (x, y, r) => `M${x - 1.2 * r} ${y}l${2.2 * r} ${-1.2 * r}v${2.4 * r}z`,
  right: (x, y, r) => `M${x + 1.2 * r} ${y}l${-2.2 * r} ${-1.2 * r}v${2.4 * r}z`,
  cross: (x, y, r) => `M${x - r} ${y - r}l${2 * r} ${2 * r}M${x - r} ${y + r}l${2 * r} ${-2 * r}`,
};
const SHAPES = ['circle', 'square', 'up', 'diamond', 'down'];

/** Markers of one shape at places in pixels; a cross and a hollow one are strokes. */
function markerNode(shape, places, radius, colour, hollow = false) {
  const round = (value) => Math.round(value * 10) / 10;
  const d = places.map(([x, y]) => MARKERS[shape](round(x), round(y), radius)).join('');
  const stroked = hollow || shape === 'cross';
  const node = coloured(svg('path', { d, 'stroke-width': 1.5 }), stroked ? 'stroke' : 'fill', colour);
  node.style[stroked ? 'fill' : 'stroke'] = hollow ? 'var(--paper)' : 'none';
  return node;
}

/** The colour and the kind of a line for a legend. */
function strokeSample(colour, kind = 'solid') {
  const node = el('span', { class: `stroke ${kind}`, 'aria-hidden': 'true' });
  node.style.borderColor = `var(${colour})`;
  return node;
}

/** What the lines and areas of a picture are: pairs of a sample and its name. */
const legendOf = (entries) => el('p', { class: 'legend entries' }, ...entries.map(([sample, name]) => el('span', {}, sample, name)));
const lineEntries = (lines) => lines.map(({ name, colour, kind }) => [strokeSample(colour, kind), name]);
const lineLegend = (lines) => legendOf(lineEntries(lines));

/** A picture that tells the values under the pointer: `describe(x, y)`, in the units of the axes, gives a title and lines. */
function hoverable(frame, drawn, describe) {
  const tooltip = el('div', { class: 'tooltip', role: 'status', hidden: '' });
  const node = el('div', { class: 'chart' }, drawn, tooltip);
  const { box, range } = frame;
  const x = linear(box.left, box.right, range.x.low, range.x.high);
  const y = linear(box.bottom, box.top, range.y.low, range.y.high);
  const point = (event) => {
    const outline = drawn.getBoundingClientRect();
    const scale = frame.width / (outline.width || 1);
    const [px, py] = [(event.clientX - outline.left) * scale, (event.clientY - outline.top) * scale];
    const inside = px >= box.left && px <= box.right && py >= box.top && py <= box.bottom;
    const told = inside ? describe(x(px), y(py)) : null;
    tooltip.hidden = told === null;
    if (told === null) return;
    const [title, lines] = told;
    tooltip.replaceChildren(el('b', {}, title), ...lines.map((line) => el('span', {}, line)));
    const [at, width] = [px / scale, tooltip.offsetWidth];
    const left = at + 14 + width > node.clientWidth ? at - 14 - width : at + 14;
    Object.assign(tooltip.style, { left: `${Math.max(0, left)}px`, top: `${CHART.top}px` });
  };
  drawn.addEventListener('pointermove', point);
  drawn.addEventListener('pointerdown', point);
  drawn.addEventListener('pointerleave', () => {
    tooltip.hidden = true;
  });
  return node;
}

/** Some lines over places that they share or have of their own; the values beyond the axis lie at its edge. `under` and
 * `over` draw behind and in front, given the frame. */
function linePicture({ label, lines, x, y, told, under = () => [], over = () => [] }, width) {
  const frame = chartFrame(width, Math.max(220, Math.round(width * 0.3)), x, y);
  const inside = (value) => Math.min(Math.max(value, y.low), y.high);
  const nodes = lines.map((line) => {
    const points = thinned(line.places, line.values, frame.box.right - frame.box.left);
    return lineNode(points.map(([at, value]) => [at, inside(value)]), frame, line);
  });
  return hoverable(frame, picture(frame, label, [...frame.axes, ...under(frame), ...nodes, ...over(frame)]), told);
}

/** A section without data: one line, without the words that explain its figures. */
function absent(id, message) {
  byId(id).classList.add('absent');
  byId(`${id}-body`).replaceChildren(note(message));
  return () => {};
}
