// ---------------------------------------------------------------- robots in their lane on a canvas

const SCENE = { margin: 20, trailS: 4, sector: 0.45, least: 11, body: 0.1, followed: 0.25, mostScale: 500 };

/** From the first to the last of some points along both axes. */
function boundsOf(points) {
  const [x, y] = [0, 1].map((axis) => extent(points.map((point) => point[axis])));
  return { x, y, width: x.high - x.low, height: y.high - y.low };
}

const placesOf = ({ x, y }) => Array.from(x, (value, index) => [value, y[index]]).filter(([a, b]) => Number.isFinite(a + b));

/** How far apart the robots are at most, along both axes. */
function widestSpread({ robots, time }) {
  const spread = { width: 0, height: 0 };
  for (let index = 0; index < time.length; index += 1) {
    const { width, height } = boundsOf(robots.map(({ x, y }) => [x[index], y[index]]));
    spread.width = Math.max(spread.width, Number.isFinite(width) ? width : 0);
    spread.height = Math.max(spread.height, Number.isFinite(height) ? height : 0);
  }
  return spread;
}

function pathThrough(points, closes, path = new Path2D()) {
  points.forEach(([x, y], index) => path[index === 0 ? 'moveTo' : 'lineTo'](x, y));
  if (closes) path.closePath();
  return path;
}

/** The paths of a lane, in metres. */
function lanePaths({ left, right, centre, closed }) {
  const edges = closed ? [left, right] : [[...left, ...right.toReversed()]];
  const band = new Path2D();
  edges.forEach((points) => pathThrough(points, true, band));
  return { band, edges: [left, right].map((points) => pathThrough(points, closed)), centre: pathThrough(centre, closed) };
}

/** What does not change while the robots move. A lane that is not closed is seen from a camera that goes with them. */
function newScene(report) {
  const { lane, robots, body } = report;
  const all = boundsOf([...lane.left, ...lane.right, ...lane.centre, ...robots.flatMap(placesOf)]);
  if (!(all.width + all.height > 0)) return null;
  const spread = widestSpread(report);
  const [around, across] = [2 * SCENE.followed, 2 * (lane.halfWidth || 0) + SCENE.followed];
  const followed = { width: spread.width + Math.max(around, across), height: spread.height + across };
  const half = (body.length || SCENE.body) / 2;
  const bodies = { width: all.width + 2 * half, height: all.height + 2 * half };
  return { follows: !lane.closed, all, seen: lane.closed ? bodies : followed, paths: lanePaths(lane) };
}

// ---------------------------------------------------------------- where everything is

/** The sample before a time and the share of the way to the next one. */
function momentAt(time, timeS) {
  const after = Math.min(Math.max(indexAt(time, timeS), 1), time.length - 1);
  const before = Math.max(after - 1, 0);
  const share = (timeS - time[before]) / (time[after] - time[before] || 1);
  return { before, after, share: Math.min(Math.max(share, 0), 1) };
}

const nearestSample = ({ before, after, share }) => (share < 0.5 ? before : after);
const blend = (values, { before, after, share }) => values[before] + share * (values[after] - values[before]);

function poseAt(robot, moment) {
  const turn = robot.heading[moment.after] - robot.heading[moment.before];
  const shortest = Math.atan2(Math.sin(turn), Math.cos(turn));
  const heading = robot.heading[moment.before] + moment.share * shortest;
  return { x: blend(robot.x, moment), y: blend(robot.y, moment), heading, speed: blend(robot.speed, moment) };
}

/** Metres to pixels of a canvas. */
function cameraOf({ follows, all, seen }, poses, width, height) {
  const [across, up] = [width - 2 * SCENE.margin, height - 2 * SCENE.margin];
  const most = follows ? SCENE.mostScale : Infinity;
  const scale = Math.max(Math.min(across / (seen.width || 1e-3), up / (seen.height || 1e-3), most), 1);
  const known = poses.filter(({ x, y }) => Number.isFinite(x + y)).map(({ x, y }) => [x, y]);
  const { x, y } = follows && known.length > 0 ? boundsOf(known) : all;
  const [centreX, centreY] = [(x.low + x.high) / 2, (y.low + y.high) / 2];
  const at = (px, py) => [width / 2 + (px - centreX) * scale, height / 2 - (py - centreY) * scale];
  return { width, height, scale, centreX, centreY, at };
}

// ---------------------------------------------------------------- drawing

function drawLane(context, { paths }, camera, palette) {
  const { scale, centreX, centreY, width, height } = camera;
  context.save();
  context.transform(scale, 0, 0, -scale, width / 2 - centreX * scale, height / 2 + centreY * scale);
  context.fillStyle = palette.colour('--raised');
  context.fill(paths.band, 'evenodd');
  context.lineWidth = 1.5 / scale;
  context.strokeStyle = palette.colour('--other');
  paths.edges.forEach((edge) => context.stroke(edge));
  context.lineWidth = 1 / scale;
  context.setLineDash([6 / scale, 5 / scale]);
  context.stroke(paths.centre);
  context.restore();
}

