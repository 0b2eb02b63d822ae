// ---------------------------------------------------------------- speed, time and elevation over the road

const EFFORTS = {
  drives: { name: 'drives', colour: '--series-0' },
  coasts: { name: 'coasts', colour: '--series-3' },
  regenerates: { name: 'regenerates', colour: '--series-2' },
  brakes_by_friction: { name: 'brakes by friction', colour: '--braking' },
};
const UNKNOWN_EFFORT = { name: 'moves', colour: '--series-0' };
const OWN_RUN = { name: 'own run', colour: '--quiet', width: 1.25 };
const LIMIT_LINE = { name: 'limit', colour: '--series-4', width: 1.25 };
const SIGNAL_LINE = { name: 'signal', colour: '--quiet' };
const DIP_KMH = 1.8;
const SIGNAL_WIDTH = 7;

const effortOf = (key) => (Object.hasOwn(EFFORTS, key) ? EFFORTS[key] : UNKNOWN_EFFORT);
const kilometres = ({ km }) => ({ low: km[0], high: km.at(-1), unit: 'km' });

/** Stretches of a run in which the car does the same, each with the first node of the next. */
function effortStretches({ efforts }) {
  const found = [];
  efforts.forEach((effort, step) => {
    const last = found.at(-1);
    if (last && last.effort === effort) last.to = step + 1;
    else found.push({ effort, from: step, to: step + 1 });
  });
  return found;
}

/** The limit of every step, the higher of both ends, so that places where the car stands do not count. */
const stepLimits = ({ limits }) => limits.slice(1).map((limit, step) => Math.max(limit, limits[step]));

function limitNodes(run, frame) {
  const steps = stepLimits(run);
  const points = steps.flatMap((limit, step) => [
    [run.km[step], limit],
    [run.km[step + 1], limit],
  ]);
  const isSlow = (node) => run.limits[node] > 0 && run.limits[node] < Math.min(steps[node - 1], steps[node]) - DIP_KMH;
  const slow = run.km.map((_, node) => node).filter((node) => node > 0 && node < steps.length && isSlow(node));
  const places = slow.map((node) => [frame.x(run.km[node]), frame.y(run.limits[node])]);
  return [lineNode(points, frame, LIMIT_LINE), markerNode('circle', places, 3, LIMIT_LINE.colour, true)];
}

function told(run, km) {
  const node = nearestIndex(run.km, km);
  const effort = run.efforts[Math.min(node, run.efforts.length - 1)];
  return [
    `km ${fixed(run.km[node], 2)}, ${fixed(run.seconds[node], 1)}\u00a0s`,
    [
      `${quantity(run.speeds[node], 1, 'km/h')}${run.limits[node] > 0 ? ` of ${fixed(run.limits[node], 0)}` : ''}`,
      ...(run.speeds[node] > 0 ? [effortOf(effort).name] : [`stands ${quantity(run.stood[node], 1, 's')}`]),
      `slope ${quantity(100 * Math.tan(run.slopes[Math.min(node, run.slopes.length - 1)]), 1, '%')}`,
    ],
  ];
}

function speedPicture({ plan, own, signals }, width) {
  const top = extent([...plan.speeds, ...plan.limits, ...(own?.speeds ?? [])]).high;
  const frame = chartFrame(width, Math.max(260, Math.round(width * 0.32)), kilometres(plan), { low: 0, high: 1.05 * top, unit: 'km/h' });
  const points = (run, from, to) => run.km.slice(from, to + 1).map((km, index) => [km, run.speeds[from + index]]);
  const stretches = effortStretches(plan).map(({ effort, from, to }) =>
    lineNode(points(plan, from, to), frame, { colour: effortOf(effort).colour, width: 2.5 }),
  );
  const stops = plan.km.filter((_, node) => plan.speeds[node] === 0).map((km) => [frame.x(km), frame.box.bottom]);
  const lights = signals.map(({ km }) => coloured(svg('line', { x1: frame.x(km), x2: frame.x(km), y1: frame.box.top, y2: frame.box.bottom }), 'stroke', '--quiet'));
  const label = `Speed over the position: ${quantity(plan.km.at(-1) - plan.km[0], 2, 'km')}, at most ${quantity(extent(plan.speeds).high, 0, 'km/h')}, ${plural(stops.length, 'place')} where the car stands.`;
  const nodes = [
    ...lights,
    ...limitNodes(plan, frame),
    ...(own ? [lineNode(points(own, 0, own.km.length - 1), frame, OWN_RUN)] : []),
    ...stretches,
    markerNode('circle', stops, 3.5, '--ink'),
  ];
  return hoverable(frame, picture(frame, label, [...frame.axes, ...nodes]), (km) => told(plan, km));
}

