// ---------------------------------------------------------------- the lane of a session

function buildStage() {
  live.scene = newScene(live);
  const { scene } = live;
  if (scene === null) return byId('view-body').replaceChildren(note('The lane is not known.'));
  live.canvas = el('canvas', { role: 'img', 'aria-label': 'The robots in their lane now' });
  const stage = el('div', { class: 'stage' }, live.canvas);
  const shape = (scene.seen.width || 1) / (scene.seen.height || 1);
  stage.style.aspectRatio = Math.min(Math.max(shape, 1), 3);
  const entries = ['relaxed', 'braking'].map((kind) => OUTCOMES.find((one) => one.kind === kind));
  byId('view-body').replaceChildren(stage, legendOf(entries.map(({ kind, colour }) => [swatch(colour), `halo: ${kind}`])));
  byId('watch').classList.toggle('wide', scene.follows);
}

/** A halo that says that a step was not optimal. */
function drawHalo(context, robot, pose, camera) {
  const { kind, colour } = outcomeLook(text(robot.now.outcome));
  if (kind === 'optimal' || !Number.isFinite(pose.x + pose.y)) return;
  const offset = live.body.offset || 0;
  const [x, y] = camera.at(pose.x - offset * Math.cos(pose.heading), pose.y - offset * Math.sin(pose.heading));
  context.fillStyle = live.palette.colour(colour);
  context.globalAlpha = 0.5;
  context.beginPath();
  context.arc(x, y, Math.max((live.body.length || SCENE.body) * camera.scale, SCENE.least), 0, 2 * Math.PI);
  context.fill();
  context.globalAlpha = 1;
}

/** A camera that goes with the robots sees all of them, also once they have drifted apart. */
function widen(scene, poses) {
  const { width, height } = boundsOf(poses.filter(({ x, y }) => Number.isFinite(x + y)).map(({ x, y }) => [x, y]));
  const margin = 2 * SCENE.followed;
  scene.seen.width = Math.max(scene.seen.width, width + margin || 0);
  scene.seen.height = Math.max(scene.seen.height, height + margin || 0);
}

function drawRobots() {
  const { scene, canvas, time, robots, palette, body, headwayS } = live;
  if (scene === null || canvas.clientWidth === 0) return;
  const { context } = prepareCanvas(canvas);
  const moment = momentAt(time, time.at(-1));
  const poses = robots.map((robot) => poseAt(robot, moment));
  if (scene.follows) widen(scene, poses);
  const camera = cameraOf(scene, poses, canvas.clientWidth, canvas.clientHeight);
  context.font = `12px ${palette.font}`;
  context.lineJoin = 'round';
  drawLane(context, scene, camera, palette);
  drawMeasure(context, scene, camera, palette);
  if (time.length === 0) return;
  robots.forEach((robot) => drawTrail(context, robot, time, time.at(-1), moment, camera, palette));
  robots.forEach((robot, index) => {
    if (index === 0 || !(headwayS > 0) || robot.now.h_headway_m === null) return;
    drawHeadway(context, poses[index], poses[index - 1], headwayS, palette.colour(robot.colour), camera, palette);
  });
  robots.forEach((robot, index) => {
    drawHalo(context, robot, poses[index], camera);
    const named = isBraking(robot) ? { ...robot, name: `${robot.name}, braking` } : robot;
    drawBody(context, named, poses[index], body, palette.colour(robot.colour), camera, palette);
  });
}
