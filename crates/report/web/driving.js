// ---------------------------------------------------------------- tables of whatever is there

const NAMED_UNITS = {
  mps: { unit: 'km/h', convert: kmh, digits: 2 },
  mps2: { unit: 'm/s²', convert: number, digits: 3 },
  s: { unit: 's', convert: number, digits: 1 },
  m: { unit: 'm', convert: number, digits: 2 },
  pct: { unit: '%', convert: number, digits: 1 },
  j: { unit: 'kJ', convert: kilojoules, digits: 2 },
};
const ABBREVIATIONS = { rmse: 'RMSE', std: 'standard deviation' };

/** What a key of the document says about itself: its words, and the unit that it ends with. */
function namedColumn(key) {
  const words = key.split('_');
  const last = words[words.length - 1];
  const known = words.length > 1 && Object.hasOwn(NAMED_UNITS, last) ? NAMED_UNITS[last] : null;
  const spoken = (known ? words.slice(0, -1) : words).map((word) => (Object.hasOwn(ABBREVIATIONS, word) ? ABBREVIATIONS[word] : word));
  const label = spoken.join(' ').replace(/^[a-z]/, (letter) => letter.toUpperCase());
  return { key, label, unit: known?.unit ?? '', convert: known?.convert ?? number, digits: known?.digits };
}

const isPlain = (value) => value === null || ['number', 'string', 'boolean'].includes(typeof value);
const plainKeys = (sources) => [...new Set(sources.flatMap((raw) => Object.keys(raw).filter((key) => isPlain(raw[key]))))];

/** The digits of a column without a unit: none if it counts. */
function columnDigits({ digits, key }, sources) {
  return digits ?? (sources.every((raw) => !Number.isFinite(number(raw[key])) || Number.isInteger(raw[key])) ? 0 : 3);
}

/** A row for each member of an object, a column for each number or text in it. */
function plainTable(label, first, source) {
  const rows = Object.entries(object(source)).map(([name, raw]) => ({ name, raw: object(raw) }));
  const sources = rows.map(({ raw }) => raw);
  const columns = plainKeys(sources).map(namedColumn).map((column) => {
    const { key, convert } = column;
    if (sources.some((raw) => typeof raw[key] === 'string')) return { ...column, digits: undefined, value: ({ raw }) => text(raw[key]) };
    return { ...column, digits: columnDigits(column, sources), value: ({ raw }) => convert(raw[key]) };
  });
  return sortableTable(label, [{ label: first, value: ({ name }) => name }, ...columns], rows);
}

/** The numbers of an object, a row each. */
function plainList(label, source) {
  const raw = object(source);
  const rows = plainKeys([raw]).map(namedColumn).map((column) => {
    const { key, unit, convert } = column;
    const value = typeof raw[key] === 'number' ? fixed(convert(raw[key]), columnDigits(column, [raw])) : text(raw[key]) || '–';
    return [column.label, value, unit];
  });
  return textTable(label, ['Quantity', 'Value', 'Unit'], rows);
}

// ---------------------------------------------------------------- cruise

const filledObject = (value) => Object.keys(object(value)).length > 0;

function cruiseSection({ cruise }) {
  if (!filledObject(cruise.models) && !filledObject(cruise.parameters))
    return absent('cruise', 'This evaluation has no cruise phases (cruise).');
  const nodes = [
    ...(filledObject(cruise.models) ? [plainTable('Models of cruise phases', 'Model', cruise.models)] : []),
    ...(filledObject(cruise.parameters) ? [el('h3', {}, 'Parameters'), plainList('Parameters of cruise', cruise.parameters)] : []),
  ];
  byId('cruise-body').append(...nodes);
  return () => {};
}

// ---------------------------------------------------------------- following

const FOLLOWERS = { idm: { colour: '--series-0', kind: 'dashed' }, 'constant-time-gap': { colour: '--series-1', kind: 'dotted' } };
const OTHER_FOLLOWER = { colour: '--series-3', kind: 'dashed' };

function readStretch(source) {
  const raw = object(source);
  const predictions = Object.entries(object(raw.predictions)).map(([name, value]) => ({
    name,
    gap: list(object(value).gap_m).map(number),
    rmse: number(object(value).gap_rmse_m),
  }));
  const label = [text(raw.name) || 'Not named', ...(Number.isFinite(number(raw.start_s)) ? [`${clock(raw.start_s)} min`] : [])];
  return { label: label.join(', '), timeS: list(raw.time_s).map(number), gap: list(raw.gap_m).map(number), predictions };
}

function followingFigure({ label, timeS, gap, predictions }, width) {
  const from = timeS.find(Number.isFinite) ?? 0;
  const look = (name) => (Object.hasOwn(FOLLOWERS, name) ? FOLLOWERS[name] : OTHER_FOLLOWER);
  const lines = [
    { name: 'measured', colour: '--measured', width: 2, values: gap },
    ...predictions.map(({ name, gap: values }) => ({ name, ...look(name), width: 2, values })),
  ].filter(({ values }) => values.some(Number.isFinite));
  const told = predictions.map(({ name, rmse }) => `${name}: RMSE of the gap ${quantity(rmse, 2, 'm')}`);
  const caption = `${label}. ${told.join('; ') || 'No predictions'}.`;
  const chart = timeChart({
    label: `Gap to the vehicle in front over time. ${caption}`,
    ...{ width, timeS: timeS.map((time) => time - from), lines, unit: 'm', digits: 1, along: 's since the stretch began' },
    also: [0],
  });
  return [chart, lineLegend(lines), el('figcaption', {}, caption)];
}

function stretchFigure(stretches) {
  const figure = el('figure');
  let shown = stretches[0];
  const draw = () => figure.replaceChildren(...followingFigure(shown, chartWidth(figure)));
  const pick = (stretch) => {
    shown = stretch;
    draw();
  };
  const controls = el('div', { class: 'controls' }, picklist('Stretch', [['Held-out stretches', stretches]], pick));
  byId('following-body').append(controls, figure);
  draw();
  return draw;
}

/** Whatever is paired: a list of pairs, or one. */
function followingPairs(paired) {
  const pairs = (Array.isArray(paired) ? paired : [paired]).filter(filledObject);
  if (pairs.length === 0) return [];
  const label = 'Paired comparison of the models of following';
  const name = (pair, index) => `${text(pair.model) || index + 1}${pair.against ? ` against ${text(pair.against)}` : ''}`;
  const named = Object.fromEntries(pairs.map((pair, index) => [name(pair, index), pair]));
  return [el('h3', {}, 'Comparison'), pairs.length === 1 ? plainList(label, pairs[0]) : plainTable(label, 'Pair', named)];
}

function followingSection({ following }) {
  const stretches = list(following.stretches).map(readStretch).filter(({ timeS, gap }) => timeS.length > 1 && gap.length > 1);
  if (!filledObject(following.models) && stretches.length === 0)
    return absent('following', 'This evaluation has no stretches of following (following).');
  const table = filledObject(following.models) ? [plainTable('Models of following', 'Model', following.models)] : [];
  byId('following-body').append(...table, ...followingPairs(following.paired));
  if (stretches.length === 0) return () => {};
  byId('following-body').append(el('h3', {}, 'One stretch'));
  return stretchFigure(stretches);
}
