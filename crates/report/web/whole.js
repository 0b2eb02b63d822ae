// ---------------------------------------------------------------- phases from begin to end

const againstBaseline = (key) => ({ raw }) => kmh(object(raw.against_baseline)[key]);

const WHOLE_COLUMNS = [
  { label: 'Model', value: ({ name }) => name },
  { label: 'Knows', value: ({ raw }) => text(raw.knows) },
  { label: 'RMSE', unit: 'km/h', value: ({ raw }) => kmh(raw.rmse_mps), digits: 2 },
  { label: 'RMSE when cut', unit: 'km/h', value: ({ raw }) => kmh(raw.threshold_rmse_mps), digits: 2 },
  { label: 'In band', unit: '%', value: ({ raw }) => number(raw.in_band_pct), digits: 1 },
  { label: 'In 90 % band', unit: '%', value: ({ raw }) => number(raw.in_90_pct_band_pct), digits: 1 },
  { label: 'Less baseline', unit: 'km/h', value: againstBaseline('difference_rmse_mps'), digits: 2 },
  { label: '95 % from', unit: 'km/h', value: againstBaseline('low_mps'), digits: 2 },
  { label: 'To', unit: 'km/h', value: againstBaseline('high_mps'), digits: 2 },
  { label: 'Verdict', value: ({ raw }) => text(object(raw.against_baseline).verdict) },
];

function wholeKind(name, source) {
  const entries = (table) => Object.entries(object(source[table])).map(([model, raw]) => ({ name: model, raw: object(raw) }));
  const more = `${fixed(number(source.longer_pct), 0)} % longer and with ${fixed(number(source.gains_more_pct), 0)} % more change of speed`;
  const [phases, cut] = [plural(number(source.phases), 'phase'), fixed(number(source.threshold_phases), 0)];
  const words = `${phases}, ${more} than the ${cut} that the threshold cuts. The best baseline is ${text(source.best_baseline)}.`;
  const label = `Phases from begin to end, ${name}`;
  const table = sortableTable(label, WHOLE_COLUMNS, [...entries('models'), ...entries('baselines')]);
  return el('section', {}, el('h3', {}, `${name[0].toUpperCase()}${name.slice(1)}`), el('p', {}, words), table);
}

function wholeSection({ whole }) {
  const kinds = ['acceleration', 'braking'].filter((name) => filledObject(whole[name]));
  if (kinds.length === 0) return absent('whole', 'This evaluation has no phases from begin to end (whole_phases).');
  byId('whole-body').append(...kinds.map((name) => wholeKind(name, object(whole[name]))));
  return () => {};
}
