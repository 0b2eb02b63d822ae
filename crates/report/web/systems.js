// ---------------------------------------------------------------- identified responses

const SYSTEM = { gain: 20, duration: 5, colour: '--series-4' };
const METHODS = ['transition-point', 'rise-time'];

function readSystem(source) {
  const raw = object(source);
  return {
    at: number(raw.transition_s),
    speed: kmh(raw.transition_speed_mps),
    slope: kmh(raw.slope_mps2),
    dead: number(raw.dead_time_s),
    rise: number(raw.build_up_time_s),
    response: readResponse(raw.response),
  };
}

function readResponse(source) {
  const raw = object(source);
  const [t1, t2, order, time] = [raw.t1_s, raw.t2_s, raw.order, raw.time_constant_s].map(number);
  if (raw.kind === 'distinct' && t1 > 0 && t2 > 0) return { kind: 'distinct', t1, t2 };
  return raw.kind === 'equal' && time > 0 && order >= 1 && order <= 50 ? { kind: 'equal', order: Math.round(order), time } : null;
}

/** The share of the final value that a response has reached. */
function stepShare({ kind, t1, t2, order, time }, t) {
  if (kind === 'distinct') {
    if (Math.abs(t1 - t2) < 1e-9 * t1) return 1 - (1 + t / t1) * Math.exp(-t / t1);
    return 1 + (t1 / (t2 - t1)) * Math.exp(-t / t1) + (t2 / (t1 - t2)) * Math.exp(-t / t2);
  }
  let [term, sum] = [1, 0];
  for (let i = 0; i < order; i += 1) {
    sum += term;
    term *= t / time / (i + 1);
  }
  return 1 - sum * Math.exp(-t / time);
}

function responseText(response) {
  if (response === null) return 'no response identified';
  const { kind, t1, t2, order, time } = response;
  if (kind === 'distinct') return `T₁\u00a0=\u00a0${quantity(t1, 2, 's')}, T₂\u00a0=\u00a0${quantity(t2, 2, 's')}`;
  return `order\u00a0${fixed(order, 0)}, T\u00a0=\u00a0${quantity(time, 2, 's')}`;
}

const gainOf = ({ measured }) => measured[measured.length - 1] - measured[0];

function responseCurve(phase, response) {
  if (response === null) return [];
  return timesOf(phase).map((t) => phase.measured[0] + gainOf(phase) * stepShare(response, t));
}

/** Root mean squared error of a response over the speed gained: what makes a phase fit to illustrate the method. */
function misfit(phase, { response, dead, rise }) {
  const usual = gainOf(phase) >= SYSTEM.gain && phase.durationS >= SYSTEM.duration && dead > 0.05 * rise;
  if (response === null || !usual) return Infinity;
  const curve = responseCurve(phase, response);
  const squares = curve.map((value, index) => (value - phase.measured[index]) ** 2);
  const error = Math.sqrt(mean(squares)) / gainOf(phase);
  return Number.isFinite(error) ? error : Infinity;
}

/** The tangent at the transition point between both levels, and the times that it marks. */
function constructionNodes(phase, { at, speed, slope, dead, rise }) {
  const [from, to] = [phase.measured[0], phase.measured[phase.measured.length - 1]];
  const ends = [dead, dead + rise];
  return (frame) => {
    const { x, y, box } = frame;
    if (!Number.isFinite(dead + rise)) return [];
    const inner = (t) => Math.min(Math.max(t, 0), frame.range.x.high);
    const tangent = ends.map(inner).map((t) => [t, Number.isFinite(at + speed + slope) ? speed + slope * (t - at) : NaN]);
    const upright = (t) => svg('line', { class: 'axis', 'stroke-dasharray': '3 3', x1: x(t), x2: x(t), y1: box.top, y2: box.bottom });
    const level = (value) => lineNode([[0, value], [frame.range.x.high, value]], frame, { colour: '--quiet', kind: 'dotted', width: 1.25 });
    const name = (t, sign, size) => [
      svg('tspan', { 'font-style': 'italic' }, 'T'),
      svg('tspan', { dy: 3, 'font-size': 10 }, `${sign}`),
      svg('tspan', { dy: -3 }, ` = ${quantity(size, 1, 's')}`),
    ];
    const label = (t, sign, size) => svg('text', { class: 'value', x: t, y: box.top - 6, 'text-anchor': 'middle' }, ...name(t, sign, size));
    const [left, middle, right] = [x(0), x(inner(dead)), x(inner(dead + rise))];
    return [
      ...[level(from), level(to)],
      ...ends.filter((t) => t >= 0 && t <= frame.range.x.high).map(upright),
      lineNode(tangent, frame, { colour: '--braking', width: 1.5 }),
      label(Math.max((left + middle) / 2, box.left + 26), 'U', dead),
      label(Math.max((middle + right) / 2, box.left + 110), 'G', rise),
      ...(Number.isFinite(at + speed) ? [markerNode('circle', [[x(at), y(speed)]], 4.5, '--braking', true)] : []),
    ];
  };
}

function systemFigure(phase, system, width) {
  const lines = [
    { name: 'measured', colour: '--measured', width: 2, values: phase.measured },
    { name: 'identified', colour: SYSTEM.colour, width: 2, kind: 'dashed', values: responseCurve(phase, system.response) },
  ].filter(({ values }) => values.length > 0);
  const times = `dead time ${quantity(system.dead, 2, 's')}, build-up time ${quantity(system.rise, 2, 's')}, ${responseText(system.response)}`;
  const caption = `${phaseName(phase)}. Transition point at ${quantity(system.at, 1, 's')} and ${quantity(system.speed, 1, 'km/h')}; ${times}.`;
  const chart = timeChart({
    label: `Speed of a phase with its transition point and tangent. ${caption}`,
    ...{ width, timeS: timesOf(phase), lines, unit: 'km/h', digits: 1, along: 's since the phase began' },
    over: constructionNodes(phase, system),
  });
  const ring = coloured(el('span', { 'aria-hidden': 'true' }, '○ '), 'color', '--braking');
  const legend = legendOf([...lineEntries(lines), [strokeSample('--braking'), 'tangent'], [ring, 'transition point']]);
  return [chart, legend, el('figcaption', {}, caption)];
}

/** Figure 3.14. */
function transitionFigure(report) {
  const known = list(report.systems.phases).flatMap((source, index) => {
    const phase = report.phases[index];
    const usable = phase && phase.measured.length > 1 && phase.stepS > 0 && Object.keys(object(source)).length > 0;
    return usable ? [{ phase, system: readSystem(source) }] : [];
  });
  const body = byId('systems-transition');
  if (known.length === 0) {
    body.replaceChildren(note('This evaluation has no transition points.'));
    return () => {};
  }
  const errors = known.map(({ phase, system }) => misfit(phase, system));
  const start = errors.reduce((best, error, place) => (error < errors[best] ? place : best), 0);
  const figure = el('figure');
  const stepper = phaseStepper('Phase shown with its transition point', (place) => {
    const { phase, system } = known[place];
    figure.replaceChildren(...systemFigure(phase, system, chartWidth(figure)));
  });
  body.replaceChildren(el('div', { class: 'controls' }, stepper.node), figure);
  stepper.restart(known.length, start);
  return stepper.redraw;
}