/** A bar of a round length; posts beside the lane for a camera that moves. */
function drawMeasure(context, scene, camera, palette) {
  const { width, height, scale, centreX, at } = camera;
  const step = niceStep(width / scale, 5);
  context.fillStyle = palette.colour('--quiet');
  context.strokeStyle = palette.colour('--quiet');
  context.lineWidth = 1;
  context.textAlign = 'center';
  const digits = stepDigits(step);
  if (scene.follows) {
    const half = width / scale / 2;
    for (const { value, label } of ticks(centreX - half, centreX + half, 5)) {
      const [x] = at(value, 0);
      context.fillRect(x - 0.5, height - 22, 1, 6);
      if (x > 24 && x < width - 24) context.fillText(`${label}\u00a0m`, x, height - 4);
    }
    return;
  }
  const bar = step * scale;
  context.fillRect(SCENE.margin, height - 8, bar, 2);
  context.textAlign = 'left';
  context.fillText(quantity(step, digits, 'm'), SCENE.margin, height - 13);
}

function drawTrail(context, robot, time, timeS, moment, camera, palette) {
  const first = indexAt(time, timeS - SCENE.trailS);
  context.strokeStyle = palette.colour(robot.colour);
  context.lineWidth = 2;
  context.globalAlpha = 0.45;
  context.beginPath();
  let drawing = false;
  const point = (x, y) => {
    const known = Number.isFinite(x + y);
    if (known) context[drawing ? 'lineTo' : 'moveTo'](...camera.at(x, y));
    drawing = known;
  };
  for (let index = first; index <= moment.before; index += 1) point(robot.x[index], robot.y[index]);
  point(blend(robot.x, moment), blend(robot.y, moment));
  context.stroke();
  context.globalAlpha = 1;
}

/** How far a follower drives in its headway time, and the chord to the robot ahead. */
function drawHeadway(context, pose, ahead, headwayS, colour, camera, palette) {
  const [x, y] = camera.at(pose.x, pose.y);
  const reach = headwayS * pose.speed * camera.scale;
  if (Number.isFinite(x + y + pose.heading) && reach > 0) {
    context.fillStyle = colour;
    context.strokeStyle = colour;
    context.lineWidth = 1.5;
    const [from, to] = [-pose.heading - SCENE.sector, -pose.heading + SCENE.sector];
    context.globalAlpha = 0.18;
    context.beginPath();
    context.moveTo(x, y);
    context.arc(x, y, reach, from, to);
    context.fill();
    context.globalAlpha = 1;
    context.beginPath();
    context.arc(x, y, reach, from, to);
    context.stroke();
  }
  const [leadX, leadY] = camera.at(ahead.x, ahead.y);
  if (!Number.isFinite(x + y + leadX + leadY)) return;
  context.strokeStyle = palette.colour('--quiet');
  context.lineWidth = 1;
  context.setLineDash([3, 3]);
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(leadX, leadY);
  context.stroke();
  context.setLineDash([]);
}

function drawBody(context, robot, pose, body, colour, camera, palette) {
  if (!Number.isFinite(pose.x + pose.y)) return;
  const heading = Number.isFinite(pose.heading) ? pose.heading : 0;
  const offset = body.offset || 0;
  const [x, y] = camera.at(pose.x - offset * Math.cos(heading), pose.y - offset * Math.sin(heading));
  const length = Math.max((body.length || SCENE.body) * camera.scale, SCENE.least);
  const width = Math.min(Math.max((body.base || 0) * camera.scale, 0.6 * length), length);
  context.save();
  context.translate(x, y);
  context.rotate(-heading);
  context.fillStyle = colour;
  context.strokeStyle = palette.colour('--ink');
  context.lineWidth = 1.25;
  context.beginPath();
  context.roundRect(-length / 2, -width / 2, length, width, 0.3 * width);
  context.fill();
  context.stroke();
  context.beginPath();
  context.moveTo(0.42 * length, 0);
  context.lineTo(0.1 * length, -0.24 * width);
  context.lineTo(0.1 * length, 0.24 * width);
  context.fillStyle = palette.colour('--paper');
  context.fill();
  context.restore();
  context.textAlign = 'center';
  context.lineWidth = 3;
  context.strokeStyle = palette.colour('--paper');
  context.fillStyle = palette.colour('--ink');
  const above = y - length / 2 - 6;
  context.strokeText(robot.name, x, above);
  context.fillText(robot.name, x, above);
}

function outcomeAt(robot, index) {
  const name = robot.outcome.names[robot.outcome.steps[index]] ?? '';
  return { name, look: outcomeLook(name) };
}

/** Everything as it is at a time. */
function drawScene(canvas, scene, report, timeS, palette) {
  if (canvas.clientWidth === 0) return;
  const { context } = prepareCanvas(canvas);
  const { robots, time } = report;
  const moment = momentAt(time, timeS);
  const poses = robots.map((robot) => poseAt(robot, moment));
  const camera = cameraOf(scene, poses, canvas.clientWidth, canvas.clientHeight);
  const colours = robots.map((robot) => palette.colour(outcomeAt(robot, nearestSample(moment)).look.colour));
  context.font = `12px ${palette.font}`;
  context.lineJoin = 'round';
  drawLane(context, scene, camera, palette);
  drawMeasure(context, scene, camera, palette);
  context.textAlign = 'left';
  context.fillText(quantity(timeS, 1, 's'), SCENE.margin, SCENE.margin + 4);
  robots.forEach((robot) => drawTrail(context, robot, time, timeS, moment, camera, palette));
  poses.slice(1).forEach((pose, index) => drawHeadway(context, pose, poses[index], report.headwayS, colours[index + 1], camera, palette));
  robots.forEach((robot, index) => drawBody(context, robot, poses[index], report.body, colours[index], camera, palette));
}
