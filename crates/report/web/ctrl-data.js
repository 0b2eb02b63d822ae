// ---------------------------------------------------------------- the document of a run

const SCHEMA = 'drivekit/ctrl-run/1';
const SCHEMA_KEYS = ['schema', 'version', 'config', 'inputs', 'scenario', 'outcomes', 'figures'];

const ROBOT_COLOURS = ['--measured', '--series-0', '--series-1', '--series-2', '--series-3', '--series-6', '--series-7'];
const VALUES = ['h_lane', 'lane_clearance_m', 'deviation_m', 'v1', 'v2', 'v3'];

/** How a step ends, from the best to the worst. */
const OUTCOMES = [
  { kind: 'optimal', colour: '--acceleration' },
  { kind: 'relaxed', colour: '--series-4' },
  { kind: 'braking', colour: '--braking' },
];
const UNKNOWN = { kind: 'not known', colour: '--other' };

/** What the barrier of the lane is measured in. */
const LANE_BARRIERS = {
  quadratic: { unit: 'of 1', scale: 1, digits: 3, words: '1 on the centre line, 0 at the edge, less in sideways motion' },
  braking: { unit: 'mm', scale: 1000, digits: 1, words: 'the distance to the edge less the sideways braking distance' },
  exponential: { unit: 'mm', scale: 1000, digits: 1, words: 'the distance to the edge' },
};
const OTHER_BARRIER = { unit: '', scale: 1, digits: 3, words: '' };

const millimetres = (metres) => number(metres) * 1000;
const isKnown = (values) => values.some(Number.isFinite);

/** As many numbers as there are times. */
const series = (source, count) => {
  const values = list(source);
  return Float64Array.from({ length: count }, (_, index) => number(values[index]));
};

/** Pairs of numbers that are known, as points `[x, y]`. */
const readPoints = (source) =>
  list(source)
    .map((point) => list(point).map(number))
    .filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));

function readLane(source) {
  const raw = object(source);
  return {
    halfWidth: number(raw.half_width_m),
    closed: raw.closed === true,
    centre: readPoints(raw.centre_m),
    left: readPoints(raw.left_m),
    right: readPoints(raw.right_m),
  };
}

/** The outcome of each step by its place in the list of names. */
function readOutcomes(source, count) {
  const names = [];
  const steps = new Int16Array(count).fill(-1);
  let at = 0;
  for (const run of list(source).map(list)) {
    const [name, length] = [text(run[0]), Math.max(number(run[1]) || 0, 0)];
    if (!names.includes(name)) names.push(name);
    steps.fill(names.indexOf(name), at, at + length);
    at = Math.min(at + length, count);
  }
  return { names, steps };
}

function outcomeLook(name) {
  const kind = name.split(/[-:, ]/)[0];
  return OUTCOMES.find((one) => one.kind === kind) ?? UNKNOWN;
}

/** “braking-stale-pose” as words. */
const outcomeWords = (name) => name.replace(/[-_]/g, ' ').replace(/^(relaxed|braking) /, '$1: ') || UNKNOWN.kind;

function readMotion(source, index, count) {
  const raw = object(source);
  const values = Object.fromEntries(VALUES.map((key) => [key, series(raw[key], count)]));
  return {
    index,
    name: text(raw.name) || `robot ${index + 1}`,
    colour: ROBOT_COLOURS[index % ROBOT_COLOURS.length],
    x: series(raw.x_m, count),
    y: series(raw.y_m, count),
    h_headway: series(raw.h_headway_m, count),
    ...values,
  };
}

/** Pairs of a time and the speed wanted from then on, of each robot. */
const readDesired = (spec) =>
  list(object(object(spec).scenario).robots).map((robot) => readPoints(object(robot).desired_speed_mps));

function readRobot(source, index, count) {
  const raw = object(source);
  return {
    ...readMotion(raw, index, count),
    heading: series(raw.heading_rad, count),
    speed: series(raw.speed_mps, count),
    slack: [0, 1, 2].map((row) => series(list(raw.slack)[row], count)),
    outcome: readOutcomes(raw.outcome, count),
    age: series(raw.pose_age_s, count),
    stepUs: list(raw.step_us).map(number).filter((value) => value >= 0),
  };
}

function readEvent(source, endS) {
  const raw = object(source);
  const to = number(raw.to_s);
  return {
    robot: number(raw.robot),
    kind: text(raw.kind),
    from: number(raw.from_s),
    to: Number.isFinite(to) ? to : endS,
    value: number(raw.value),
  };
}

/** Robots of one name are told apart by a number. */
function distinguish(robots) {
  const names = robots.map(({ name }) => name);
  robots.forEach((robot, index) => {
    if (names.filter((name) => name === names[index]).length < 2) return;
    robot.name = `${names[index]} ${names.slice(0, index + 1).filter((name) => name === names[index]).length}`;
  });
  return robots;
}

function readFigures(source) {
  const raw = object(source);
  const time = Float64Array.from(list(raw.time_s), number);
  const robots = distinguish(list(raw.robots).map((robot, index) => readRobot(robot, index, time.length)));
  const beside = list(raw.undisturbed).map((robot, index) => readMotion(robot, index, time.length));
  const body = object(raw.robot);
  const barrier = text(raw.lane_barrier);
  return {
    lane: readLane(raw.lane),
    headwayS: number(raw.headway_s),
    barrier: Object.hasOwn(LANE_BARRIERS, barrier) ? LANE_BARRIERS[barrier] : OTHER_BARRIER,
    body: { length: number(body.length_m), offset: number(body.offset_m), base: number(body.wheel_base_m) },
    time: time.every(Number.isFinite) ? time : new Float64Array(0),
    robots,
    undisturbed: beside.slice(0, robots.length),
  };
}

function readControl(source) {
  const doc = object(source);
  const figures = readFigures(doc.figures);
  const durationS = number(doc.steps) / number(doc.rate_hz);
  const { time } = figures;
  const along = { low: time[0] ?? 0, high: (time.at(-1) ?? 0) + (1 / number(doc.rate_hz) || 0) };
  const endS = Number.isFinite(durationS) ? durationS : along.high;
  const outcomes = object(doc.outcomes);
  const loop = object(doc.loop);
  const events = list(doc.events).map((event) => readEvent(event, endS));
  return {
    ...readFrame(doc, SCHEMA_KEYS),
    ...{ scenario: text(doc.scenario), testbed: text(doc.testbed), preset: text(doc.preset), seed: number(doc.seed) },
    ...{ rateHz: number(doc.rate_hz), steps: number(doc.steps), disturbed: doc.disturbed === true, endS, along },
    leastHeadway: number(doc.min_h_headway_m),
    clearance: number(doc.lane_clearance_m),
    deviation: number(doc.max_abs_lateral_m),
    meanSpeed: number(doc.mean_speed_mps),
    maxSlack: number(doc.max_slack),
    outcomes: Object.fromEntries(OUTCOMES.map(({ kind }) => [kind, number(outcomes[kind])])),
    safe: typeof doc.safe === 'boolean' ? doc.safe : null,
    firstUnsafeS: number(doc.first_unsafe_s),
    loop: { median: number(loop.median_us), p99: number(loop.p99_us), max: number(loop.max_us), missed: number(loop.missed) },
    events: events.filter(({ from, to }) => to >= from),
    desired: readDesired(doc.spec),
    reproduces: list(doc.reproduces).map(text).filter((figure) => figure !== ''),
    ...figures,
  };
}
