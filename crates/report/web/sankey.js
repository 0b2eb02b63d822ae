// ---------------------------------------------------------------- picture of the energy flow

const FLOW = { title: 20, gap: 5, node: 8, line: 15, largest: 220 };
const PART_NAMES = { battery: 'Battery', drive: 'Motor and gear', wheels: 'Wheels' };

/** The columns of the parts, and pixels per joule, such that the tallest part has `FLOW.largest`. */
function flowFrame(flow, width) {
  const narrow = width < 620;
  const right = width - (narrow ? 106 : 160);
  const links = Object.values(flow.links).map((pair) => sumOf(pair.map((link) => link.energyJ)));
  return {
    narrow,
    right,
    slot: (narrow ? 3 : 2) * FLOW.line + 4,
    columns: { battery: 0, drive: right * (narrow ? 0.48 : 0.38), wheels: right * (narrow ? 0.84 : 0.76) },
    perJoule: FLOW.largest / (Math.max(flow.totalJ, ...links) || 1),
  };
}

/** Heights at the right-hand ends, part by part, and of the parts, each of which begins at the height of its first use. */
function rightEnds(flow, frame) {
  const [ends, tops] = [new Map(), {}];
  let y = 0;
  const place = (use) => {
    const height = use.energyJ * frame.perJoule;
    const slot = Math.max(height, frame.slot);
    ends.set(use, y + (slot - height) / 2);
    y += slot + FLOW.gap;
  };
  for (const part of PARTS) {
    y += FLOW.title;
    const uses = flow.uses.filter((use) => use.part === part);
    const start = y;
    uses.forEach(place);
    tops[part] = ends.get(uses[0]) ?? start;
  }
  return { ends, tops, bottom: y };
}

/**
 * All bands, and how far each part reaches. At the right of a part there are, from above, its uses, what comes in from outside,
 * the band to the next part, and the band back from it.
 */
function flowLayout(flow, width) {
  const frame = flowFrame(flow, width);
  const { ends, tops, bottom } = rightEnds(flow, frame);
  const spans = PARTS.map((part) => ({ part, x: frame.columns[part], top: tops[part], bottom: tops[part] + 1 }));
  const bands = [];
  spans.forEach((span, index) => {
    const x0 = span.x + FLOW.node;
    const next = spans[index + 1];
    let y = span.top;
    const add = (item, x1, y1) => {
      const height = item.energyJ * frame.perJoule;
      bands.push({ item, x0, y0: y, x1, y1, height, inner: x1 !== frame.right });
      y += height;
    };
    flow.uses.filter((use) => use.part === span.part).forEach((use) => add(use, frame.right, ends.get(use)));
    let landing = next?.top;
    for (const link of next ? flow.links[span.part] : []) {
      add(link, next.x, landing);
      const room = labelRoom(bands[bands.length - 1], frame);
      landing += link.energyJ * frame.perJoule;
      next.bottom = Math.max(next.bottom, landing);
      landing += room;
      if (!link.inward) y += room;
    }
    span.bottom = Math.max(span.bottom, y);
  });
  const lowest = bands.map((band) => band.y1 + band.height + (band.inner ? labelRoom(band, frame) : 0));
  return { frame, spans, bands, height: Math.ceil(Math.max(bottom, ...lowest) + 2) };
}

const innerLines = (frame) => (frame.narrow ? 3 : 2);
const holdsLabel = (band, frame) => band.height > innerLines(frame) * FLOW.line + 4;

/** The room under a band between two parts: a little, or enough for its label where that is too tall for the band. */
const labelRoom = (band, frame) => (holdsLabel(band, frame) ? 12 : innerLines(frame) * FLOW.line + 12);

function bandShape({ x0, y0, x1, y1, height }) {
  const middle = (x0 + x1) / 2;
  const drawn = Math.max(height, 1);
  const there = `C${middle},${y0} ${middle},${y1} ${x1},${y1}`;
  const back = `C${middle},${y1 + drawn} ${middle},${y0 + drawn} ${x0},${y0 + drawn}`;
  return `M${x0},${y0} ${there} V${y1 + drawn} ${back} Z`;
}

function bandNode(band, title) {
  const node = svg('path', { class: 'band', d: bandShape(band) }, svg('title', {}, title));
  node.style.fill = band.item.inward ? 'var(--series-2)' : `var(${band.item.colour ?? '--series-0'})`;
  return node;
}

/** The label at the right-hand end of a band: within or under it between two parts, otherwise beside it. */
function bandLabel(band, lines, frame) {
  const tall = lines.length * FLOW.line;
  const middle = band.y1 + band.height / 2 - tall / 2;
  const under = band.y1 + band.height + 3;
  const top = band.inner && !holdsLabel(band, frame) ? under : middle;
  const [x, anchor] = band.inner ? [band.x1 - (frame.narrow ? 3 : 6), 'end'] : [band.x1 + 6, 'start'];
  return lines.map((line, index) =>
    svg('text', { class: index === 0 ? 'name' : 'amount', x, y: top + (index + 0.8) * FLOW.line, 'text-anchor': anchor }, line),
  );
}

function partNodes({ part, x, top, bottom }, remark) {
  const node = svg('rect', { class: 'part', x, y: top, width: FLOW.node, height: bottom - top });
  const amount = svg('tspan', { class: 'amount', dx: 8 }, remark);
  return [node, svg('text', { class: 'name', x, y: top - 7 }, PART_NAMES[part], amount)];
}

function flowPicture(entry, unit, width) {
  const flow = energyFlow(entry);
  const { frame, spans, bands, height } = flowLayout(flow, width);
  const value = (energyJ) => quantity(unit.of(energyJ, entry), unit.digits(entry), unit.label);
  const share = (energyJ) => quantity(percentOf(energyJ, flow.totalJ), 1, '%');
  const name = ({ item, inner }) => (item.inward && !inner ? `← ${item.name}` : item.name);
  const amount = ({ energyJ }) => [value(energyJ), share(energyJ)];
  const label = (band) => [name(band), ...(frame.narrow ? amount(band.item) : [amount(band.item).join(' · ')])];
  const told = bands.map((band) => `${name(band)} ${amount(band.item).join(', ')}`);
  const net = flow.cellsJ < 0 ? value(flow.cellsJ) : amount({ energyJ: flow.cellsJ }).join(' · ');
  const size = { viewBox: `0 0 ${width} ${height}`, width, height };
  return svg(
    'svg',
    { ...size, class: frame.narrow ? 'narrow' : '', role: 'img', 'aria-label': `Energy flow. ${told.join('; ')}.` },
    ...bands.filter(({ item }) => item.energyJ > 0).map((band) => bandNode(band, told[bands.indexOf(band)])),
    ...spans.flatMap((span) => partNodes(span, span.part === 'battery' ? `net ${net}` : '')),
    ...bands.flatMap((band) => bandLabel(band, label(band), frame)),
  );
}
