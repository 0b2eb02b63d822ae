// ---------------------------------------------------------------- curve panels

const PLOT = { left: 36, right: 10, top: 24, bottom: 40 };
const REACH_PX = 24;
const SETTLE_MS = 120;

/** State shared by all panels: one view, so that models compare at the same place, and one highlighted phase. */
function newChart(report, body) {
  return { report, body, panels: [], full: null, view: null, highlighted: -1, palette: null, frame: 0, settling: 0 };
}

/** Time from 0 to the longest phase; speed up to the measured maximum, and a quarter more where a prediction goes beyond. */
function fullView(chart) {
  let [duration, measured, predicted] = [0, 0, 0];
  const largest = (curve, start) => curve.reduce((most, speed) => (speed > most ? speed : most), start);
  for (const phase of chart.report.phases) {
    if (phase.durationS > duration) duration = phase.durationS;
    measured = largest(phase.measured, measured);
    for (const panel of chart.panels) predicted = largest(predictedCurve(phase, panel.model.name), predicted);
  }
  const top = Math.max(measured, Math.min(predicted, 1.25 * measured));
  return { t0: 0, t1: duration || 1, v0: 0, v1: (top || 1) * 1.03 };
}

function clampView(view, full) {
  const axis = (low, high, least, most) => {
    const span = Math.min(Math.max(high - low, (most - least) / 500), most - least);
    const start = Math.min(Math.max(low, least), most - span);
    return [start, start + span];
  };
  const [t0, t1] = axis(view.t0, view.t1, full.t0, full.t1);
  const [v0, v1] = axis(view.v0, view.v1, full.v0, full.v1);
  return { t0, t1, v0, v1 };
}

/** Shows another view: at once by stretching the last picture, which follows a gesture whatever the data, then afresh. */
function setView(chart, view) {
  chart.view = clampView(view, chart.full);
  clearTimeout(chart.settling);
  chart.settling = setTimeout(() => chart.panels.forEach((panel) => drawPanel(panel, chart)), SETTLE_MS);
  if (chart.frame) return;
  chart.frame = requestAnimationFrame(() => {
    chart.frame = 0;
    chart.panels.forEach((panel) => showPanel(panel, chart));
  });
}

/** Zooms by `factor` about a point given as shares of the view, from the lower left. */
function zoom(chart, factor, shareT = 0.5, shareV = 0.5) {
  const { t0, t1, v0, v1 } = chart.view;
  const [t, v] = [t0 + shareT * (t1 - t0), v0 + shareV * (v1 - v0)];
  setView(chart, { t0: t - (t - t0) * factor, t1: t + (t1 - t) * factor, v0: v - (v - v0) * factor, v1: v + (v1 - v) * factor });
}

/** Moves the view by shares of its width and height. */
function pan(chart, shareT, shareV, from = chart.view) {
  const [dt, dv] = [shareT * (from.t1 - from.t0), shareV * (from.v1 - from.v0)];
  setView(chart, { t0: from.t0 + dt, t1: from.t1 + dt, v0: from.v0 + dv, v1: from.v1 + dv });
}

function panelScales(panel, view) {
  const [width, height] = [panel.base.clientWidth, panel.base.clientHeight];
  const box = { left: PLOT.left, right: width - PLOT.right, top: PLOT.top, bottom: height - PLOT.bottom };
  return {
    box,
    x: linear(view.t0, view.t1, box.left, box.right),
    y: linear(view.v0, view.v1, box.bottom, box.top),
    t: linear(box.left, box.right, view.t0, view.t1),
    v: linear(box.bottom, box.top, view.v0, view.v1),
  };
}

function drawAxes(context, view, { box, x, y }, palette) {
  context.font = `12px ${palette.font}`;
  context.fillStyle = palette.colour('--quiet');
  context.strokeStyle = palette.colour('--grid');
  context.lineWidth = 1;
  context.beginPath();
  context.textAlign = 'center';
  for (const { value, label } of ticks(view.t0, view.t1, Math.max(3, (box.right - box.left) / 50))) {
    context.moveTo(x(value), box.top);
    context.lineTo(x(value), box.bottom);
    context.fillText(label, x(value), box.bottom + 16);
  }
  context.textAlign = 'right';
  for (const { value, label } of ticks(view.v0, view.v1, Math.max(3, (box.bottom - box.top) / 45))) {
    context.moveTo(box.left, y(value));
    context.lineTo(box.right, y(value));
    context.fillText(label, box.left - 6, y(value) + 4);
  }
  context.stroke();
  context.fillText('s since the phase began', box.right, box.bottom + 34);
  context.textAlign = 'left';
  context.fillText('km/h', 0, 12);
}

