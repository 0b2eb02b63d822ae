'use strict';

// What the pages share. A page draws itself from the JSON document inside it: SI units in the document, km/h, kW, kJ and
// kWh on the page. Whatever the document says is inserted as text, never as markup. NaN stands for "not defined"
// throughout.

const TALL_ROWS = 14;
const SVG_NAMESPACE = 'http://www.w3.org/2000/svg';

// ---------------------------------------------------------------- data access

const number = (value) => (typeof value === 'number' && Number.isFinite(value) ? value : NaN);
const text = (value) => (value === undefined || value === null || typeof value === 'object' ? '' : String(value));
const list = (value) => (Array.isArray(value) ? value : []);
const object = (value) => (value !== null && typeof value === 'object' && !Array.isArray(value) ? value : {});
const member = (value, key) => (Object.hasOwn(object(value), key) ? value[key] : undefined);
const kmh = (speedMps) => number(speedMps) * 3.6;
const kilowatts = (powerW) => number(powerW) / 1000;
const kwh = (energyJ) => number(energyJ) / 3.6e6;

/** What every document of drivekit has. */
function readFrame(doc, keys) {
  return {
    schema: text(doc.schema),
    version: text(doc.version),
    missing: keys.filter((key) => doc[key] === undefined || doc[key] === null),
    inputs: list(doc.inputs).map(object),
    config: object(doc.config),
  };
}

// ---------------------------------------------------------------- numbers and elements

/** A number with a fixed count of decimals, a true minus sign and thin spaces between thousands. */
function fixed(value, digits) {
  if (!Number.isFinite(value)) return '–';
  const [whole, fraction] = Math.abs(value).toFixed(digits).split('.');
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, '\u202f') : whole;
  const sign = value < 0 && Number(Math.abs(value).toFixed(digits)) !== 0 ? '\u2212' : '';
  return sign + grouped + (fraction === undefined ? '' : `.${fraction}`);
}

const signed = (value, digits) => (Number(fixed(value, digits).replace(/\u202f/g, '')) > 0 ? '+' : '') + fixed(value, digits);
const quantity = (value, digits, unit) => `${fixed(value, digits)}\u00a0${unit}`;
const significant = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(3))) : '–');
const scientific = (value) => (Number.isFinite(value) ? value.toExponential(1).replaceAll('-', '\u2212') : '–');
const plural = (count, noun) => `${fixed(count, 0)} ${noun}${count === 1 ? '' : 's'}`;

function clock(seconds) {
  if (!Number.isFinite(seconds)) return '–';
  const tenths = Math.round(seconds * 10);
  return `${Math.floor(tenths / 600)}:${((tenths % 600) / 10).toFixed(1).padStart(4, '0')}`;
}

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

function quantile(sorted, share) {
  const position = share * (sorted.length - 1);
  const below = Math.floor(position);
  const above = Math.min(below + 1, sorted.length - 1);
  return sorted[below] + (position - below) * (sorted[above] - sorted[below]);
}

const medianOf = (values) => (values.length > 0 ? quantile(Float64Array.from(values).sort(), 0.5) : NaN);

function build(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

const el = (tag, attributes = {}, ...children) => build(document.createElement(tag), attributes, children);
const svg = (tag, attributes = {}, ...children) => build(document.createElementNS(SVG_NAMESPACE, tag), attributes, children);
const byId = (id) => document.getElementById(id);
const note = (message) => el('p', { class: 'note' }, message);

function swatch(colour) {
  const node = el('span', { class: 'swatch', 'aria-hidden': 'true' });
  node.style.background = `var(${colour})`;
  return node;
}

// ---------------------------------------------------------------- scales and ticks

/** The smallest of 1, 2, 5 times a power of ten that cuts `span` into at most `count` steps. */
function niceStep(span, count) {
  const rough = span / Math.max(count, 1);
  if (!(rough > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const factor = [1, 2, 5, 10].find((candidate) => candidate * power >= rough * (1 - 1e-9));
  return factor * power;
}

const stepDigits = (step) => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));

function ticks(low, high, count) {
  const step = niceStep(high - low, count);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  const digits = stepDigits(step);
  return Array.from({ length: Math.max(last - first + 1, 0) }, (_, index) => {
    const value = (first + index) * step;
    return { value, label: fixed(value, digits) };
  });
}

/** The first index whose time is not before `timeS`. */
function indexAt(times, timeS) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < timeS) low = middle + 1;
    else high = middle;
  }
  return low;
}

const linear = (low, high, from, to) => (value) => from + ((value - low) / (high - low || 1)) * (to - from);
