// ---------------------------------------------------------------- page

const fact = (term, value, unit = '') => el('div', {}, el('dt', {}, term), el('dd', {}, value, el('small', {}, unit)));

/** Says what the document lacks, or that it is another one than `schema`. */
function problems(report, schema) {
  const lines = [];
  if (report.missing.length > 0)
    lines.push(`The document lacks: ${report.missing.join(', ')}. The sections that need them are empty.`);
  if (report.schema !== '' && report.schema !== schema)
    lines.push(`The document is “${report.schema}”; this page is made for “${schema}”.`);
  byId('problems').append(...lines.map((line) => el('p', {}, line)));
  byId('problems').hidden = lines.length === 0;
}

function parseDocument() {
  try {
    return JSON.parse(byId('document').textContent);
  } catch {
    return null;
  }
}

/** Follows the width of the page, the colour scheme and printing, none of which a canvas follows by itself. */
function keepDrawn(redraw) {
  let width = 0;
  new ResizeObserver(([entry]) => {
    if (entry.contentRect.width === width) return;
    width = entry.contentRect.width;
    // In a frame of its own: drawing changes the layout that is being observed.
    requestAnimationFrame(redraw);
  }).observe(byId('report'));
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  for (const [event, printing] of [
    ['beforeprint', true],
    ['afterprint', false],
  ]) {
    window.addEventListener(event, () => {
      document.documentElement.classList.toggle('printing', printing);
      redraw();
    });
  }
}
