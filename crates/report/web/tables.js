// ---------------------------------------------------------------- tables

/** A table in a box of its own that scrolls, also by keyboard, where the table is too wide, or too tall to read past. */
function tableBox(label, head, bodies, tall = false) {
  const table = el('table', { 'aria-label': label }, el('thead', {}, ...head), ...bodies);
  return el('div', { class: tall ? 'scroll tall' : 'scroll', tabindex: '0', role: 'region', 'aria-label': label }, table);
}

const heading = (label, kind = '') => el('th', { scope: 'col', class: kind }, label);

function columnHeading(column, onSort) {
  const button = el('button', { type: 'button' }, el('span', {}, column.label));
  if (column.unit) button.append(el('small', {}, column.unit));
  button.addEventListener('click', onSort);
  return el('th', { scope: 'col' }, button);
}

/** Marks the heading that a table is sorted by, the other way round when it was already; says whether it descends. */
function markSorted(headings, chosen, descendsFirst) {
  const before = chosen.getAttribute('aria-sort');
  const descending = before ? before === 'ascending' : descendsFirst;
  headings.forEach((one) => one.removeAttribute('aria-sort'));
  chosen.setAttribute('aria-sort', descending ? 'descending' : 'ascending');
  return descending;
}

/** Rows in the order of a key, a number or a text; undefined values last. */
function sortRows(rows, key, descending) {
  const direction = descending ? -1 : 1;
  return [...rows].sort((a, b) => {
    const [x, y] = [key(a), key(b)];
    if (Number.isNaN(x) || Number.isNaN(y)) return Number.isNaN(x) - Number.isNaN(y);
    return direction * (typeof x === 'string' ? x.localeCompare(y, 'en', { numeric: true }) : x - y);
  });
}

/** A table that its headings sort, in the order of `rows` at first. Columns without `digits` are text, the first is the name. */
function sortableTable(label, columns, rows) {
  const shown = ({ value, digits }, row) => (digits === undefined ? value(row) || '–' : fixed(value(row), digits));
  const kind = ({ digits, wraps }) => [...(digits === undefined ? ['text'] : []), ...(wraps ? ['wrap'] : [])].join(' ');
  const cell = (column, row) => el('td', { class: kind(column) }, shown(column, row));
  const [name, ...others] = columns;
  const built = rows.map((row) => {
    const cells = others.map((column) => cell(column, row));
    return { row, node: el('tr', {}, el('th', { scope: 'row' }, shown(name, row)), ...cells) };
  });
  const body = el('tbody', {}, ...built.map(({ node }) => node));
  const headings = columns.map((column, index) => {
    const node = columnHeading(column, () => {
      const descending = markSorted(headings, node, false);
      body.append(...sortRows(built, ({ row }) => column.value(row), descending).map((one) => one.node));
    });
    node.className = index === 0 ? 'text corner' : kind(column);
    return node;
  });
  return tableBox(label, [el('tr', {}, ...headings)], [body], rows.length > TALL_ROWS);
}

/** A part that is built when it is first opened. */
function collapsible(title, remark, content) {
  const node = el('details', {}, el('summary', {}, title, el('small', {}, remark)));
  node.addEventListener('toggle', () => {
    if (node.open && node.childElementCount === 1) node.append(content());
  });
  return node;
}

/** A table of text; elements and the last column may wrap. */
function textTable(label, headings, rows) {
  const head = el('tr', {}, ...headings.map((title, index) => heading(title, index === 0 ? 'text corner' : 'text')));
  const body = rows.map(([name, ...cells]) => {
    const wraps = (cell, index) => cell instanceof Node || index === cells.length - 1;
    const nodes = cells.map((cell, index) => el('td', { class: wraps(cell, index) ? 'text wrap' : 'text' }, cell));
    return el('tr', {}, el('th', { scope: 'row' }, name), ...nodes);
  });
  return tableBox(label, [head], [el('tbody', {}, ...body)], rows.length > TALL_ROWS);
}

function findings(report) {
  if (report.inputs.length === 0) return [note('The document lists no inputs.')];
  const affected = report.inputs.filter((input) => list(input.findings).length > 0);
  if (affected.length === 0) return [note(`Nothing was found wrong in ${plural(report.inputs.length, 'input')}.`)];
  const headings = ['Kind', 'Channel', 'From, s', 'To, s', 'Action', 'Detail'];
  const row = (finding) => {
    const times = [fixed(number(finding.from_s), 1), fixed(number(finding.to_s), 1)];
    return [text(finding.kind), text(finding.channel) || '–', ...times, text(finding.action), text(finding.detail)];
  };
  return affected.map((input) => {
    const [path, rows] = [text(input.path), list(input.findings).map(object).map(row)];
    return collapsible(path, plural(rows.length, 'finding'), () => textTable(`Findings in ${path}`, headings, rows));
  });
}

function configuration(report) {
  const flags = Object.entries(report.config);
  if (flags.length === 0) return note('The document has no configuration (config).');
  const row = ([flag, value]) => [flag, el('code', {}, typeof value === 'string' ? value : JSON.stringify(value))];
  return collapsible('Configuration', plural(flags.length, 'setting'), () =>
    textTable('Configuration', ['Flag', 'Value'], flags.map(row)),
  );
}

function inputs(report) {
  if (report.inputs.length === 0) return note('The document lists no inputs (inputs).');
  const headings = ['File', 'Samples', 'Step, s', 'Duration, min', 'SHA-256'];
  const row = (input) => {
    const [samples, stepS] = [number(input.samples), number(input.step_s)];
    const size = [fixed(samples, 0), fixed(stepS, 3), fixed((samples * stepS) / 60, 1)];
    return [text(input.path), ...size, el('code', {}, text(input.sha256) || '–')];
  };
  return collapsible('Inputs', plural(report.inputs.length, 'file'), () => textTable('Inputs', headings, report.inputs.map(row)));
}
