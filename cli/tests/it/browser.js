'use strict';

// Runs in a page of its own: shows each of `PAGES` at each width, uses its controls, and writes what is wrong into #result.

const WIDTHS_PX = [1280, 360];
const LEAST_TARGET_PX = 24;
const SETTLE_FRAMES = 3;
const HEADINGS = 'h1, h2, h3, h4, h5, h6';
const SHAPES = ':is(path, rect, circle, ellipse, line, polyline, polygon):not(.grid, .axis, .zero)';

const every = (root, selector) => [...root.querySelectorAll(selector)].filter((node) => node.checkVisibility());
const words = (node) => (node?.textContent ?? '').trim();

/** After some frames. Time is virtual and would jump over them to the end if there were nothing else to wait for. */
async function settled() {
  let frames = 0;
  const count = () => {
    frames += 1;
    if (frames < SETTLE_FRAMES) requestAnimationFrame(count);
  };
  requestAnimationFrame(count);
  while (frames < SETTLE_FRAMES) await new Promise((done) => setTimeout(done));
}

function place(node) {
  const kind = node.getAttribute('class');
  const within = node.closest('[id]');
  return `<${node.localName}${kind ? ` class="${kind}"` : ''}> in ${within ? `#${within.id}` : 'the page'}`;
}

/** The name that an element has from its attributes, as a screen reader says it. */
function nameOf(node) {
  const ids = (node.getAttribute('aria-labelledby') ?? '').split(/\s+/).filter((id) => id !== '');
  const referred = ids.map((id) => words(node.ownerDocument.getElementById(id)));
  return (node.getAttribute('aria-label') ?? '').trim() || referred.join(' ').trim();
}

function labelOf(control) {
  const labels = [...(control.labels ?? [])].map((label) => label.cloneNode(true));
  labels.forEach((label) => label.querySelectorAll('select, textarea').forEach((node) => node.remove()));
  return labels.map(words).join(' ').trim();
}

function scrollsInside(node) {
  for (let up = node.parentElement; up !== null && up !== node.ownerDocument.body; up = up.parentElement) {
    if (/auto|scroll/.test(getComputedStyle(up).overflowX)) return true;
  }
  return false;
}

// ---------------------------------------------------------------- checks

function* outline(doc) {
  if (doc.documentElement.lang === '') yield 'the page has no lang';
  for (const [selector, name] of [['main', 'main'], ['h1', 'h1']]) {
    const count = every(doc, selector).length;
    if (count !== 1) yield `${count} elements <${name}> instead of one`;
  }
  let level = 0;
  for (const node of every(doc, HEADINGS)) {
    const next = Number(node.localName[1]);
    if (words(node) === '') yield `empty heading ${place(node)}`;
    if (next > level + 1) yield `heading level ${next} follows ${level}: ${words(node)}`;
    level = next;
  }
  for (const node of every(doc, 'section')) {
    if (!nameOf(node) && !node.querySelector(HEADINGS)) yield `section without heading and name: ${place(node)}`;
  }
  for (const node of every(doc, 'nav, [role="region"], [role="group"]')) {
    if (!nameOf(node)) yield `no name: ${place(node)}`;
  }
  for (const link of every(doc, 'a[href^="#"]')) {
    if (!doc.getElementById(link.hash.slice(1))?.checkVisibility()) yield `link to nothing: ${link.hash}`;
  }
  const ids = [...doc.querySelectorAll('[id]')].map((node) => node.id);
  for (const id of new Set(ids.filter((one, index) => ids.indexOf(one) < index))) yield `id twice: ${id}`;
}

function* tables(doc) {
  for (const table of every(doc, 'table')) {
    if (!nameOf(table) && !words(table.caption)) yield `table without caption and name: ${place(table)}`;
    if (!table.querySelector('th')) yield `table without headings: ${place(table)}`;
    for (const cell of every(table, 'th')) if (words(cell) === '') yield `empty heading cell: ${place(cell)}`;
  }
}

function* controls(doc) {
  const width = doc.documentElement.clientWidth;
  for (const node of every(doc, 'button, input, select, textarea, summary')) {
    const says = /button|summary/.test(node.localName) ? words(node) : labelOf(node);
    if (!nameOf(node) && !says) yield `control without label: ${place(node)}`;
    const box = (node.closest('label') ?? node).getBoundingClientRect();
    if (box.height < LEAST_TARGET_PX) yield `${box.height.toFixed(1)} px high: ${place(node)} ${says}`;
    if (!scrollsInside(node) && (box.left < 0 || box.right > width)) yield `control outside the page: ${place(node)} ${says}`;
  }
}

