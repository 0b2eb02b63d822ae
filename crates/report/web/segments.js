// ---------------------------------------------------------------- the comparison document

const SCHEMA = 'drivekit/segment-compare/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'logs', 'mean', 'figures'];
const METHODS = ['dynamic', 'bottom-up', 'swab', 'sliding-window', 'heuristic'];
const FIGURES = [
  { label: 'mean', unit: 'samples', value: (f) => number(f.mean_length), digits: 1 },
  { label: 'dev.', unit: 'samples', value: (f) => number(f.std_length), digits: 1 },
  { label: '+', unit: '%', value: (f) => number(f.positive_share_pct), digits: 1 },
  { label: '−', unit: '%', value: (f) => number(f.negative_share_pct), digits: 1 },
  { label: 'time', unit: 'ms', value: (f) => number(f.seconds) * 1000, digits: 2 },
];
const PHASES = ['acceleration', 'braking', 'cruise', 'other'];

function readComparison(source) {
  const doc = object(source);
  return {
    ...readFrame(doc, SCHEMA_KEYS),
    logs: list(doc.logs).map(object),
    mean: object(doc.mean),
    figures: readFigures(doc.figures),
  };
}

function readFigures(source) {
  const raw = object(source);
  const [t0, step] = [number(raw.t0_s), number(raw.step_s)];
  const span = list(raw.acceleration).map(number);
  return {
    log: text(raw.log),
    deadband: number(raw.accel_deadband_mps2),
    time: (index) => t0 + index * step,
    index: (time) => Math.round((time - t0) / step),
    speed: Float64Array.from(list(raw.speed_mps), kmh),
    accel: Float64Array.from(list(raw.accel_mps2), number),
    banded: Float64Array.from(list(raw.banded_mps2), number),
    acceleration: span.length === 2 ? span : null,
    panels: list(raw.panels).map(object).map((panel) => ({
      figure: text(panel.figure),
      title: text(panel.title),
      boundaries: list(panel.boundaries).map(number),
      phases: list(panel.phases).map(text),
    })),
  };
}

// ---------------------------------------------------------------- Table 3.5

function comparisonTable(report) {
  const first = [el('td'), ...METHODS.map((name) => el('th', { scope: 'colgroup', colspan: FIGURES.length }, name))];
  const second = METHODS.flatMap(() => FIGURES.map(({ label, unit }) => el('th', { scope: 'col' }, label, el('small', {}, unit))));
  const row = (name, methods) => {
    const cells = METHODS.flatMap((method) => {
      const figures = object(member(methods, method));
      return FIGURES.map(({ value, digits }) => el('td', {}, fixed(value(figures), digits)));
    });
    return el('tr', {}, el('th', { scope: 'row' }, name), ...cells);
  };
  const rows = report.logs.map((log) => row(text(log.name), log.methods));
  const bodies = [el('tbody', {}, ...rows)];
  if (rows.length > 1) bodies.push(el('tbody', { class: 'baselines' }, row('mean', report.mean)));
  const head = [el('tr', {}, ...first), el('tr', {}, heading('Log', 'text corner'), ...second)];
  return tableBox('Table 3.5', head, bodies, rows.length > TALL_ROWS);
}

// ---------------------------------------------------------------- figures

const BOX = { left: 44, right: 10, top: 8, bottom: 34, height: 190 };

/** Vertices of a polyline through the samples `from..to`, at most two a pixel: the least and the most of each stretch. */
function polyline(values, from, to, x, y, figures) {
  const stride = Math.max(1, Math.floor((to - from) / Math.max(2 * (x(figures.time(to)) - x(figures.time(from))), 1)));
  const points = [];
  for (let start = from; start < to; start += stride) {
    const end = Math.min(start + stride, to);
    let [least, most] = [start, start];
    for (let i = start; i < end; i += 1) {
      if (values[i] < values[least]) least = i;
      if (values[i] > values[most]) most = i;
    }
    for (const i of least < most ? [least, most] : [most, least]) {
      points.push(`${x(figures.time(i)).toFixed(1)},${y(values[i]).toFixed(1)}`);
      if (least === most) break;
    }
  }
  if (to < values.length) points.push(`${x(figures.time(to)).toFixed(1)},${y(values[to]).toFixed(1)}`);
  return points.join(' ');
}

function extent(values, from, to) {
  let [low, high] = [0, 0];
  for (let i = Math.max(from, 0); i < Math.min(to, values.length); i += 1) {
    if (values[i] < low) low = values[i];
    if (values[i] > high) high = values[i];
  }
  return [low, high > low ? high * 1.05 : low + 1];
}