/** A signal along the time: red, and green in its windows. */
function signalNodes({ km, green }, frame) {
  const { range, y } = frame;
  const bar = (from, to, colour) => {
    const [top, bottom] = [to, from].map((time) => y(Math.min(Math.max(time, range.y.low), range.y.high)));
    const place = { x: frame.x(km) - SIGNAL_WIDTH / 2, width: SIGNAL_WIDTH, y: top, height: Math.max(bottom - top, 0) };
    return coloured(svg('rect', place), 'fill', colour);
  };
  const windows = green.filter(([from, to]) => to > from && from < range.y.high);
  return [bar(range.y.low, range.y.high, '--braking'), ...windows.map(([from, to]) => bar(from, to, '--acceleration'))];
}

function timePicture({ plan, own, signals }, width) {
  const runs = own ? [own, plan] : [plan];
  const last = Math.max(...runs.map(({ seconds, stood }) => seconds.at(-1) + stood.at(-1)));
  const frame = chartFrame(width, Math.max(220, Math.round(width * 0.24)), kilometres(plan), { low: 0, high: 1.02 * last, unit: 's' });
  const points = ({ km, seconds, stood }) => km.flatMap((at, node) => [[at, seconds[node]], [at, seconds[node] + stood[node]]]);
  const passed = signals.map(({ km, passageS }) => `km ${fixed(km, 2)} after ${quantity(passageS, 1, 's')}`).join('; ');
  const nodes = [
    ...signals.flatMap((signal) => signalNodes(signal, frame)),
    ...(own ? [lineNode(points(own), frame, OWN_RUN)] : []),
    lineNode(points(plan), frame, { colour: '--series-0', width: 2.5 }),
  ];
  return hoverable(frame, picture(frame, `Time over the position; signals are passed at ${passed}.`, [...frame.axes, ...nodes]), (km) => told(plan, km));
}

function elevationPicture({ plan }, width) {
  const { low, high } = rangeOf(plan.elevations, 0.1);
  const frame = chartFrame(width, Math.max(150, Math.round(width * 0.14)), kilometres(plan), { low, high: Math.max(high, low + 5), unit: 'm' });
  const ground = plan.km.map(() => low);
  const label = `Elevation above the start over the position, from ${fixed(extent(plan.elevations).low, 0)} to ${quantity(extent(plan.elevations).high, 0, 'm')}.`;
  const nodes = [
    areaNode(plan.km, ground, plan.elevations, frame, '--series-7', 0.25),
    lineNode(plan.km.map((km, node) => [km, plan.elevations[node]]), frame, { colour: '--series-7' }),
  ];
  return hoverable(frame, picture(frame, label, [...frame.axes, ...nodes]), (km) => told(plan, km));
}

function roadSection(report) {
  const { plan, own, signals } = report;
  if (!plan) return absent('road', 'The document has no plan to draw.');
  const used = Object.entries(EFFORTS).filter(([key]) => plan.efforts.includes(key)).map(([, effort]) => effort);
  const legend = lineLegend([...used, ...(own ? [OWN_RUN] : []), ...(Math.max(...plan.limits) > 0 ? [LIMIT_LINE] : []), ...(signals.length > 0 ? [SIGNAL_LINE] : [])]);
  const panels = [
    { draw: speedPicture, title: 'Speed', caption: legend },
    ...(signals.length > 0 ? [{ draw: timePicture, title: 'Time at the signals', caption: el('figcaption', {}, 'Signals are green and red as the plan has them, margins left out of the green.') }] : []),
    ...(plan.elevations.some((metres) => metres !== 0) ? [{ draw: elevationPicture, title: 'Elevation above the start', caption: '' }] : []),
  ];
  const bodies = panels.map(({ draw, title, caption }) => {
    const body = el('div');
    byId('road-body').append(el('figure', {}, el('h3', {}, title), body, caption));
    return () => body.replaceChildren(draw(report, chartWidth(body, 1200)));
  });
  return () => bodies.forEach((draw) => draw());
}