function* fit(doc) {
  const { scrollWidth, clientWidth } = doc.documentElement;
  if (scrollWidth <= clientWidth) return;
  const beyond = (node) => node.getBoundingClientRect().right > clientWidth + 0.5 && !scrollsInside(node);
  const wide = every(doc.body, '*').filter(beyond).map(place);
  yield `overflow, ${scrollWidth} px wide: ${[...new Set(wide)].slice(0, 5).join(', ')}`;
}

function isDrawn(picture) {
  if (picture.localName === 'svg') {
    return [...picture.querySelectorAll(SHAPES)].map((shape) => shape.getBBox()).some(({ width, height }) => width > 0 || height > 0);
  }
  const { width, height } = picture;
  if (width === 0 || height === 0) return false;
  // Read from a copy: reading the page's own canvas makes the browser complain.
  const copy = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d', { willReadFrequently: true });
  copy.drawImage(picture, 0, 0);
  const pixels = new Uint32Array(copy.getImageData(0, 0, width, height).data.buffer);
  return pixels.some((pixel) => pixel !== pixels[0]);
}

function* clippedText(picture) {
  const frame = picture.getBoundingClientRect();
  for (const node of picture.querySelectorAll('text')) {
    const box = node.getBoundingClientRect();
    const over = Math.max(frame.left - box.left, box.right - frame.right, frame.top - box.top, box.bottom - frame.bottom);
    if (over > 2) yield `text cut off by ${over.toFixed(0)} px: “${words(node)}” in ${place(picture)}`;
  }
}

function* pictures(doc, leastFigures) {
  const meant = (root) => every(root, 'canvas, svg').filter((node) => !node.closest('[aria-hidden="true"], svg svg'));
  for (const picture of meant(doc)) {
    const name = nameOf(picture) || words(picture.querySelector(':scope > title'));
    if (picture.getAttribute('role') !== 'img' || !name) yield `picture without role and name: ${place(picture)}`;
    if (!isDrawn(picture)) yield `not drawn: ${place(picture)} ${name}`;
    yield* clippedText(picture);
  }
  const empty = every(doc, 'figure').filter((figure) => meant(figure).length === 0);
  const count = every(doc, 'figure').length - empty.length;
  if (count < leastFigures) yield `${count} figures instead of ${leastFigures}`;
  for (const figure of empty) if (!figure.querySelector('.note')) yield `figure without picture: ${place(figure)} ${words(figure)}`;
}

function* values(doc) {
  const [found] = (doc.querySelector('main') ?? doc.body).outerHTML.match(/.{0,40}(\bNaN\b|\bundefined\b|\[object ).{0,40}/) ?? [];
  if (found) yield `a value that is none: ${found}`;
  for (const node of every(doc, '#problems')) yield `the page complains: ${words(node)}`;
}

// ---------------------------------------------------------------- use

function useControls(doc) {
  const view = doc.defaultView;
  doc.querySelectorAll('button, input').forEach((node) => node.click());
  for (const select of doc.querySelectorAll('select')) {
    select.selectedIndex = select.options.length - 1;
    select.dispatchEvent(new view.Event('change'));
  }
  for (const plot of doc.querySelectorAll('.plot')) {
    const { left, top, width, height } = plot.getBoundingClientRect();
    const middle = { clientX: left + width / 2, clientY: top + height / 2 };
    plot.dispatchEvent(new view.PointerEvent('pointermove', middle));
    for (const key of ['+', 'ArrowRight', 'n', '0']) plot.dispatchEvent(new view.KeyboardEvent('keydown', { key }));
  }
}

async function problemsOf({ file, figures }, widthPx) {
  const frame = document.createElement('iframe');
  Object.assign(frame.style, { width: `${widthPx}px`, height: '2000px', border: '0' });
  frame.src = file;
  const loaded = new Promise((done) => frame.addEventListener('load', done));
  document.body.append(frame);
  await loaded;
  const doc = frame.contentDocument;
  doc.querySelectorAll('details').forEach((node) => (node.open = true));
  await settled();
  // All of it in the viewport, for what is drawn when it is seen.
  frame.style.height = `${doc.documentElement.scrollHeight}px`;
  await settled();
  const found = [outline, tables, values].flatMap((check) => [...check(doc)]);
  const look = (least) => [...controls(doc), ...fit(doc), ...pictures(doc, least)];
  found.push(...look(figures));
  useControls(doc);
  await settled();
  found.push(...look(0), ...values(doc));
  frame.remove();
  return [...new Set(found)].map((problem) => `${file} at ${widthPx} px: ${problem}`);
}

async function main() {
  const found = [];
  for (const page of PAGES) for (const widthPx of WIDTHS_PX) found.push(...(await problemsOf(page, widthPx)));
  return found;
}

const escaped = (character) => `\\u00${character.charCodeAt(0).toString(16)}`;
main()
  .catch((error) => [`the check itself: ${error.stack}`])
  .then((found) => (document.getElementById('result').textContent = JSON.stringify(found).replace(/[<>&\u00a0]/g, escaped)));
