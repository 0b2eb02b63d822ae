// ---------------------------------------------------------------- parameters

const INTERVAL = { width: 190, height: 22, margin: 6 };

/** Decimals that show a value as exactly as it is known: to two digits of its standard error, otherwise to four of its own. */
function decimals({ value, stdError }) {
  const [size, count] = stdError > 0 ? [stdError, 2] : [Math.abs(value), 4];
  const digits = count - 1 - Math.floor(Math.log10(size));
  return Number.isFinite(digits) ? Math.min(Math.max(digits, 0), 8) : 2;
}

/** A number that a person wrote, with the decimals that it has. */
function written(value) {
  const rounded = Number(value.toPrecision(6));
  const digits = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].find((count) => Number(value.toFixed(count)) === rounded);
  return fixed(value, digits ?? 9);
}

const shorten = (name, count) => (name.length > count ? `${name.slice(0, Math.max(Math.floor(count) - 1, 1))}…` : name);

/** The interval between the bounds: a band for the interval, a dot for the value, a short line for the start. */
function intervalPicture({ key, start, value, bounds, interval, identified }) {
  const [lower, upper] = bounds;
  const known = [start, value, ...(interval ?? [])].filter(Number.isFinite);
  if (known.length === 0) return '–';
  const [low, high] = upper > lower ? bounds : [Math.min(...known), Math.max(...known)];
  const middle = INTERVAL.height / 2;
  const scale = linear(low, high, INTERVAL.margin, INTERVAL.width - INTERVAL.margin);
  const x = (position) => scale(Math.min(Math.max(position, low), high));
  const kind = identified ? '' : ' unsure';
  const line = (from, to, y, name) => svg('line', { class: name, x1: from, x2: to, y1: middle - y, y2: middle + y });
  const parts = [line(x(low), x(high), 0, 'cut'), line(x(low), x(low), 4, 'cut'), line(x(high), x(high), 4, 'cut')];
  if (interval) {
    const [from, to] = interval.map(x);
    parts.push(svg('rect', { class: `range${kind}`, x: from, y: middle - 4, width: Math.max(to - from, 2), height: 8, rx: 2 }));
  }
  if (Number.isFinite(start)) parts.push(line(x(start), x(start), 7, 'mean'));
  if (Number.isFinite(value)) parts.push(svg('circle', { class: `dot${kind}`, cx: x(value), cy: middle, r: 4 }));
  const size = { width: INTERVAL.width, height: INTERVAL.height, viewBox: `0 0 ${INTERVAL.width} ${INTERVAL.height}` };
  return svg('svg', { ...size, role: 'img', 'aria-label': `${key} between its bounds` }, ...parts);
}

const verdictNode = ({ identified }) => (identified ? 'identified' : el('span', { class: 'unsure' }, 'not identified'));

function parameterRow(parameter) {
  const { key, unit, start, value, bounds, stdError, interval } = parameter;
  const digits = decimals(parameter);
  const change = start === 0 ? NaN : 100 * ((value - start) / Math.abs(start));
  return el(
    'tr',
    {},
    el('th', { scope: 'row' }, key, el('small', {}, unit === '1' ? '' : unit)),
    el('td', {}, written(start)),
    el('td', {}, fixed(value, digits)),
    el('td', {}, signed(change, 1)),
    el('td', {}, fixed(stdError, digits)),
    el('td', {}, interval ? interval.map((end) => fixed(end, digits)).join(' to ') : '–'),
    el('td', { class: 'drawn' }, intervalPicture(parameter)),
    el('td', {}, bounds.some(Number.isFinite) ? bounds.map(written).join(' to ') : '–'),
    el('td', { class: 'text' }, verdictNode(parameter)),
    el('td', { class: 'text wrap' }, parameter.remark || '–'),
  );
}

function parameterTable(parameters) {
  const numbers = ['Start', 'Value', 'Change, %', 'Std. error', '95 % interval'].map((label) => heading(label));
  const head = [heading('Parameter', 'text corner'), ...numbers, heading('Within its bounds', 'text drawn'), heading('Bounds')];
  const body = el('tbody', {}, ...parameters.map(parameterRow));
  return tableBox('Parameters', [el('tr', {}, ...head, heading('Verdict', 'text'), heading('Remark', 'text'))], [body]);
}

function parameterSection({ parameters }) {
  if (parameters.length === 0) {
    byId('parameters-body').append(note('The document has no parameters.'));
    return;
  }
  byId('parameters-remark').append(
    'The picture spans the bounds of the fit: the dot is the value, the band its 95\u00a0% interval, the upright line the start. One that is ',
    el('span', { class: 'unsure' }, 'not identified'),
    ' is not known from these trips; its value is not to be quoted.',
  );
  byId('parameters-body').append(parameterTable(parameters));
}

// ---------------------------------------------------------------- sensitivity

const BARS = { pitch: 38, text: 14, bar: 10 };