function axes(scales, width, view, [low, high], unit) {
  const { x, y } = scales;
  const nodes = [];
  const [left, right, bottom] = [BOX.left, width - BOX.right, BOX.height - BOX.bottom];
  for (const { value, label } of ticks(view.from, view.to, (right - left) / 70)) {
    nodes.push(svg('text', { x: x(value), y: bottom + 16, 'text-anchor': 'middle' }, label));
    nodes.push(svg('line', { class: 'axis', x1: x(value), x2: x(value), y1: bottom, y2: bottom + 4 }));
  }
  for (const { value, label } of ticks(low, high, 4)) {
    nodes.push(svg('line', { class: 'grid', x1: left, x2: right, y1: y(value), y2: y(value) }));
    nodes.push(svg('text', { x: left - 6, y: y(value) + 4, 'text-anchor': 'end' }, label));
  }
  nodes.push(svg('text', { x: right, y: bottom + 31, 'text-anchor': 'end' }, 's'));
  nodes.push(svg('text', { x: 0, y: bottom + 31 }, unit));
  return nodes;
}

/** The segments that can be seen, as `[start, end, phase, number]`. */
function segmentsIn(panel, from, to) {
  const found = [];
  for (let i = 0; i + 1 < panel.boundaries.length; i += 1) {
    const [start, end] = [panel.boundaries[i], panel.boundaries[i + 1]];
    if (end > from && start < to) found.push({ start, end, phase: panel.phases[i] ?? '', order: i });
  }
  return found;
}

const phaseColour = (phase) => (PHASES.includes(phase) ? `var(--${phase})` : 'var(--measured)');

function drawFigure(spec, chart) {
  const { figures } = chart;
  const width = spec.plot.clientWidth;
  if (width === 0) return;
  const view = spec.view ?? chart.view;
  const [from, to] = [Math.max(figures.index(view.from), 0), Math.min(figures.index(view.to) + 1, spec.values.length)];
  const range = extent(spec.values, from, to);
  const scales = {
    x: linear(view.from, view.to, BOX.left, width - BOX.right),
    y: linear(range[0], range[1], BOX.height - BOX.bottom, BOX.top),
  };
  const picture = svg('svg', { width, height: BOX.height, viewBox: `0 0 ${width} ${BOX.height}`, role: 'img', 'aria-label': spec.label });
  picture.append(...axes(scales, width, view, range, spec.unit));
  const line = (start, end, colour) =>
    picture.append(
      svg('polyline', {
        points: polyline(spec.values, Math.max(start, from), Math.min(end, to), scales.x, scales.y, figures),
        fill: 'none',
        'stroke-width': 1.75,
        'stroke-linejoin': 'round',
        style: `stroke: ${colour}`,
      }),
    );
  if (spec.panel) {
    const segments = segmentsIn(spec.panel, from, to);
    for (const { start } of segments.filter((segment) => segment.start > from)) {
      const at = scales.x(figures.time(start));
      picture.append(svg('line', { class: 'cut', x1: at, x2: at, y1: BOX.top, y2: BOX.height - BOX.bottom }));
    }
    segments.forEach(({ start, end, phase, order }) => {
      const alternating = order % 2 === 0 ? 'var(--measured)' : 'var(--accent)';
      line(start, end, spec.byPhase ? phaseColour(phase) : alternating);
    });
  } else {
    line(from, to, 'var(--measured)');
  }
  spec.plot.replaceChildren(picture, spec.selection, spec.tooltip);
}

function tooltipText(spec, figures, index) {
  const time = quantity(figures.time(index), 1, 's');
  const value = `${quantity(spec.values[index], spec.digits, spec.unit)}`;
  const segment = spec.panel && segmentsIn(spec.panel, index, index + 1)[0];
  if (!segment) return [`${time}: ${value}`];
  const length = segment.end - segment.start;
  const span = `${fixed(figures.time(segment.start), 1)} to ${quantity(figures.time(segment.end), 1, 's')}`;
  return [`${time}: ${value}`, `segment ${segment.order + 1}, ${segment.phase}`, `${span}, ${plural(length, 'sample')}`];
}

/** Drag selects a stretch of time in all figures, a double click shows all again, hovering tells the segment. */
function listen(spec, chart) {
  const { plot, tooltip, selection } = spec;
  const at = (event) => event.clientX - plot.getBoundingClientRect().left;
  const timeAt = (px) => {
    const view = spec.view ?? chart.view;
    return linear(BOX.left, plot.clientWidth - BOX.right, view.from, view.to)(px);
  };
  let dragged = null;
  plot.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || spec.view) return;
    plot.setPointerCapture(event.pointerId);
    dragged = at(event);
  });
  plot.addEventListener('pointermove', (event) => {
    const px = at(event);
    if (dragged !== null) {
      Object.assign(selection.style, { left: `${Math.min(px, dragged)}px`, width: `${Math.abs(px - dragged)}px` });
      selection.hidden = false;
    }
    const index = chart.figures.index(timeAt(px));
    tooltip.hidden = !(index >= 0 && index < spec.values.length);
    if (tooltip.hidden) return;
    tooltip.replaceChildren(...tooltipText(spec, chart.figures, index).map((row) => el('span', {}, row)));
    tooltip.style.left = `${Math.max(0, Math.min(px + 14, plot.clientWidth - tooltip.offsetWidth))}px`;
    tooltip.style.top = '0.5rem';
  });
  plot.addEventListener('pointerup', (event) => {
    const [from, to] = [dragged, at(event)].map((px) => (px === null ? NaN : timeAt(px))).sort((a, b) => a - b);
    const wide = dragged !== null && Math.abs(at(event) - dragged) > 6;
    dragged = null;
    selection.hidden = true;
    if (wide) show(chart, { from: Math.max(from, chart.all.from), to: Math.min(to, chart.all.to) });
  });
  plot.addEventListener('pointercancel', () => {
    dragged = null;
    selection.hidden = true;
  });
  plot.addEventListener('pointerleave', () => {
    tooltip.hidden = true;
  });
  plot.addEventListener('dblclick', () => show(chart, chart.all));
}

