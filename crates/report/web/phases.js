// ---------------------------------------------------------------- one phase over time

const timesOf = ({ measured, stepS }) => Array.from(measured, (_, index) => index * stepS);

const zipped = (places, values) => places.map((place, index) => [place, number(values[index])]);

/** Lines over time with their values under the pointer. `under` and `over` draw behind and in front, given the frame; `also`
 * has further values that the upright axis must show. */
function timeChart({ label, width, timeS, lines, unit, digits, along, also = [], under = () => [], over = () => [], remarks = () => [] }) {
  const y = { ...rangeOf([...lines.flatMap(({ values }) => Array.from(values)), ...also]), unit };
  const x = { low: timeS[0] ?? 0, high: timeS[timeS.length - 1] || 1, unit: along };
  const frame = chartFrame(width, Math.min(360, Math.max(260, Math.round(width * 0.45))), x, y);
  const drawn = lines.map((line) => lineNode(zipped(timeS, line.values), frame, line));
  const nodes = [...frame.axes, ...under(frame), ...drawn, ...over(frame)];
  return hoverable(frame, picture(frame, label, nodes), (time) => {
    const index = nearestIndex(timeS, time);
    const told = lines.map((line) => `${line.name} ${quantity(number(line.values[index]), digits, unit)}`);
    return [quantity(timeS[index], 1, 's'), [...told, ...remarks(index)]];
  });
}

function phaseName(phase) {
  const group = phase.group === '' ? '' : `, ${phase.group}\u00a0km/h`;
  return `${phase.trip || 'Trip not named'} from ${clock(phase.startS)}\u00a0min, ${quantity(phase.durationS, 1, 's')}${group}`;
}

/** Steps through phases, a place in the list at a time or to a number; `show(place)` draws one. */
function phaseStepper(label, show) {
  const input = el('input', { type: 'number', min: 1, step: 1, autocomplete: 'off', inputmode: 'numeric' });
  const total = el('span', {});
  const state = { at: 0, count: 1 };
  const go = (wanted) => {
    state.at = ((Math.round(wanted) % state.count) + state.count) % state.count;
    input.value = state.at + 1;
    show(state.at);
  };
  input.addEventListener('change', () => {
    const wanted = Number(input.value);
    go(Number.isFinite(wanted) ? Math.min(Math.max(wanted, 1), state.count) - 1 : state.at);
  });
  const buttons = toolbar(label, [
    ['← Previous', 'Previous phase', () => go(state.at - 1)],
    ['Next →', 'Next phase', () => go(state.at + 1)],
  ]);
  buttons.append(el('label', { class: 'stepped' }, el('span', {}, 'Phase'), input, total));
  const restart = (count, at) => {
    Object.assign(state, { count: Math.max(count, 1) });
    input.max = state.count;
    total.replaceChildren(`of ${fixed(count, 0)}`);
    go(at);
  };
  return { node: buttons, restart, place: () => state.at, redraw: () => show(state.at) };
}
