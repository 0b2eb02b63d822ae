// ---------------------------------------------------------------- robots of a session, as lists that grow

/** What is kept of a robot over time, by the name it has in a snapshot. */
const KEPT = { x: 'x_m', y: 'y_m', heading: 'heading_rad', speed: 'speed_mps', h_headway: 'h_headway_m', lane_clearance: 'lane_clearance_m' };

function newRobot(id, index, count) {
  const kept = Object.fromEntries(Object.keys(KEPT).map((key) => [key, new Array(count).fill(NaN)]));
  return { id, name: `robot ${id}`, colour: ROBOT_COLOURS[index % ROBOT_COLOURS.length], now: {}, ...kept };
}

/** Adds a snapshot to the times and the robots of `live`, and drops what is older than a window. */
function remember(live, snapshot, windowS) {
  const { time, robots } = live;
  const said = new Map(list(snapshot.robots).map((robot) => [object(robot).id, object(robot)]));
  for (const id of said.keys()) {
    if (!robots.some((robot) => robot.id === id)) robots.push(newRobot(id, robots.length, time.length));
  }
  time.push(number(snapshot.time_s));
  const old = indexAt(time, time.at(-1) - windowS);
  time.splice(0, old);
  for (const robot of robots) {
    robot.now = said.get(robot.id) ?? {};
    for (const [key, name] of Object.entries(KEPT)) {
      robot[key].push(number(robot.now[name]));
      robot[key].splice(0, old);
    }
  }
}

// ---------------------------------------------------------------- cards

const milliseconds = (seconds) => number(seconds) * 1000;
const isBraking = (robot) => outcomeLook(text(robot.now.outcome)).kind === 'braking';

/** What a card tells; those that are bounds are marked below zero. */
const CARD_VALUES = [
  { label: 'Speed', unit: 'm/s', digits: 3, of: ({ speed_mps }) => number(speed_mps) },
  { label: 'Turn rate', unit: 'rad/s', digits: 2, of: ({ turn_rate_rad_s }) => number(turn_rate_rad_s) },
  { label: 'Headway h', unit: 'mm', digits: 0, isBound: true, of: ({ h_headway_m }) => millimetres(h_headway_m) },
  { label: 'To the edge', unit: 'mm', digits: 1, isBound: true, of: ({ lane_clearance_m }) => millimetres(lane_clearance_m) },
  { label: 'Deviation', unit: 'mm', digits: 1, of: ({ deviation_m }) => millimetres(deviation_m) },
  { label: 'Measured − told', unit: 'mm', digits: 0, of: ({ innovation_position_m }) => millimetres(innovation_position_m) },
  { label: 'Heading − told', unit: '°', digits: 0, of: ({ innovation_heading_rad }) => (number(innovation_heading_rad) * 180) / Math.PI },
  { label: 'Pose age', unit: 'ms', digits: 0, of: ({ pose_age_s }) => milliseconds(pose_age_s) },
];

/** A term with its value; `tell` writes the value. */
function valueRow({ label, unit, digits, isBound = false, of }) {
  const value = el('span', {}, '–');
  const cell = el('dd', {}, value, el('small', {}, unit));
  const tell = (source) => {
    const said = of(source);
    value.textContent = fixed(said, digits);
    cell.className = isBound && said < 0 ? 'unsure' : '';
  };
  return { node: el('div', {}, el('dt', {}, label), cell), tell };
}

function robotCard(robot) {
  const [sign, words] = [swatch(UNKNOWN.colour), el('span', {}, UNKNOWN.kind)];
  const outcome = el('span', { class: 'outcome' }, sign, words);
  const rows = CARD_VALUES.map(valueRow);
  const title = el('h3', {}, swatch(robot.colour), robot.name);
  const values = el('dl', { class: 'values' }, ...rows.map((row) => row.node));
  const node = el('article', { class: 'card', 'aria-label': robot.name }, el('header', {}, title, outcome), values);
  const tell = () => {
    const name = text(robot.now.outcome);
    const { colour } = outcomeLook(name);
    rows.forEach((row) => row.tell(robot.now));
    words.textContent = outcomeWords(name);
    sign.style.background = `var(${colour})`;
    sign.hidden = isBraking(robot);
    node.style.borderLeftColor = `var(${colour})`;
    outcome.classList.toggle('halted', isBraking(robot));
  };
  return { node, tell };
}

// ---------------------------------------------------------------- barriers of the last seconds

/** A chart that is drawn anew while the pointer may be over it. */
function runningChart(live, { title, key, unit, digits, scale, windowS }) {
  const body = el('div');
  const [legend, node] = [el('div'), el('figure', {}, el('h3', {}, title), body)];
  node.append(legend);
  let pointer = null;
  body.addEventListener('pointermove', ({ clientX, clientY }) => (pointer = { clientX, clientY }));
  body.addEventListener('pointerleave', () => (pointer = null));
  const draw = () => {
    const { time, robots } = live;
    const lines = robotLines({ robots, undisturbed: [] }, key, scale).filter(({ values }) => isKnown(values));
    const nothing = robots.length > 0 ? 'Not known for any robot.' : 'No data yet.';
    legend.replaceChildren(lines.length > 0 ? lineLegend(lines) : note(nothing));
    if (lines.length === 0) return body.replaceChildren();
    const low = Math.max(time.at(-1) - windowS, 0);
    const report = { time, robots, events: [], along: { low, high: low + windowS } };
    const spec = { title, lines, unit, digits, isBound: true, caption: `The last ${windowS} seconds.` };
    body.replaceChildren(timePicture(report, spec, chartWidth(body)));
    if (pointer) body.querySelector('svg').dispatchEvent(new PointerEvent('pointermove', pointer));
  };
  return { node, draw };
}
