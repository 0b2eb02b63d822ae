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

/** The axis of speed: from 0 to the fastest, and as far as a prediction goes that has not run away. */
function speedAxis(measured, predicted) {
  const top = Math.max(...measured.filter((values) => values.length > 0).map((values) => extent(values).high)) || 1;
  const reached = extent(predicted);
  const astray = reached.low < REACH.low * top || reached.high > REACH.high * top;
  const low = astray ? CUT.low * top : Math.min(0, reached.low);
  return { low, high: astray ? CUT.high * top : 1.05 * Math.max(top, reached.high), unit: 'km/h' };
}
