// ---------------------------------------------------------------- the run, played

const PACES = [1, 4, 16].map((factor) => ({ label: `×${factor}`, factor }));
const PLAYER = { longestMs: 100, toldMs: 100, stepS: 0.1 };

const wantsRest = () => window.matchMedia('(prefers-reduced-motion: reduce)').matches;

/** The values of all robots at a time, in a table that is written anew while they move. */
function readout(report) {
  const { robots } = report;
  const columns = [['Speed', 'm/s'], ['Headway h', 'mm'], ['To the edge', 'mm']];
  const title = ([label, unit]) => el('th', { scope: 'col' }, label, el('small', {}, unit));
  const head = el('tr', {}, heading('Robot', 'text corner'), ...columns.map(title), heading('Step', 'text'));
  const rows = robots.map((robot) => {
    const [sign, ending] = [swatch(UNKNOWN.colour), el('span')];
    const cells = columns.map(() => el('td'));
    const name = el('th', { scope: 'row' }, swatch(robot.colour), robot.name);
    return { robot, sign, ending, cells, node: el('tr', {}, name, ...cells, el('td', { class: 'text' }, sign, ending)) };
  });
  const node = tableBox('Values at the time shown', [head], [el('tbody', {}, ...rows.map((row) => row.node))]);
  const tell = (index) =>
    rows.forEach(({ robot, sign, ending, cells }) => {
      const { name, look } = outcomeAt(robot, index);
      const headway = fixed(millimetres(robot.h_headway[index]), 1);
      const edge = fixed(millimetres(robot.lane_clearance_m[index]), 1);
      const values = [fixed(robot.speed[index], 3), headway, edge];
      values.forEach((value, place) => (cells[place].textContent = value));
      sign.style.background = `var(${look.colour})`;
      ending.textContent = outcomeWords(name);
    });
  return { node, tell };
}

/** The bar that shows the time and moves it. */
function timeSlider(from, to, onMove) {
  const input = el('input', { type: 'range', min: from, max: to, step: PLAYER.stepS, value: from, autocomplete: 'off' });
  const said = el('output');
  input.addEventListener('input', () => onMove(Number(input.value)));
  const tell = (timeS) => {
    const words = quantity(timeS, 1, 's');
    input.value = timeS;
    input.setAttribute('aria-valuetext', words);
    said.textContent = words;
  };
  return { node: el('label', { class: 'time' }, el('span', {}, 'Time'), input, said), tell };
}

function newPlayer(report, scene) {
  const { time } = report;
  const canvas = el('canvas', { role: 'img', 'aria-label': 'The robots in their lane at the time shown' });
  const player = { report, scene, canvas, from: time[0], to: time[time.length - 1], at: time[0], factor: 1 };
  Object.assign(player, { plays: false, isSeen: false, before: NaN, told: 0, frame: 0, palette: readPalette() });
  player.slider = timeSlider(player.from, player.to, (timeS) => {
    pause(player);
    show(player, timeS);
  });
  player.values = readout(report);
  player.buttons = toolbar('Play the run', [
    ['Play', 'Play', () => (player.plays ? pause(player) : play(player))],
    ['To the start', 'To the start', () => show(player, player.from)],
  ]);
  return player;
}

function labelButton({ buttons, plays }) {
  const [button] = buttons.children;
  const label = plays ? 'Pause' : 'Play';
  button.textContent = label;
  button.title = label;
  button.setAttribute('aria-label', label);
}

function show(player, timeS) {
  const { report, values, slider } = player;
  player.at = Math.min(Math.max(timeS, player.from), player.to);
  drawScene(player.canvas, player.scene, report, player.at, player.palette);
  // A table that changes with every frame could not be read.
  const now = performance.now();
  if (player.plays && now - player.told < PLAYER.toldMs) return;
  player.told = now;
  slider.tell(player.at);
  values.tell(nearestSample(momentAt(report.time, player.at)));
}

function pause(player) {
  player.plays = false;
  labelButton(player);
  show(player, player.at);
}

/** From where it stands, or from the start once it has come to the end. */
function play(player) {
  player.plays = true;
  if (player.at >= player.to) player.at = player.from;
  labelButton(player);
  wake(player);
}

/** Goes on with the next frame while there is somebody to see it. */
function wake(player) {
  if (!player.plays || !player.isSeen || document.hidden || player.frame !== 0) return;
  player.frame = requestAnimationFrame((now) => {
    player.frame = 0;
    const elapsed = Number.isNaN(player.before) ? 0 : Math.min(now - player.before, PLAYER.longestMs);
    player.before = now;
    show(player, player.at + (player.factor * elapsed) / 1000);
    if (player.at >= player.to) pause(player);
    if (player.plays && player.isSeen) wake(player);
    else player.before = NaN;
  });
}

function watch(player) {
  new IntersectionObserver(([entry]) => {
    player.isSeen = entry.isIntersecting;
    wake(player);
  }).observe(player.canvas);
  document.addEventListener('visibilitychange', () => {
    player.before = NaN;
    wake(player);
  });
}

function viewLegend({ headwayS }) {
  const sector = swatch('--acceleration');
  sector.style.opacity = 0.3;
  const reach = Number.isFinite(headwayS) ? `way in ${quantity(headwayS, 1, 's')}` : 'way in the headway time';
  const outcomes = OUTCOMES.map(({ kind, colour }) => [swatch(colour), kind]);
  return legendOf([...outcomes, [sector, reach], [strokeSample('--quiet', 'dashed'), 'to the robot ahead']]);
}

function viewSection(report) {
  const scene = report.time.length > 1 && report.robots.length > 0 ? newScene(report) : null;
  if (scene === null) return absent('view', 'The document has no motion of robots (figures).');
  const player = newPlayer(report, scene);
  const stage = el('div', { class: 'stage' }, player.canvas);
  const shape = (scene.seen.width || 1) / (scene.seen.height || 1);
  stage.style.aspectRatio = Math.min(Math.max(shape, 1), 3);
  const pick = ({ factor }) => {
    player.factor = factor;
  };
  const controls = el('div', { class: 'controls' }, player.buttons, radios('Speed', 'pace', PACES, pick), player.slider.node);
  const figure = el('figure', {}, stage, viewLegend(report));
  byId('view-body').append(controls, el('div', { class: scene.follows ? 'run wide' : 'run' }, figure, player.values.node));
  show(player, player.from);
  if (!wantsRest()) play(player);
  watch(player);
  return () => {
    player.palette = readPalette();
    show(player, player.at);
  };
}
