// ---------------------------------------------------------------- paired differences

const FOREST = { names: 178, pitch: 26, low: 40, top: 8, bottom: 42, mark: 5 };
const VERDICTS = {
  better: { colour: '--series-2', shape: 'left' },
  worse: { colour: '--series-1', shape: 'right' },
};
const UNCLEAR = { colour: '--quiet', shape: 'circle', hollow: true };
const verdictLook = ({ verdict }) => VERDICTS[Object.hasOwn(VERDICTS, verdict) ? verdict : ''] ?? UNCLEAR;

/** The pair the other way round. */
function flipped(pair) {
  const opposite = { better: 'worse', worse: 'better' };
  const { model, against, low, high } = pair;
  return {
    ...pair,
    ...{ model: against, against: model, difference: -pair.difference, low: -high, high: -low, better: pair.worse, worse: pair.better },
    verdict: Object.hasOwn(opposite, pair.verdict) ? opposite[pair.verdict] : pair.verdict,
  };
}

/** All pairs against one model, the best first. */
function pairsAgainst(report, reference) {
  const pairs = report.paired.flatMap((pair) => {
    if (pair.against === reference) return [pair];
    return pair.model === reference ? [flipped(pair)] : [];
  });
  return sortRows(pairs, (pair) => pair.difference, false);
}

const knowledge = (report, name) => text(report.models.find((model) => model.name === name)?.summary.knows);

/** Lines of the forest: those that know what the reference knows first, the others under a heading of their own. */
function forestLines(report, pairs, reference) {
  const known = knowledge(report, reference);
  const alike = pairs.filter((pair) => knowledge(report, pair.model) === known);
  const others = pairs.filter((pair) => !alike.includes(pair));
  if (alike.length === 0 || others.length === 0) return pairs.map((pair) => ({ pair }));
  const title = (words) => ({ title: words });
  return [
    title(`Know the same as ${reference}${known === '' ? '' : ` (${known})`}`),
    ...alike.map((pair) => ({ pair })),
    title('Know something else'),
    ...others.map((pair) => ({ pair })),
  ];
}

const intervalText = ({ difference, low, high }) =>
  `${signed(difference, 2)} (${signed(low, 2)} to ${signed(high, 2)})\u00a0km/h`;

function forestMark(pair, x, y) {
  const look = verdictLook(pair);
  const [low, high] = [pair.low, pair.high].map(x);
  const title = svg('title', {}, `${pair.model}: ${intervalText(pair)}, ${pair.verdict || 'no verdict'}`);
  const line = svg('line', { x1: low, x2: high, y1: y, y2: y, 'stroke-width': 2 });
  const parts = Number.isFinite(low + high) ? [coloured(line, 'stroke', look.colour)] : [];
  return svg('g', {}, title, ...parts, markerNode(look.shape, [[x(pair.difference), y]], FOREST.mark, look.colour, look.hollow));
}

/** A row for each line; the names stand to the left where there is room, otherwise above their intervals. */
function forest(lines, reference, width) {
  const wide = width >= 520;
  const pitch = wide ? FOREST.pitch : FOREST.low;
  const [left, right] = [wide ? FOREST.names : 8, width - 14];
  const bottom = FOREST.top + lines.length * pitch;
  const pairs = lines.flatMap(({ pair }) => (pair ? [pair] : []));
  const { low, high } = rangeOf([0, ...pairs.flatMap((pair) => [pair.difference, pair.low, pair.high])]);
  const x = linear(low, high, left, right);
  const marks = ticks(low, high, Math.max(3, (right - left) / 60));
  const text = (content, at, y, attributes) => svg('text', { x: at, y, ...attributes }, content);
  const row = ({ pair, title }, index) => {
    const y = FOREST.top + index * pitch;
    if (title) return [text(title, 0, y + pitch - 8, { class: 'over' })];
    return [text(pair.model, 0, y + 16, { class: 'amount over' }), forestMark(pair, x, y + (wide ? 12 : 28))];
  };
  const told = pairs.map((pair) => `${pair.model} ${intervalText(pair)}, ${pair.verdict || 'no verdict'}`).join('; ');
  const label = `Difference of mean RMSE against ${reference}, with 95 % intervals. ${told}.`;
  return picture({ width, height: bottom + FOREST.bottom }, label, [
    ...marks.map(({ value }) => gridLine(value, { low }, x(value), x(value), FOREST.top, bottom)),
    ...lines.flatMap(row),
    ...marks.map((mark) => text(mark.label, x(mark.value), bottom + 16, { 'text-anchor': 'middle' })),
    text(`RMSE less that of ${reference}, km/h`, right, bottom + 34, { 'text-anchor': 'end' }),
  ]);
}

function pairTable(report, pairs, label) {
  const { unit = 'trip' } = report;
  const ratio = ({ better, units }) => `${fixed(better, 0)} of ${fixed(units, 0)}`;
  return sortableTable(
    label,
    [
      { label: 'Model', value: (pair) => pair.model },
      { label: 'Knows', value: (pair) => knowledge(report, pair.model) },
      { label: 'Difference', unit: 'km/h', value: (pair) => pair.difference, digits: 3 },
      { label: 'From', unit: 'km/h', value: (pair) => pair.low, digits: 3 },
      { label: 'To', unit: 'km/h', value: (pair) => pair.high, digits: 3 },
      { label: 'Better in', unit: `${unit}s`, value: ratio },
      { label: 'Phases', value: (pair) => pair.phases, digits: 0 },
      { label: 'Verdict', value: (pair) => pair.verdict },
    ],
    pairs,
  );
}

const VERDICT_LEGEND = ['better', 'worse', 'no clear difference'].map((verdict) => ({ verdict, ...verdictLook({ verdict }) }));
const SIGNS = { left: '◀\ufe0e', right: '▶\ufe0e', circle: '○' };

function verdictLegend() {
  const sign = ({ shape, colour }) => coloured(el('span', { 'aria-hidden': 'true' }, SIGNS[shape]), 'color', colour);
  return legendOf(VERDICT_LEGEND.map((look) => [sign(look), ` ${look.verdict}`]));
}

/** Fills a node with the comparison of an evaluation; gives what draws it anew. `what` is in the names of its parts. */
function comparison(node, report, what) {
  const names = inTableOrder(report, report.paired.flatMap(({ model, against }) => [model, against]));
  const choices = names.map((name) => ({ label: name }));
  const candidates = report.models.filter((model) => names.includes(model.name));
  const best = bestOf(candidates.filter((model) => !model.isBaseline)) ?? bestOf(candidates);
  let chosen = choices.find(({ label }) => label === best?.name) ?? choices[0];
  const [figure, table] = [el('figure'), el('div', { class: 'below' })];
  const draw = () => {
    const pairs = pairsAgainst(report, chosen.label);
    const lines = forestLines(report, pairs, chosen.label);
    figure.replaceChildren(forest(lines, chosen.label, chartWidth(figure)), verdictLegend());
  };
  const pick = (choice) => {
    chosen = choice;
    table.replaceChildren(pairTable(report, pairsAgainst(report, choice.label), `${what} against ${choice.label}`));
    draw();
  };
  const controls = el('div', { class: 'controls' }, picklist('Reference', [['Models and baselines', choices]], pick, chosen));
  node.replaceChildren(controls, figure, table);
  pick(chosen);
  return draw;
}

function comparisonSection(report) {
  if (report.paired.length === 0) return absent('comparison', 'This evaluation has no paired comparison (paired).');
  return comparison(byId('comparison-body'), report, 'Paired differences');
}
