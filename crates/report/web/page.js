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

/** A choice of one, the first at first, from `choices` with a `label` each. */
function radios(legend, name, choices, onPick) {
  const chips = choices.map((choice, index) => {
    const input = el('input', { type: 'radio', name, autocomplete: 'off', ...(index === 0 ? { checked: '' } : {}) });
    input.addEventListener('change', () => onPick(choice));
    return el('label', { class: 'chip' }, input, choice.label);
  });
  return el('fieldset', {}, el('legend', {}, legend), ...chips);
}

/** A list to choose one from, `chosen` or the first at first; `groups` are names with their choices, which have a `label` each. */
function picklist(label, groups, onPick, chosen = null) {
  const choices = groups.flatMap(([, members]) => members);
  const option = (choice) => el('option', { value: choices.indexOf(choice) }, choice.label);
  const filled = groups.filter(([, members]) => members.length > 0);
  const nodes = filled.map(([name, members]) => el('optgroup', { label: name }, ...members.map(option)));
  const select = el('select', { autocomplete: 'off' }, ...nodes);
  if (choices.includes(chosen)) select.value = choices.indexOf(chosen);
  select.addEventListener('change', () => onPick(choices[select.value]));
  return el('label', { class: 'picklist' }, el('span', {}, label), select);
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