/** Strokes a curve, leaving out points closer than a pixel and a half, and with gaps where it is NaN. */
function strokeCurve(context, { stepS }, curve, colour, dash, view, { box, x, y }) {
  const stride = Math.max(1, Math.floor(1.5 / Math.max(x(stepS) - x(0), 1e-9)));
  const first = Math.max(0, Math.floor(view.t0 / stepS) - stride);
  const last = Math.min(curve.length - 1, Math.ceil(view.t1 / stepS) + stride);
  context.strokeStyle = colour;
  context.setLineDash(dash);
  context.beginPath();
  let drawing = false;
  for (let index = first; index <= last; index = index < last ? Math.min(index + stride, last) : last + 1) {
    // Far outside the box the canvas would still dash every pixel of the line. It ignores a NaN.
    const height = Math.min(Math.max(y(curve[index]), box.top - 50), box.bottom + 50);
    if (drawing) context.lineTo(x(index * stepS), height);
    else context.moveTo(x(index * stepS), height);
    drawing = !Number.isNaN(height);
  }
  context.stroke();
}

/** Draws all curves of a panel into its hidden canvas. */
function drawCurves(panel, chart) {
  const { view, palette, report } = chart;
  const scales = panelScales(panel, view);
  const { context } = prepareCanvas(panel.curves, panel.base);
  context.save();
  clipTo(context, scales.box);
  context.lineJoin = 'round';
  context.lineWidth = 1;
  context.globalAlpha = Math.min(0.9, Math.max(0.2, 8 / Math.sqrt(report.phases.length)));
  const colour = palette.colour(panel.model.colour);
  report.phases.forEach((phase, index) => {
    strokeCurve(context, phase, phase.measured, palette.measured, [], view, scales);
    // Dashes that all began at the same time would make a pattern of their own.
    context.lineDashOffset = (index * 2.6) % 7;
    strokeCurve(context, phase, predictedCurve(phase, panel.model.name), colour, [4, 3], view, scales);
  });
  context.restore();
  panel.drawnView = view;
}

/** Shows the axes of the view and the curves as last drawn, moved and stretched to where they now belong. */
function showPanel(panel, chart) {
  if (panel.drawnView === null) return;
  const { context, ratio } = prepareCanvas(panel.base);
  const scales = panelScales(panel, chart.view);
  const { box, x, y } = scales;
  drawAxes(context, chart.view, scales, chart.palette);
  const drawn = panel.drawnView;
  context.save();
  clipTo(context, box);
  const source = [box.left, box.top, box.right - box.left, box.bottom - box.top].map((length) => length * ratio);
  const target = [x(drawn.t0), y(drawn.v1), x(drawn.t1) - x(drawn.t0), y(drawn.v0) - y(drawn.v1)];
  context.drawImage(panel.curves, ...source, ...target);
  context.restore();
  drawOverlay(panel, chart);
}

function drawPanel(panel, chart) {
  if (panel.base.clientWidth === 0) return;
  drawCurves(panel, chart);
  showPanel(panel, chart);
}

/** The highlighted phase in front of the dimmed others, and the region being selected. */
function drawOverlay(panel, chart) {
  const { context } = prepareCanvas(panel.overlay);
  const { view, palette } = chart;
  const scales = panelScales(panel, view);
  const { box } = scales;
  context.save();
  clipTo(context, box);
  const phase = chart.report.phases[chart.highlighted];
  if (phase) {
    context.globalAlpha = 0.7;
    context.fillStyle = palette.colour('--paper');
    context.fillRect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    context.globalAlpha = 1;
    context.lineWidth = 2.5;
    context.lineJoin = 'round';
    strokeCurve(context, phase, phase.measured, palette.measured, [], view, scales);
    const colour = palette.colour(panel.model.colour);
    strokeCurve(context, phase, predictedCurve(phase, panel.model.name), colour, [7, 4], view, scales);
  }
  if (panel.drag && !panel.drag.pans) {
    const region = dragRegion(panel.drag, box);
    context.fillStyle = palette.colour('--select');
    context.fillRect(region.left, region.top, region.right - region.left, region.bottom - region.top);
  }
  context.restore();
}

/** The selected region in pixels; a drag along one axis selects all of the other. */
function dragRegion({ fromX, fromY, x, y }, box) {
  const [wide, high] = [Math.abs(x - fromX) > 10, Math.abs(y - fromY) > 10];
  return {
    left: wide || !high ? Math.max(Math.min(fromX, x), box.left) : box.left,
    right: wide || !high ? Math.min(Math.max(fromX, x), box.right) : box.right,
    top: high ? Math.max(Math.min(fromY, y), box.top) : box.top,
    bottom: high ? Math.min(Math.max(fromY, y), box.bottom) : box.bottom,
  };
}