function sensitivityBars(parameters, width) {
  const most = Math.max(...parameters.map((parameter) => Math.abs(parameter.sensitivity)));
  const x = linear(0, most, 0, width);
  const height = parameters.length * BARS.pitch;
  const row = ({ key, sensitivity, identified }, index) => {
    const y = index * BARS.pitch;
    const kind = identified ? 'dot' : 'dot unsure';
    const remark = identified ? '' : ', not identified';
    const length = Math.max(x(Math.abs(sensitivity)), 1);
    return [
      svg('text', { class: 'name', x: 0, y: y + BARS.text }, shorten(key, (width - 90) / 7 - remark.length) + remark),
      svg('text', { x: width, y: y + BARS.text, 'text-anchor': 'end' }, quantity(Math.abs(sensitivity), 1, 'W')),
      svg('rect', { class: kind, x: 0, y: y + BARS.text + 6, width: length, height: BARS.bar }),
    ];
  };
  const label = `Sensitivity. ${parameters.map((one) => `${one.key} ${quantity(one.sensitivity, 1, 'W')}`).join('; ')}.`;
  const size = { viewBox: `0 0 ${width} ${height}`, width, height };
  return svg('svg', { ...size, role: 'img', 'aria-label': label }, ...parameters.flatMap(row));
}

function drawSensitivity({ parameters }) {
  const body = byId('sensitivity-body');
  const known = parameters.filter((parameter) => Number.isFinite(parameter.sensitivity));
  if (known.length === 0) return body.replaceChildren(note('The document has no sensitivities.'));
  const ranked = sortRows(known, (parameter) => Math.abs(parameter.sensitivity), true);
  const width = Math.min(Math.max(Math.floor(body.clientWidth), 260), 720);
  const caption = 'Root mean square of the change of power over all trips.';
  return body.replaceChildren(el('figure', {}, sensitivityBars(ranked, width), el('figcaption', {}, caption)));
}

// ---------------------------------------------------------------- correlation

const HEAT = { cell: 46, height: 30, top: 24, inseparable: 0.95 };

function inseparablePairs({ keys, matrix }) {
  return keys.flatMap((key, row) =>
    keys.slice(0, row).flatMap((other, column) => {
      const rho = number(list(matrix[row])[column]);
      return Math.abs(rho) >= HEAT.inseparable ? [{ key, other, rho }] : [];
    }),
  );
}

function correlationSentence(pairs) {
  if (pairs.length === 0) return 'No two parameters are tied so closely (|ρ| ≥ 0.95) that the data cannot tell them apart.';
  const named = pairs.map(({ key, other, rho }) => `${other} and ${key} (ρ\u00a0=\u00a0${fixed(rho, 2)})`).join(', ');
  return `The data cannot tell apart ${named}: one makes up for the other, so that only their combination is known.`;
}

function heatCell(rho, x, y, title, diagonal) {
  const close = !diagonal && Math.abs(rho) >= HEAT.inseparable;
  const box = { x: x + 1, y: y + 1, width: HEAT.cell - 2, height: HEAT.height - 2 };
  const cell = svg('rect', { ...box, class: close ? 'cell close' : 'cell' });
  const strength = diagonal || Number.isNaN(rho) ? 0 : Math.min(Math.abs(rho), 1) * 0.65;
  cell.style.fill = rho < 0 ? 'var(--series-1)' : 'var(--series-0)';
  cell.style.fillOpacity = strength.toFixed(3);
  const place = { x: x + HEAT.cell / 2, y: y + HEAT.height / 2 + 4, 'text-anchor': 'middle' };
  const shown = svg('text', { class: diagonal ? '' : 'value', ...place }, diagonal ? '1' : fixed(rho, 2));
  return svg('g', {}, svg('title', {}, title), cell, shown);
}

/** Columns bear the numbers of the rows. */
function heatMap({ keys, matrix }) {
  const left = 34 + 7 * Math.max(...keys.map((key) => key.length));
  const [width, height] = [left + keys.length * HEAT.cell, HEAT.top + keys.length * HEAT.height];
  const row = (key, index) => {
    const y = HEAT.top + index * HEAT.height;
    const middle = y + HEAT.height / 2 + 4;
    const cells = keys.map((other, column) => {
      const rho = number(list(matrix[index])[column]);
      return heatCell(rho, left + column * HEAT.cell, y, `${key} and ${other}: ${fixed(rho, 3)}`, index === column);
    });
    const order = svg('text', { x: 16, y: middle, 'text-anchor': 'end' }, fixed(index + 1, 0));
    return [order, svg('text', { class: 'name', x: 24, y: middle }, key), ...cells];
  };
  const column = (_, index) =>
    svg('text', { x: left + (index + 0.5) * HEAT.cell, y: HEAT.top - 8, 'text-anchor': 'middle' }, fixed(index + 1, 0));
  const size = { viewBox: `0 0 ${width} ${height}`, width, height };
  const label = { role: 'img', 'aria-label': 'Correlation matrix of the parameters' };
  return svg('svg', { ...size, ...label }, ...keys.map(column), ...keys.flatMap(row));
}

function correlationSection({ correlation }) {
  if (correlation.keys.length === 0) {
    byId('correlation-body').append(note('The document has no correlations.'));
    return;
  }
  byId('correlation-remark').append(correlationSentence(inseparablePairs(correlation)));
  const label = 'Correlation of the parameters';
  byId('correlation-body').append(
    el('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': label }, heatMap(correlation)),
    note('Blue where two rise together, orange where one falls as the other rises. The columns bear the numbers of the rows.'),
  );
}
