// ---------------------------------------------------------------- energy flow

const PARTS = ['battery', 'drive', 'wheels'];
const UNITS = [
  { label: 'kWh', of: (energyJ) => kwh(energyJ), digits: (entry) => (Math.abs(kwh(entry.cellsJ)) < 20 ? 3 : 2) },
  { label: 'Wh/km', of: (energyJ, entry) => perKm(energyJ, entry), digits: () => 1 },
];

/** The uses of energy, then what comes in: the terms of the budget that are below zero, by more than rounding. */
function budgetUses(entry) {
  const uses = TERMS.map((term) => {
    const energyJ = number(entry.budget[term.key]) || 0;
    const inward = energyJ < -1;
    const name = inward ? (term.inflow ?? `${term.name}, negative`) : term.name;
    return { ...term, name, inward, energyJ: Math.abs(energyJ) };
  });
  if (entry.undeliveredJ > 0) uses.push({ name: 'Not delivered', part: 'drive', inward: true, energyJ: entry.undeliveredJ });
  return [...uses.filter((use) => !use.inward), ...uses.filter((use) => use.inward)];
}

/**
 * The energy of an entry from part to part, each part passing on what it does not use. What goes back through the wheels is
 * what was braked less the heat of the friction brakes; without it in the document, what came back into the battery.
 */
function energyFlow(entry) {
  const uses = budgetUses(entry);
  const net = (part) => sumOf(uses.filter((use) => use.part === part).map((use) => (use.inward ? -use.energyJ : use.energyJ)));
  const returnedJ = entry.regeneratedJ || 0;
  const brakedJ = entry.brakedJ - Math.max(number(entry.budget.friction_brake_j) || 0, 0);
  const recoveredJ = Math.max(Number.isFinite(brakedJ) ? brakedJ : 0, returnedJ);
  const cellsJ = entry.cellsJ || 0;
  const outJ = Math.max(cellsJ + returnedJ - net('battery'), 0);
  const drivingJ = Math.max(net('wheels') + recoveredJ, 0);
  const inwardJ = sumOf(uses.filter((use) => use.inward).map((use) => use.energyJ));
  return {
    uses,
    cellsJ,
    totalJ: Math.max(cellsJ, 0) + inwardJ,
    links: {
      battery: [
        { name: 'Out →', energyJ: outJ },
        { name: '← Regenerated', energyJ: returnedJ, inward: true },
      ],
      drive: [
        { name: 'Driving →', energyJ: drivingJ },
        { name: '← Braking', energyJ: recoveredJ, inward: true },
      ],
    },
  };
}

// ---------------------------------------------------------------- the same in a table

/** What came in and what it was used for, which are equal, then what went round. */
function flowTable(entry) {
  const flow = energyFlow(entry);
  const cells = (energyJ) => {
    const values = UNITS.map((unit) => fixed(unit.of(energyJ, entry), unit.digits(entry)));
    return [...values, fixed(percentOf(energyJ, flow.totalJ), 1)].map((value) => el('td', {}, value));
  };
  const row = ([name, energyJ]) => el('tr', {}, el('th', { scope: 'row' }, name), ...cells(energyJ));
  const group = (title, rows) =>
    el('tbody', {}, el('tr', {}, el('th', { scope: 'rowgroup', colspan: UNITS.length + 2 }, title)), ...rows.map(row));
  const side = (inward) => flow.uses.filter((use) => use.inward === inward).map((use) => [use.name, use.energyJ]);
  const withSum = (rows) => [...rows, ['Sum', sumOf(rows.map(([, energyJ]) => energyJ))]];
  const charged = flow.cellsJ < 0;
  const cameIn = [...(charged ? [] : [['From the cells, net', flow.cellsJ]]), ...side(true)];
  const wasUsed = [...(charged ? [['Into the cells, net', -flow.cellsJ]] : []), ...side(false)];
  const [out, returned] = flow.links.battery;
  const [driving, braking] = flow.links.drive;
  const passed = [
    ['Out of the battery', out.energyJ],
    ['Motor to wheels', driving.energyJ],
    ['Wheels to motor', braking.energyJ],
    ['Regenerated', returned.energyJ],
  ];
  const head = [heading('Energy', 'text corner'), ...UNITS.map((unit) => heading(unit.label)), heading('Share, %')];
  return tableBox('Energy flow', [el('tr', {}, ...head)], [
    group('Came in', withSum(cameIn)),
    group('Was used', withSum(wasUsed)),
    group('Passed between the parts', passed),
  ]);
}

// ---------------------------------------------------------------- section

function flowCaption(entry) {
  const parts = [`${quantity(entry.distanceM / 1000, 1, 'km')} in ${quantity(entry.durationS / 60, 1, 'min')}`];
  if (Number.isFinite(entry.trips)) parts.unshift(plural(entry.trips, 'trip'));
  if (Number.isFinite(entry.ambientC)) parts.push(`${quantity(entry.ambientC, 1, '°C')} outside`);
  const [start, end] = entry.socPct;
  if (Number.isFinite(start + end)) parts.push(`state of charge by the model from ${fixed(start, 1)} to ${quantity(end, 1, '%')}`);
  const remarks = [`${entryName(entry)}: ${parts.join(', ')}.`];
  if (entry.undeliveredJ > 0) {
    const time = quantity(entry.limitedS, 1, 's');
    remarks.push(`For ${time} the motion asked for more than the car can give; what was not delivered counts as coming in.`);
  }
  if (Number.isNaN(entry.brakedJ))
    remarks.push('Losses from the wheels to the battery are left out: the document does not say what passed the wheels (wheel).');
  return remarks.join(' ');
}

/** Builds the section; gives what draws it anew. */
function flowSection(report) {
  const known = (entry) => TERMS.some((term) => Number.isFinite(number(entry.budget[term.key])));
  const groups = entryGroups(report.totals.filter(known), report.logs.filter(known), severalVehicles(report));
  const first = groups.flatMap(([, members]) => members)[0];
  if (first === undefined) {
    byId('flow-body').append(note('The document has no energy budgets.'));
    return () => {};
  }
  const shown = { entry: first.entry, unit: UNITS[0] };
  const draw = () => {
    const width = Math.min(Math.max(Math.floor(byId('flow-body').clientWidth), 300), 1040);
    const picture = flowPicture(shown.entry, shown.unit, width);
    byId('flow-body').replaceChildren(el('figure', {}, picture, el('figcaption', {}, flowCaption(shown.entry))));
  };
  const pick = ({ entry }) => {
    shown.entry = entry;
    byId('flow-table').replaceChildren(flowTable(entry));
    draw();
  };
  const pickUnit = (unit) => {
    shown.unit = unit;
    draw();
  };
  byId('flow-controls').append(picklist('Shown', groups, pick), radios('Unit', 'flow-unit', UNITS, pickUnit));
  byId('flow-table').append(flowTable(first.entry));
  return draw;
}