function squaredDistance(px, py, ax, ay, bx, by) {
  const [dx, dy] = [bx - ax, by - ay];
  const share = Math.min(1, Math.max(0, ((px - ax) * dx + (py - ay) * dy) / (dx * dx + dy * dy || 1)));
  return (px - ax - share * dx) ** 2 + (py - ay - share * dy) ** 2;
}

/** The index of the phase whose measured or predicted curve is nearest to a point, -1 if none is near. */
function nearestPhase(panel, chart, px, py) {
  const { x, y, t } = panelScales(panel, chart.view);
  let [nearest, least] = [-1, REACH_PX ** 2];
  const [from, to] = [t(px - REACH_PX), t(px + REACH_PX)];
  chart.report.phases.forEach((phase, index) => {
    const { stepS } = phase;
    const stride = Math.max(1, Math.floor(4 / Math.max(x(stepS) - x(0), 1e-9)));
    for (const curve of [phase.measured, predictedCurve(phase, panel.model.name)]) {
      const last = Math.min(curve.length - 1, Math.ceil(to / stepS));
      for (let a = Math.max(0, Math.floor(from / stepS)); a < last; a += stride) {
        const b = Math.min(a + stride, last);
        const distance = squaredDistance(px, py, x(a * stepS), y(curve[a]), x(b * stepS), y(curve[b]));
        if (distance < least) [nearest, least] = [index, distance];
      }
    }
  });
  return nearest;
}

function highlight(chart, index) {
  if (index === chart.highlighted) return;
  chart.highlighted = index;
  chart.panels.forEach((panel) => {
    drawOverlay(panel, chart);
    panel.tooltip.hidden = true;
  });
}

const scoreText = (scores) =>
  `RMSE ${quantity(kmh(scores.rmse_mps), 2, 'km/h')}, in band ${quantity(number(scores.in_band_pct), 1, '%')}`;

function tooltipLines(phase, name) {
  const scores = prediction(phase, name);
  return [
    `starts at ${clock(phase.startS)} min, lasts ${quantity(phase.durationS, 1, 's')}`,
    phase.group === '' ? 'no group' : `${phase.group} km/h`,
    scoreText(scores),
    `energy ${quantity(phase.energyKj, 1, 'kJ')}, predicted ${quantity(kilojoules(scores.energy_j), 1, 'kJ')}`,
  ];
}

function showTooltip(panel, chart, px, py) {
  const phase = chart.report.phases[chart.highlighted];
  panel.tooltip.hidden = phase === undefined;
  if (phase === undefined) return;
  const lines = tooltipLines(phase, panel.model.name).map((line) => el('span', {}, line));
  panel.tooltip.replaceChildren(el('b', {}, phase.trip || 'trip not named'), ...lines);
  const [width, height] = [panel.tooltip.offsetWidth, panel.tooltip.offsetHeight];
  const left = Math.max(0, Math.min(px - width / 2, panel.plot.clientWidth - width));
  const top = py < panel.plot.clientHeight / 2 ? py + 28 : py - 28 - height;
  Object.assign(panel.tooltip.style, { left: `${left}px`, top: `${top}px` });
}

function hover(panel, chart, px, py) {
  highlight(chart, nearestPhase(panel, chart, px, py));
  showTooltip(panel, chart, px, py);
}

function endDrag(panel, chart) {
  const { drag } = panel;
  panel.drag = null;
  if (!drag) return;
  const { box, t, v } = panelScales(panel, chart.view);
  const moved = Math.hypot(drag.x - drag.fromX, drag.y - drag.fromY) > 10;
  if (moved && !drag.pans) {
    const region = dragRegion(drag, box);
    setView(chart, { t0: t(region.left), t1: t(region.right), v0: v(region.bottom), v1: v(region.top) });
  } else if (!moved) {
    hover(panel, chart, drag.x, drag.y);
  }
}

function moveDrag(panel, chart, px, py) {
  const { drag } = panel;
  Object.assign(drag, { x: px, y: py });
  if (!drag.pans) return drawOverlay(panel, chart);
  const { box } = panelScales(panel, chart.view);
  return pan(chart, (drag.fromX - px) / (box.right - box.left), (py - drag.fromY) / (box.bottom - box.top), drag.view);
}

