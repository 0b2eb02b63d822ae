// ---------------------------------------------------------------- power over time

const POWER = { left: 44, right: 10, top: 22, between: 34, bottom: 40, share: 0.68 };

/** The state of the figure: the trip it shows, the stretch of time, and the sample under the pointer. */
function newPowerChart() {
  const canvas = el('canvas', { role: 'img' });
  const overlay = el('canvas', { 'aria-hidden': 'true' });
  const tooltip = el('div', { class: 'tooltip', role: 'status', hidden: '' });
  const label = 'Power and speed over time: plus and minus zoom, the left and right arrows move, 0 shows all';
  const plot = el('div', { class: 'plot', tabindex: '0', role: 'group', 'aria-label': label }, canvas, overlay, tooltip);
  const chart = { entry: null, all: null, view: null, canvas, overlay, tooltip, plot, dragged: null, index: -1 };
  listenToPowerPointer(chart);
  listenToPowerKeys(chart);
  return chart;
}

function showTrip(chart, entry) {
  const { timeS } = entry.curve;
  chart.entry = entry;
  chart.all = { from: timeS[0], to: timeS[timeS.length - 1] };
  chart.view = chart.all;
  chart.index = -1;
  chart.canvas.setAttribute('aria-label', `Modelled and measured power, and speed, over time: ${entryName(entry)}`);
}

/** Shows a stretch of time, at least two seconds of it, moved and cut such that it lies within the trip. */
function viewTime(chart, from, to) {
  const { all } = chart;
  const span = Math.min(Math.max(to - from, 2), all.to - all.from);
  const start = Math.min(Math.max(from, all.from), all.to - span);
  chart.view = { from: start, to: start + span };
  pointAt(chart, null);
  drawPowerChart(chart);
}

function zoomTime(chart, factor) {
  const { from, to } = chart.view;
  const [middle, half] = [(from + to) / 2, ((to - from) / 2) * factor];
  viewTime(chart, middle - half, middle + half);
}

function moveTime(chart, share) {
  const { from, to } = chart.view;
  viewTime(chart, from + share * (to - from), to + share * (to - from));
}

const showAll = (chart) => viewTime(chart, chart.all.from, chart.all.to);

// ---------------------------------------------------------------- drawing

/** Indices from the sample before the view to the one after it. */
function shownRange({ entry, view }) {
  const { timeS } = entry.curve;
  return [Math.max(indexAt(timeS, view.from) - 1, 0), Math.min(indexAt(timeS, view.to) + 1, timeS.length)];
}

function rangeOf(series, [first, last]) {
  let [low, high] = [0, 0];
  for (const values of series) {
    for (let index = first; index < last; index += 1) {
      if (values[index] < low) low = values[index];
      if (values[index] > high) high = values[index];
    }
  }
  const margin = (high - low || 1) * 0.05;
  return [low < 0 ? low - margin : 0, high + margin];
}

function powerScales(chart) {
  const { entry, view, canvas } = chart;
  const { speed, modelled, measured } = entry.curve;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [left, right] = [POWER.left, width - POWER.right];
  const room = height - POWER.top - POWER.between - POWER.bottom;
  const power = { left, right, top: POWER.top, bottom: POWER.top + room * POWER.share };
  const below = { left, right, top: power.bottom + POWER.between, bottom: height - POWER.bottom };
  const shown = shownRange(chart);
  const ranges = { power: rangeOf(measured ? [modelled, measured] : [modelled], shown), speed: rangeOf([speed], shown) };
  return {
    shown,
    ranges,
    boxes: { power, speed: below },
    x: linear(view.from, view.to, left, right),
    time: linear(left, right, view.from, view.to),
    power: linear(...ranges.power, power.bottom, power.top),
    speed: linear(...ranges.speed, below.bottom, below.top),
  };
}

function drawValueAxis(context, palette, box, y, range, unit) {
  context.textAlign = 'right';
  for (const { value, label } of ticks(...range, Math.max(2, (box.bottom - box.top) / 45))) {
    context.strokeStyle = palette.colour(value === 0 ? '--quiet' : '--grid');
    context.beginPath();
    context.moveTo(box.left, y(value));
    context.lineTo(box.right, y(value));
    context.stroke();
    context.fillText(label, box.left - 6, y(value) + 4);
  }
  context.textAlign = 'left';
  context.fillText(unit, 0, box.top - 10);
}

/** Ticks in seconds, or in minutes where the view is long. */
function drawTimeAxis(context, palette, scales, view) {
  const { boxes, x } = scales;
  const [unit, unitS] = view.to - view.from > 300 ? ['min', 60] : ['s', 1];
  context.textAlign = 'center';
  context.strokeStyle = palette.colour('--grid');
  context.beginPath();
  const count = Math.max(3, (boxes.speed.right - boxes.speed.left) / 60);
  for (const { value, label } of ticks(view.from / unitS, view.to / unitS, count)) {
    for (const box of Object.values(boxes)) {
      context.moveTo(x(value * unitS), box.top);
      context.lineTo(x(value * unitS), box.bottom);
    }
    context.fillText(label, x(value * unitS), boxes.speed.bottom + 16);
  }
  context.stroke();
  context.textAlign = 'right';
  context.fillText(unit, boxes.speed.right, boxes.speed.bottom + 34);
}