function show(chart, view) {
  if (view.to - view.from < 0.5) return;
  chart.view = view;
  chart.specs.forEach((spec) => drawFigure(spec, chart));
}

function newFigure(chart, title, caption, more) {
  const plot = el('div', { class: 'plot figure' });
  const selection = el('div', { class: 'selection', hidden: '' });
  const tooltip = el('div', { class: 'tooltip', hidden: '' });
  const spec = { plot, selection, tooltip, label: `${title}. ${caption}`, unit: 'km/h', digits: 1, values: chart.figures.speed, ...more };
  listen(spec, chart);
  chart.specs.push(spec);
  return el('figure', {}, el('h3', {}, title), plot, el('figcaption', {}, caption));
}

function summary(panel) {
  const segments = panel.boundaries.length - 1;
  const samples = panel.boundaries[segments] ?? NaN;
  return `${plural(segments, 'segment')}, ${fixed(samples / segments, 1)} samples on average.`;
}

function buildFigures(chart) {
  const { figures } = chart;
  const nodes = [];
  const of = (panel) => newFigure(chart, `Figure ${panel.figure}: ${panel.title}`, summary(panel), { panel, byPhase: panel.figure === '3.3' });
  const early = figures.panels.filter((panel) => panel.figure === '3.3');
  nodes.push(...early.map(of));
  const accel = { unit: 'm/s²', digits: 2 };
  nodes.push(
    newFigure(chart, 'Figure 3.4: speed', 'Smoothed, as all methods get it.', {}),
    newFigure(chart, 'Figure 3.4: acceleration', 'Forward difference of the speed.', { ...accel, values: figures.accel }),
    newFigure(chart, 'Figure 3.4: acceleration with a dead band', `0 where its amount is under ${quantity(figures.deadband, 2, 'm/s²')}.`, {
      ...accel,
      values: figures.banded,
    }),
  );
  const late = figures.panels.filter((panel) => panel.figure === '3.10');
  nodes.push(...figures.panels.filter((panel) => !early.includes(panel) && !late.includes(panel)).map(of));
  if (figures.acceleration && late.length > 0) nodes.push(dividedAcceleration(chart, late[0]));
  nodes.push(...late.map(of));
  return nodes;
}

/** Figure 3.9: the one acceleration that unmerged SWAB cuts into most segments. */
function dividedAcceleration(chart, panel) {
  const { figures } = chart;
  const [start, end] = figures.acceleration;
  const margin = Math.max(10, (end - start) * 0.2);
  const view = { from: figures.time(start - margin), to: figures.time(end + margin) };
  const count = segmentsIn(panel, start, end).length;
  const caption = `From ${fixed(figures.time(start), 1)} to ${quantity(figures.time(end), 1, 's')}: ${plural(count, 'segment')}.`;
  return newFigure(chart, 'Figure 3.9: one acceleration in several segments', caption, { panel, view });
}

// ---------------------------------------------------------------- main

function introduce(report) {
  byId('version').append(report.version);
  const methods = METHODS.filter((name) => member(report.mean, name));
  byId('headline').append(
    `${plural(methods.length, 'method')} on ${plural(report.logs.length, 'log')}, before merging; the figures show ${report.figures.log || 'no log'}.`,
  );
  const of = (name) => object(member(report.mean, name));
  byId('facts').append(
    ...methods.map((name) => fact(`${name}, mean length`, fixed(number(of(name).mean_length), 1), 'samples')),
  );
  byId('figures-remark').append(
    'Speed over time with the boundaries of the segments; neighbouring segments in turns in two colours, figure 3.3 by phase. Drag over a stretch of time to see it in all figures, double-click to see all again.',
  );
  byId('legend').append(...PHASES.flatMap((phase) => [swatch(`--${phase}`), `${phase}  `]));
}

function main() {
  const report = readComparison(parseDocument());
  introduce(report);
  problems(report, SCHEMA);
  byId('table-body').append(report.logs.length > 0 ? comparisonTable(report) : note('The document has no logs.'));
  const { figures } = report;
  const all = { from: figures.time(0), to: figures.time(Math.max(figures.speed.length - 1, 1)) };
  const chart = { figures, all, view: all, specs: [] };
  if (figures.speed.length > 1) byId('figures-body').append(...buildFigures(chart));
  else byId('figures-body').append(note('The document has no figures.'));
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  keepDrawn(() => chart.specs.forEach((spec) => drawFigure(spec, chart)));
}

main();