function listenToPointer(panel, chart) {
  const { plot } = panel;
  const position = (event) => {
    const frame = plot.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top];
  };
  plot.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    const [x, y] = position(event);
    plot.setPointerCapture(event.pointerId);
    panel.drag = { fromX: x, fromY: y, x, y, pans: event.shiftKey, view: { ...chart.view } };
    highlight(chart, -1);
  });
  plot.addEventListener('pointermove', (event) => {
    if (panel.drag) moveDrag(panel, chart, ...position(event));
    else if (event.pointerType !== 'touch') hover(panel, chart, ...position(event));
  });
  plot.addEventListener('pointerup', () => endDrag(panel, chart));
  plot.addEventListener('pointercancel', () => {
    panel.drag = null;
    drawOverlay(panel, chart);
  });
  plot.addEventListener('pointerleave', (event) => {
    if (event.pointerType !== 'touch') highlight(chart, -1);
  });
  plot.addEventListener('dblclick', () => setView(chart, chart.full));
  plot.addEventListener(
    'wheel',
    (event) => {
      // A bare wheel must go on scrolling the page.
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      const { box } = panelScales(panel, chart.view);
      const [x, y] = position(event);
      zoom(
        chart,
        Math.exp(event.deltaY / 300),
        (x - box.left) / (box.right - box.left),
        (box.bottom - y) / (box.bottom - box.top),
      );
    },
    { passive: false },
  );
}

function listenToKeys(panel, chart) {
  const count = chart.report.phases.length;
  const step = (by) => {
    const from = chart.highlighted < 0 && by < 0 ? 0 : chart.highlighted;
    highlight(chart, (from + by + count) % count);
    showTooltip(panel, chart, PLOT.left, PLOT.top);
  };
  const actions = {
    '+': () => zoom(chart, 0.7),
    '=': () => zoom(chart, 0.7),
    '-': () => zoom(chart, 1 / 0.7),
    0: () => setView(chart, chart.full),
    ArrowLeft: () => pan(chart, -0.15, 0),
    ArrowRight: () => pan(chart, 0.15, 0),
    ArrowUp: () => pan(chart, 0, 0.15),
    ArrowDown: () => pan(chart, 0, -0.15),
    n: () => step(1),
    p: () => step(-1),
    Escape: () => highlight(chart, -1),
  };
  panel.plot.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !Object.hasOwn(actions, event.key)) return;
    event.preventDefault();
    actions[event.key]();
  });
}

function newPanel(model, chart) {
  const figures = scoreText(model.summary);
  const picture = `Speed over time since the phase began: measured solid, predicted by ${model.name} dashed. ${figures}.`;
  const keys = `Curves of ${model.name}: plus and minus zoom, arrows move, 0 shows all, n and p step through the phases`;
  const base = el('canvas', { role: 'img', 'aria-label': picture });
  const overlay = el('canvas', { 'aria-hidden': 'true' });
  const tooltip = el('div', { class: 'tooltip', role: 'status', hidden: '' });
  const plot = el('div', { class: 'plot', tabindex: '0', role: 'group', 'aria-label': keys }, base, overlay, tooltip);
  const curves = document.createElement('canvas');
  const panel = { model, base, overlay, tooltip, plot, curves, drawnView: null, drag: null };
  const title = el('h3', {}, swatch(model.colour), model.name, el('small', {}, figures));
  const caption = `${plural(chart.report.phases.length, 'phase')}: measured solid, ${model.name} dashed.`;
  panel.node = el('figure', {}, title, plot, el('figcaption', {}, caption));
  listenToPointer(panel, chart);
  listenToKeys(panel, chart);
  return panel;
}

function zoomButtons(chart) {
  return toolbar('View of the curves', [
    ['+', 'Zoom in', () => zoom(chart, 0.7)],
    ['−', 'Zoom out', () => zoom(chart, 1 / 0.7)],
    ['←', 'Earlier', () => pan(chart, -0.25, 0)],
    ['→', 'Later', () => pan(chart, 0.25, 0)],
    ['↑', 'Faster', () => pan(chart, 0, 0.25)],
    ['↓', 'Slower', () => pan(chart, 0, -0.25)],
    ['Show all', 'Show all', () => setView(chart, chart.full)],
  ]);
}

/** Builds the panels of the chosen models; the view stays where it is when models come and go. */
function buildPanels(chart, shown) {
  const { report, body } = chart;
  if (report.phases.length === 0) return body.replaceChildren(note('The document has no phases.'));
  chart.highlighted = -1;
  chart.panels = report.models.filter((model) => shown.has(model.name)).map((model) => newPanel(model, chart));
  if (chart.panels.length === 0) return body.replaceChildren(note('No model is chosen.'));
  const untouched = chart.view === null || JSON.stringify(chart.view) === JSON.stringify(chart.full);
  chart.full = fullView(chart);
  chart.view = untouched ? { ...chart.full } : clampView(chart.view, chart.full);
  return body.replaceChildren(zoomButtons(chart), el('div', { class: 'panels' }, ...chart.panels.map((panel) => panel.node)));
}

function drawPanels(chart) {
  chart.palette = readPalette();
  chart.panels.forEach((panel) => drawPanel(panel, chart));
}
