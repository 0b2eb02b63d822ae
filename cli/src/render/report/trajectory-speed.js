// ---------------------------------------------------------------- pictures of speed

const MEASURED = { name: 'measured', colour: '--measured', width: 1.75 };
const PREDICTED = { name: 'predicted', colour: '--accent', width: 1.5 };
const LIMIT = { name: 'limit', colour: '--series-4', width: 1.25 };
/** How far a prediction may lead the axis away, and what the axis is when one goes further; in measured ranges. */
const REACH = { low: -1, high: 2 };
const CUT = { low: -0.25, high: 1.4 };

function readDrive(source) {
  const raw = object(source);
  const speed = Float64Array.from(list(raw.speed_mps), kmh);
  const recorded = list(raw.limit_mps).map(kmh);
  const isKnown = recorded.length > 0 && recorded.length === speed.length;
  // As the trials see it.
  const limit = isKnown ? Float64Array.from(recorded, (value, index) => (speed[index] > 0 ? value : 0)) : null;
  const stepS = number(raw.step_s);
  return { name: text(raw.name), stepS, speed, limit, durationS: (speed.length - 1) * stepS };
}

const isDrawable = ({ speed, stepS }) => speed.length > 1 && stepS > 0;

/** At most two points a pixel: the least and the most of each stretch. Where nothing is known there is a gap. */
function thinned(places, values, width) {
  const stride = Math.max(1, Math.floor(values.length / Math.max(2 * width, 1)));
  const points = [];
  for (let start = 0; start < values.length; start += stride) {
    let [least, most] = [-1, -1];
    for (let i = start; i < Math.min(start + stride, values.length); i += 1) {
      if (Number.isNaN(values[i])) continue;
      if (least < 0 || values[i] < values[least]) least = i;
      if (most < 0 || values[i] > values[most]) most = i;
    }
    if (least < 0) points.push([NaN, NaN]);
    else for (const i of new Set(least < most ? [least, most] : [most, least])) points.push([places[i], values[i]]);
  }
  return points;
}

function extent(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return { low, high };
}

/** The axis of speed: from 0 to the fastest, and as far as a prediction goes that has not run away. */
function speedAxis(measured, predicted) {
  const top = Math.max(...measured.filter((values) => values.length > 0).map((values) => extent(values).high)) || 1;
  const reached = extent(predicted);
  const astray = reached.low < REACH.low * top || reached.high > REACH.high * top;
  const low = astray ? CUT.low * top : Math.min(0, reached.low);
  return { low, high: astray ? CUT.high * top : 1.05 * Math.max(top, reached.high), unit: 'km/h' };
}

/** Some lines over places that they share or have of their own; the values beyond the axis lie at its edge. */
function speedPicture({ label, lines, x, y, told }, width) {
  const frame = chartFrame(width, Math.max(220, Math.round(width * 0.3)), x, y);
  const inside = (value) => Math.min(Math.max(value, y.low), y.high);
  const nodes = lines.map((line) => {
    const points = thinned(line.places, line.values, frame.box.right - frame.box.left);
    return lineNode(points.map(([at, value]) => [at, inside(value)]), frame, line);
  });
  return hoverable(frame, picture(frame, label, [...frame.axes, ...nodes]), told);
}

const lineLegend = (lines) => legendOf(lines.map(({ name, colour, kind }) => [strokeSample(colour, kind), name]));