/** Strokes values over time: where several samples share a pixel, the least and the most; a gap in time or values stays one. */
function strokeOverTime(context, times, values, [first, last], x, y) {
  const stride = Math.max(1, Math.floor((last - first) / Math.max(2 * (x(times[last - 1]) - x(times[first])), 1)));
  const longest = (2.5 * (times[times.length - 1] - times[0])) / Math.max(times.length - 1, 1);
  let before = -1;
  const point = (index) => {
    if (Number.isNaN(values[index])) before = -1;
    else {
      const connected = before >= 0 && times[index] - times[before] <= longest * stride;
      context[connected ? 'lineTo' : 'moveTo'](x(times[index]), y(values[index]));
      before = index;
    }
  };
  context.beginPath();
  for (let start = first; start < last; start += stride) {
    let [least, most] = [start, start];
    for (let index = start; index < Math.min(start + stride, last); index += 1) {
      if (values[index] < values[least] || Number.isNaN(values[least])) least = index;
      if (values[index] > values[most] || Number.isNaN(values[most])) most = index;
    }
    point(Math.min(least, most));
    if (least !== most) point(Math.max(least, most));
  }
  context.stroke();
}

function drawPowerChart(chart) {
  if (chart.entry === null || chart.canvas.clientWidth === 0) return;
  const palette = readPalette();
  const { context } = prepareCanvas(chart.canvas);
  const scales = powerScales(chart);
  const { boxes, ranges, shown, x } = scales;
  const { timeS, speed, modelled, measured } = chart.entry.curve;
  context.font = `12px ${palette.font}`;
  context.fillStyle = palette.colour('--quiet');
  context.lineWidth = 1;
  drawTimeAxis(context, palette, scales, chart.view);
  drawValueAxis(context, palette, boxes.power, scales.power, ranges.power, 'kW');
  drawValueAxis(context, palette, boxes.speed, scales.speed, ranges.speed, 'km/h');
  const stroke = (box, values, y, colour, width) => {
    context.save();
    clipTo(context, box);
    context.lineJoin = 'round';
    context.lineWidth = width;
    context.strokeStyle = palette.colour(colour);
    strokeOverTime(context, timeS, values, shown, x, y);
    context.restore();
  };
  if (measured) stroke(boxes.power, measured, scales.power, '--measured', 1.25);
  stroke(boxes.power, modelled, scales.power, '--series-1', 1.5);
  stroke(boxes.speed, speed, scales.speed, '--series-0', 1.5);
  drawPowerOverlay(chart, scales);
}

/** The sample under the pointer, and the stretch being selected. */
function drawPowerOverlay(chart, scales = powerScales(chart)) {
  const palette = readPalette();
  const { context } = prepareCanvas(chart.overlay);
  const { boxes, x } = scales;
  const [top, bottom] = [boxes.power.top, boxes.speed.bottom];
  if (chart.dragged !== null) {
    context.fillStyle = palette.colour('--select');
    context.fillRect(chart.dragged.from, top, chart.dragged.to - chart.dragged.from, bottom - top);
  }
  if (chart.index < 0) return;
  const { timeS, speed, modelled, measured } = chart.entry.curve;
  const at = x(timeS[chart.index]);
  context.strokeStyle = palette.colour('--quiet');
  context.beginPath();
  context.moveTo(at, top);
  context.lineTo(at, bottom);
  context.stroke();
  const dot = (values, y, colour) => {
    if (values === null || Number.isNaN(values[chart.index])) return;
    context.fillStyle = palette.colour(colour);
    context.beginPath();
    context.arc(at, y(values[chart.index]), 3.5, 0, 2 * Math.PI);
    context.fill();
  };
  dot(measured, scales.power, '--measured');
  dot(modelled, scales.power, '--series-1');
  dot(speed, scales.speed, '--series-0');
}

// ---------------------------------------------------------------- pointer and keys

function pointedLines({ timeS, speed, modelled, measured }, index) {
  const lines = [`modelled ${quantity(modelled[index], 2, 'kW')}`];
  if (measured) {
    const difference = modelled[index] - measured[index];
    lines.push(`measured ${quantity(measured[index], 2, 'kW')}`, `difference ${signed(difference, 2)}\u00a0kW`);
  }
  return [quantity(timeS[index], 1, 's'), [...lines, `speed ${quantity(speed[index], 1, 'km/h')}`]];
}

