// ---------------------------------------------------------------- reliability of predictive bands

const RELIABILITY = { most: 520, shape: 0.8, radius: 4 };

function reliabilityFrame(bands, width) {
  const values = bands.flatMap(({ levels }) => levels.flatMap(({ level, inside }) => [level, inside]));
  const low = Math.max(0, Math.floor(Math.min(...values) / 10) * 10 - 5);
  const axis = (unit) => ({ low, high: 100, unit });
  return chartFrame(width, Math.round(width * RELIABILITY.shape) + 20, axis('nominal level, %'), axis('measured inside, %'));
}

function reliabilityLine({ name, levels }, colour, shape, frame) {
  const points = sortRows(levels, ({ level }) => level, false).map(({ level, inside }) => [level, inside]);
  const marks = points.map(([level, inside]) => {
    const title = svg('title', {}, `${name}: ${quantity(inside, 1, '%')} inside the ${quantity(level, 0, '%')} band`);
    const mark = markerNode(shape, [[frame.x(level), frame.y(inside)]], RELIABILITY.radius, colour);
    mark.append(title);
    return mark;
  });
  return [lineNode(points, frame, { colour }), ...marks];
}

function reliabilityPicture(report, width) {
  const { bands } = report;
  const frame = reliabilityFrame(bands, width);
  const { low } = frame.range.x;
  const told = bands.map(({ name, levels }) => {
    const pairs = levels.map(({ level, inside }) => `${quantity(inside, 1, '%')} in the ${quantity(level, 0, '%')} band`);
    return `${name}: ${pairs.join(', ')}`;
  });
  const shape = (index) => SHAPES[index % SHAPES.length];
  const lines = bands.map((band, index) => reliabilityLine(band, colourOf(report, band.name), shape(index), frame));
  return picture(frame, `Measured share against nominal level. ${told.join('; ')}.`, [
    ...frame.axes,
    lineNode([[low, low], [100, 100]], frame, { colour: '--quiet', kind: 'dashed', width: 1.25 }),
    ...lines.flat(),
  ]);
}

const SHAPE_SIGNS = { circle: '●', square: '■', up: '▲', diamond: '◆', down: '▼' };

function reliabilityLegend(report) {
  const sign = (name, index) => {
    const shape = SHAPE_SIGNS[SHAPES[index % SHAPES.length]];
    return coloured(el('span', { 'aria-hidden': 'true' }, `${shape} `), 'color', colourOf(report, name));
  };
  const models = report.bands.map(({ name }, index) => [sign(name, index), name]);
  return legendOf([...models, [strokeSample('--quiet', 'dashed'), 'as many inside as claimed']]);
}

function reliabilityTable(report, label) {
  const rows = report.bands.flatMap(({ name, levels }) => levels.map((level) => ({ name, ...level })));
  const columns = [
    { label: 'Model', value: ({ name }) => name },
    { label: 'Level', unit: '%', value: ({ level }) => level, digits: 0 },
    { label: 'Inside', unit: '%', value: ({ inside }) => inside, digits: 1 },
    { label: 'Less nominal', unit: 'points', value: ({ inside, level }) => inside - level, digits: 1 },
    { label: 'Mean width', unit: 'km/h', value: ({ width }) => width, digits: 2 },
  ];
  const groups = sortRows([...new Set(rows.flatMap((row) => Object.keys(row.groups)))], (group) => group, false);
  const byGroup = groups.map((group) => ({ label: group, unit: '%', value: ({ groups: of }) => number(member(of, group)), digits: 1 }));
  const more = () => sortableTable(`${label} by speed group`, [...columns.slice(0, 2), ...byGroup], rows);
  const table = sortableTable(label, columns, rows);
  return groups.length === 0 ? [table] : [table, collapsible('Share inside by speed group', plural(groups.length, 'group'), more)];
}

/** Fills a node with diagram and table; gives what draws it anew. */
function reliability(node, report, label) {
  if (report.bands.length === 0) {
    node.replaceChildren(note('This evaluation has no predictive bands (bands).'));
    return () => {};
  }
  const figure = el('figure');
  const draw = () => {
    const width = chartWidth(figure, RELIABILITY.most);
    figure.replaceChildren(reliabilityPicture(report, width), reliabilityLegend(report));
  };
  node.replaceChildren(el('div', { class: 'pair' }, figure, el('div', { class: 'part' }, ...reliabilityTable(report, label))));
  draw();
  return draw;
}

function bandReliability(report) {
  byId('bands-nominal').classList.toggle('absent', report.bands.length === 0);
  return reliability(byId('bands-reliability'), report, 'Predictive bands');
}
