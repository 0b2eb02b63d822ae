// ---------------------------------------------------------------- squared errors of both methods

const SQUARES = { unit: '(km/h)²', digits: 0, bins: 40 };

/** The sum of squared errors over a phase in (km/h)². */
function squaredErrors(phase, name) {
  const rmse = kmh(prediction(phase, name).rmse_mps);
  return phase.measured.length > 1 ? phase.measured.length * rmse * rmse : NaN;
}

/** Phases that both methods predicted, with the sum of squared errors of each. */
function contested(report) {
  const entries = report.phases.map((phase) => ({ phase, squares: METHODS.map((name) => squaredErrors(phase, name)) }));
  return entries.filter(({ phase, squares }) => squares.every(Number.isFinite) && phase.stepS > 0);
}

/** The phase that both methods predict best: the larger of its errors is the least among those not shorter than the median. */
function wellPredicted(entries) {
  const usual = medianOf(entries.map(({ phase }) => phase.durationS));
  const long = entries.filter(({ phase }) => phase.durationS >= usual);
  return sortRows(long, ({ squares }) => Math.max(...squares), false)[0];
}

/** The phase that neither predicts: the smaller of its errors is the largest. */
const badlyPredicted = (entries) => sortRows(entries, ({ squares }) => Math.min(...squares), true)[0];

function methodsFigure(report, { phase, squares }, width) {
  const kinds = ['solid', 'dashed'];
  const lines = [
    { name: 'measured', colour: '--measured', width: 2, values: phase.measured },
    ...METHODS.map((name, index) => {
      const look = { colour: colourOf(report, name), kind: kinds[index], width: 2 };
      return { name, ...look, values: predictedCurve(phase, name) };
    }),
  ];
  const told = METHODS.map((name, index) => `${name} ${quantity(squares[index], SQUARES.digits, SQUARES.unit)}`).join(', ');
  const caption = `${phaseName(phase)}. Sum of squared errors: ${told}.`;
  const chart = timeChart({
    label: `Measured speed of a phase and that of both methods. ${caption}`,
    ...{ width, timeS: timesOf(phase), lines, unit: 'km/h', digits: 1, along: 's since the phase began' },
  });
  return [chart, lineLegend(lines), el('figcaption', {}, caption)];
}

/** Bins from 0 that hold nine phases of ten and both means. */
function squareBins(rows) {
  const sorted = Float64Array.from(rows.flatMap(({ values }) => values)).sort();
  const most = Math.max(quantile(sorted, 0.9), ...rows.map(({ values }) => mean(values)));
  const width = niceStep(most || 1, SQUARES.bins);
  return { low: 0, width, count: Math.max(Math.ceil(most / width - 1e-9), 1) };
}

/** Figure 3.17. */
function squaresFigure(report, entries, width) {
  const spec = {
    title: 'Sum of squared errors per phase',
    axis: `SSE of a phase, ${SQUARES.unit}`,
    caption: `Sums over the samples of a phase; ${plural(entries.length, 'phase')} that both methods predict.`,
    median: true,
    ...{ unit: SQUARES.unit, digits: SQUARES.digits },
  };
  const rows = METHODS.map((name, index) => ({
    name,
    colour: colourOf(report, name),
    values: entries.map(({ squares }) => squares[index]),
  }));
  const bins = squareBins(rows);
  const tallies = rows.map((row) => countBins(row.values, bins));
  return [histogram(spec, rows, bins, tallies, width), el('figcaption', {}, histogramCaption(spec, rows, bins, tallies))];
}

/** Figures 3.15 to 3.17; gives what draws them anew. */
function methodFigures(report) {
  const entries = contested(report);
  const bodies = ['well', 'badly', 'squares'].map((part) => byId(`systems-${part}`));
  if (entries.length === 0) {
    bodies.forEach((body) => body.replaceChildren(note(`No phase was predicted by ${METHODS.join(' and ')}.`)));
    return () => {};
  }
  const [well, badly, squares] = bodies.map((body) => {
    const figure = el('figure');
    body.replaceChildren(figure);
    return figure;
  });
  const draw = () => {
    well.replaceChildren(...methodsFigure(report, wellPredicted(entries), chartWidth(well)));
    badly.replaceChildren(...methodsFigure(report, badlyPredicted(entries), chartWidth(badly)));
    squares.replaceChildren(...squaresFigure(report, entries, chartWidth(squares)));
  };
  draw();
  return draw;
}

// ---------------------------------------------------------------- groups

function systemTable(groups) {
  const count = (label, key) => ({ label, value: (row) => row[key] });
  const columns = [count('Used', 'used'), count('Other form', 'other'), count('Not identified', 'lost')];
  const cells = (row) => columns.map(({ value }) => el('td', {}, fixed(value(row), 0)));
  const thrown = (row) => el('td', {}, quantity((100 * (row.other + row.lost)) / (row.used + row.other + row.lost), 1, '%'));
  const row = (one) =>
    el('tr', {}, el('th', { scope: 'row' }, one.name), el('td', { class: 'text' }, one.response), ...cells(one), thrown(one));
  const total = (key) => groups.reduce((sum, group) => sum + (group[key] || 0), 0);
  const sum = { name: 'All groups', response: '', used: total('used'), other: total('other'), lost: total('lost') };
  const names = columns.map(({ label }) => heading(label));
  const head = el('tr', {}, heading('Group', 'text corner'), heading('Response', 'text'), ...names, heading('Thrown away'));
  const bodies = [el('tbody', {}, ...groups.map(row)), el('tbody', { class: 'baselines' }, row(sum))];
  const all = sum.used + sum.other + sum.lost;
  const away = sum.other + sum.lost;
  const thrownAway = `${fixed(away, 0)} of ${plural(all, 'phase')} are thrown away (${quantity((100 * away) / all, 1, '%')})`;
  const why = `${fixed(sum.other, 0)} of another form than their group, ${fixed(sum.lost, 0)} not identified`;
  return [tableBox('Identified systems by speed group', [head], bodies), note(`${thrownAway}: ${why}.`)];
}

function systemSection(report) {
  const { systems } = report;
  const methods = METHODS.every((name) => namesOf(report).includes(name));
  if (Object.keys(systems).length === 0 && !methods) {
    byId('systems-parts').hidden = true;
    return absent('systems', 'This evaluation has no identified systems (system_identification).');
  }
  const groups = list(systems.groups).map(object).map((raw) => ({
    name: text(raw.group),
    response: responseText(readResponse(raw.response)),
    ...{ used: number(raw.used), other: number(raw.other_form), lost: number(raw.unidentified) },
  }));
  const table = groups.length > 0 ? systemTable(groups) : [note('This evaluation has no groups of systems.')];
  byId('systems-body').append(...table);
  const draws = [transitionFigure(report), methodFigures(report)];
  return () => draws.forEach((draw) => draw());
}
