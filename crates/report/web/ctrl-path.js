// ---------------------------------------------------------------- ways driven

const WAY = { most: 900, closedMost: 640, leastHeight: 200, tallest: 760, apartPx: 0.6, reachPx: 12, pad: 0.04 };

const withPad = ({ low, high }, pad) => ({ low: low - pad, high: high + pad });

/** Axes of one scale where the lane is not so long that nothing could be seen of its width. */
function wayFrame(scene, width) {
  const pad = WAY.pad * Math.max(scene.all.width, scene.all.height);
  const [x, y] = [withPad(scene.all.x, scene.follows ? 0 : pad), withPad(scene.all.y, scene.follows ? scene.all.height * WAY.pad : pad)];
  const room = width - CHART.left - CHART.right;
  const natural = (room * (y.high - y.low)) / (x.high - x.low || 1);
  const height = Math.min(Math.max(natural, WAY.leastHeight), WAY.tallest);
  const frame = chartFrame(width, height + CHART.top + CHART.bottom, { ...x, unit: 'x, m' }, { ...y, unit: 'y, m' });
  return { ...frame, stretch: height / (natural || 1) };
}

const tracedPath = (points, { x, y }) =>
  points.map(([px, py], index) => `${index === 0 ? 'M' : 'L'}${x(px).toFixed(1)} ${y(py).toFixed(1)}`).join('');

function laneNodes({ left, right, centre, closed }, frame) {
  const end = closed ? 'Z' : '';
  const [leftD, rightD, centreD] = [left, right, centre].map((points) => tracedPath(points, frame) + (points.length > 0 ? end : ''));
  const band = closed ? leftD + rightD : tracedPath([...left, ...right.toReversed()], frame);
  const line = (d, dash) => {
    const attributes = { d, fill: 'none', 'stroke-width': 1, 'stroke-dasharray': DASHES[dash] };
    return coloured(svg('path', attributes), 'stroke', '--other');
  };
  const shade = coloured(svg('path', { d: band, 'fill-rule': 'evenodd' }), 'fill', '--raised');
  return [shade, line(leftD, 'solid'), line(rightD, 'solid'), line(centreD, 'dashed')];
}

/** The way between two samples, without points that could not be told apart. */
function wayPoints({ x, y }, frame, from, to) {
  const points = [];
  let [lastX, lastY] = [NaN, NaN];
  for (let index = from; index < to; index += 1) {
    const [px, py] = [frame.x(x[index]), frame.y(y[index])];
    if (Math.hypot(px - lastX, py - lastY) < WAY.apartPx && index < to - 1) continue;
    [lastX, lastY] = [px, py];
    points.push([x[index], y[index]]);
  }
  return points;
}

const trackerSpans = ({ events }, robot) => events.filter((event) => event.robot === robot && event.kind.startsWith('tracker'));

/** The way of a robot, wider and in another colour where its tracker is off or fades. */
function wayNodes(report, robot, frame) {
  const { time } = report;
  const end = time.length;
  const spans = trackerSpans(report, robot.index).map((event) => {
    const points = wayPoints(robot, frame, indexAt(time, event.from), indexAt(time, event.to) + 1);
    const node = lineNode(points, frame, { colour: eventLook(event).colour, width: 6 });
    node.style.strokeOpacity = 0.5;
    return node;
  });
  const ends = [...robot.x.keys()].filter((index) => Number.isFinite(robot.x[index] + robot.y[index]));
  const place = (index) => [[frame.x(robot.x[index]), frame.y(robot.y[index])]];
  const marks =
    ends.length > 0
      ? [markerNode('circle', place(ends[0]), 4, robot.colour, true), markerNode('circle', place(ends.at(-1)), 4, robot.colour)]
      : [];
  return [...spans, lineNode(wayPoints(robot, frame, 0, end), frame, { colour: robot.colour, width: 1.5 }), ...marks];
}

/** The sample of a robot that is nearest to a place, where one is near. */
function nearestOnWay(report, frame, at) {
  let best = { distance: WAY.reachPx };
  for (const robot of report.robots) {
    for (let index = 0; index < report.time.length; index += 1) {
      const distance = Math.hypot(frame.x(robot.x[index]) - at[0], frame.y(robot.y[index]) - at[1]);
      if (distance < best.distance) best = { distance, robot, index };
    }
  }
  return best.robot ? best : null;
}

function wayTold(report, frame, x, y) {
  const near = nearestOnWay(report, frame, [frame.x(x), frame.y(y)]);
  if (near === null) return null;
  const { robot, index } = near;
  const lines = [
    `speed ${quantity(robot.speed[index], 3, 'm/s')}`,
    `off the centre line ${signed(millimetres(robot.deviation_m[index]), 1)}\u00a0mm`,
    outcomeWords(outcomeAt(robot, index).name),
  ];
  return [`${robot.name} at ${quantity(report.time[index], 1, 's')}`, lines];
}

function wayCaption({ robots, lane }, stretch) {
  const farthest = robots.map(({ name, deviation_m: deviation }) => {
    const { low, high } = extent(deviation);
    return high >= low ? [`${name} ${quantity(millimetres(Math.max(-low, high)), 1, 'mm')}`] : [];
  });
  const words = farthest.flat();
  const parts = words.length > 0 ? [`Farthest from the centre line: ${words.join(', ')}.`] : [];
  if (Number.isFinite(lane.halfWidth)) parts.push(`The edges are ${quantity(millimetres(lane.halfWidth), 0, 'mm')} away from it.`);
  if (stretch > 1.05) parts.push(`Across, all is drawn ${fixed(stretch, 1)} times as large as along.`);
  return parts.join(' ');
}

function wayPicture(report, scene, frame) {
  const beside = report.undisturbed.map((robot) => lineNode(wayPoints(robot, frame, 0, report.time.length), frame, BESIDE));
  const ways = report.robots.flatMap((robot) => wayNodes(report, robot, frame));
  const label = `Ways of the robots in their lane. ${wayCaption(report, frame.stretch)}`;
  const drawn = picture(frame, label, [...frame.axes, ...laneNodes(report.lane, frame), ...beside, ...ways]);
  return hoverable(frame, drawn, (x, y) => wayTold(report, frame, x, y));
}

function wayLegend(report) {
  const spans = report.robots.flatMap(({ index }) => trackerSpans(report, index).map(({ kind }) => kind));
  const entry = (kind) => {
    const sample = strokeSample(eventLook({ kind }).colour);
    Object.assign(sample.style, { borderTopWidth: '6px', opacity: 0.5, marginBottom: '0.15em' });
    return [sample, eventLook({ kind }).label ?? kind];
  };
  const beside = report.undisturbed.length > 0 ? lineEntries([UNDISTURBED]) : [];
  return legendOf([...lineEntries(report.robots.map(({ name, colour }) => ({ name, colour }))), ...beside, ...[...new Set(spans)].map(entry)]);
}

function pathSection(report) {
  const scene = hasTimes(report) ? newScene(report) : null;
  if (scene === null) return absent('path', 'The document has no motion of robots (figures).');
  const [body, caption] = [el('div'), el('figcaption')];
  byId('path-body').append(el('figure', {}, body, wayLegend(report), caption));
  return () => {
    const frame = wayFrame(scene, chartWidth(body, scene.follows ? WAY.most : WAY.closedMost));
    body.replaceChildren(wayPicture(report, scene, frame));
    caption.replaceChildren(`A ring is where a robot starts, a dot where it ends. ${wayCaption(report, frame.stretch)}`);
  };
}