/** Points to the sample nearest to a place in the figure; `null` points to none. */
function pointAt(chart, px) {
  const { tooltip, plot, entry } = chart;
  const scales = powerScales(chart);
  const { timeS } = entry.curve;
  const inside = px !== null && px >= POWER.left && px <= plot.clientWidth - POWER.right;
  const after = inside ? Math.min(indexAt(timeS, scales.time(px)), timeS.length - 1) : -1;
  const before = Math.max(after - 1, 0);
  chart.index = inside && scales.time(px) - timeS[before] < timeS[after] - scales.time(px) ? before : after;
  tooltip.hidden = chart.index < 0;
  drawPowerOverlay(chart, scales);
  if (tooltip.hidden) return;
  const [title, lines] = pointedLines(entry.curve, chart.index);
  tooltip.replaceChildren(el('b', {}, title), ...lines.map((line) => el('span', {}, line)));
  const width = tooltip.offsetWidth;
  const left = px + 14 + width > plot.clientWidth ? px - 14 - width : px + 14;
  Object.assign(tooltip.style, { left: `${Math.max(0, left)}px`, top: `${POWER.top}px` });
}

function listenToPowerPointer(chart) {
  const { plot } = chart;
  let start = null;
  const place = (event) => event.clientX - plot.getBoundingClientRect().left;
  const region = (px) => {
    const [from, to] = [start, px].sort((a, b) => a - b);
    return { from: Math.max(from, POWER.left), to: Math.min(to, plot.clientWidth - POWER.right) };
  };
  const drop = () => {
    start = null;
    chart.dragged = null;
    pointAt(chart, null);
  };
  plot.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    plot.setPointerCapture(event.pointerId);
    start = place(event);
  });
  plot.addEventListener('pointermove', (event) => {
    const px = place(event);
    if (start !== null && Math.abs(px - start) > 6) chart.dragged = region(px);
    pointAt(chart, px);
  });
  plot.addEventListener('pointerup', (event) => {
    const { dragged } = chart;
    drop();
    if (dragged === null) pointAt(chart, place(event));
    else viewTime(chart, ...[dragged.from, dragged.to].map(powerScales(chart).time));
  });
  plot.addEventListener('pointercancel', drop);
  plot.addEventListener('pointerleave', (event) => {
    if (start === null && event.pointerType !== 'touch') pointAt(chart, null);
  });
  plot.addEventListener('dblclick', () => showAll(chart));
}

function listenToPowerKeys(chart) {
  const actions = {
    '+': () => zoomTime(chart, 0.6),
    '=': () => zoomTime(chart, 0.6),
    '-': () => zoomTime(chart, 1 / 0.6),
    0: () => showAll(chart),
    ArrowLeft: () => moveTime(chart, -0.2),
    ArrowRight: () => moveTime(chart, 0.2),
    Escape: () => pointAt(chart, null),
  };
  chart.plot.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !Object.hasOwn(actions, event.key)) return;
    event.preventDefault();
    actions[event.key]();
  });
}

// ---------------------------------------------------------------- section

const curveLegend = (measured) =>
  el(
    'p',
    { class: 'legend' },
    ...(measured ? [swatch('--measured'), 'measured'] : []),
    ...[swatch('--series-1'), 'modelled', swatch('--series-0'), 'speed'],
  );

function powerCaption(entry) {
  const { measured } = entry.curve;
  const error = `Energy error ${signed(entry.errorPct, 1)}\u00a0%, power RMSE ${quantity(kilowatts(entry.rmseW), 2, 'kW')}.`;
  return `${entryName(entry)}. ${measured ? error : 'The trip has no measured power.'}`;
}

/** Builds the section; gives what draws it anew. */
function powerSection(report) {
  const trips = report.logs.filter((log) => log.curve.timeS.length > 1 && log.curve.timeS.every(Number.isFinite));
  if (trips.length === 0) {
    byId('power-body').append(note('The document has no curves of power.'));
    return () => {};
  }
  const chart = newPowerChart();
  const [legend, caption] = [el('div'), el('figcaption')];
  const pick = ({ entry }) => {
    showTrip(chart, entry);
    legend.replaceChildren(curveLegend(entry.curve.measured));
    caption.replaceChildren(powerCaption(entry));
    pointAt(chart, null);
    drawPowerChart(chart);
  };
  const buttons = toolbar('View of the power', [
    ['+', 'Zoom in', () => zoomTime(chart, 0.6)],
    ['−', 'Zoom out', () => zoomTime(chart, 1 / 0.6)],
    ['←', 'Earlier', () => moveTime(chart, -0.25)],
    ['→', 'Later', () => moveTime(chart, 0.25)],
    ['Show all', 'Show all', () => showAll(chart)],
  ]);
  const groups = entryGroups([], trips, severalVehicles(report));
  byId('power-controls').append(picklist('Trip', groups, pick));
  byId('power-body').append(buttons, legend, el('figure', {}, chart.plot, caption));
  pick({ entry: trips[0] });
  return () => drawPowerChart(chart);
}
