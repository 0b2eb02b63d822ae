// ---------------------------------------------------------------- barriers

/** Where each line is lowest. */
function leastWords(lines, { time }, digits, unit) {
  const words = lines.filter(({ values, isBeside }) => !isBeside && isKnown(values)).map(({ name, values }) => {
    const least = extent(values).low;
    return `${name} ${quantity(least, digits, unit)} at ${quantity(time[values.indexOf(least)], 1, 's')}`;
  });
  return words.length > 0 ? `Least: ${words.join(', ')}.` : '';
}

function barrierFigures(report) {
  const { barrier } = report;
  const headway = robotLines(report, 'h_headway', 1000);
  const lane = robotLines(report, 'h_lane', barrier.scale);
  const clearance = robotLines(report, 'lane_clearance_m', 1000);
  const scale = barrier.words ? ` The barrier is ${barrier.words}.` : '';
  return [
    {
      title: 'Headway',
      ...{ lines: headway, unit: 'mm', digits: 1, nothing: 'No robot has another one ahead.' },
      caption: leastWords(headway, report, 1, 'mm'),
    },
    {
      title: 'Distance to the edge of the lane',
      ...{ lines: clearance, unit: 'mm', digits: 1 },
      caption: leastWords(clearance, report, 1, 'mm'),
    },
    {
      title: 'Lane barrier',
      ...{ lines: lane, unit: barrier.unit, digits: barrier.digits },
      caption: `${leastWords(lane, report, barrier.digits, barrier.unit)}${scale}`,
    },
  ].map((spec) => timeFigure(report, { ...spec, isBound: true }));
}

/** Numbers of figures in words, a run of them by its ends. */
function figureNumbers(numbers) {
  const runs = [];
  for (const name of numbers) {
    const [chapter, place] = name.split('.').map(Number);
    const last = runs.at(-1)?.at(-1);
    if (last && last.chapter === chapter && last.place + 1 === place) runs.at(-1).push({ name, chapter, place });
    else runs.push([{ name, chapter, place }]);
  }
  const words = runs.flatMap((run) => (run.length > 2 ? [`${run[0].name} to ${run.at(-1).name}`] : run.map(({ name }) => name)));
  return words.length > 1 ? `${words.slice(0, -1).join(', ')} and ${words.at(-1)}` : words.join('');
}

/** Figures whose scale is picked together: the picker, and what draws them. */
function scaledAlike(figures, name, scales) {
  let [scale] = scales;
  const draw = () => figures.forEach((figure) => figure.draw(scale));
  const pick = (picked) => {
    scale = picked;
    draw();
  };
  return { picker: radios('Scale', name, scales, pick), draw };
}

const BARRIER_SCALES = [{ label: 'all values', isClose: false }, { label: 'close to zero', isClose: true }];

function barrierSection(report) {
  if (!hasTimes(report)) return absent('barriers', 'The document has no barriers over time (figures).');
  const { reproduces, undisturbed } = report;
  const numbers = `${reproduces.length > 1 ? 'Figures' : 'Figure'} ${figureNumbers(reproduces)} of the thesis`;
  const remarks = [
    ...(reproduces.length > 0 ? [`${numbers} ${reproduces.length > 1 ? 'show' : 'shows'} this scenario.`] : []),
    ...(undisturbed.length > 0 ? ['Dashed is the same scenario without disturbances.'] : []),
  ];
  byId('figures-remark').append(remarks.join(' '));
  byId('figures-remark').hidden = remarks.length === 0;
  const figures = barrierFigures(report);
  const { picker, draw } = scaledAlike(figures, 'barrier-scale', BARRIER_SCALES);
  byId('barriers-controls').append(picker);
  byId('barriers-body').append(...figures.map(({ node }) => node));
  return draw;
}

// ---------------------------------------------------------------- Lyapunov functions

const LYAPUNOV = [
  { key: 'v1', title: 'V1, desired speed', unit: 'm²/s²' },
  { key: 'v3', title: 'V3, path', unit: '' },
  { key: 'v2', title: 'V2, turn rate', unit: 'rad²/s²' },
];
const LYAPUNOV_SCALES = [{ label: 'linear', isLog: false }, { label: 'powers of ten', isLog: true }];

function lyapunovSection(report) {
  if (!hasTimes(report)) return absent('lyapunov', 'The document has no Lyapunov functions over time (figures).');
  const specs = LYAPUNOV.map(({ key, ...spec }) => ({ ...spec, told: anySize, lines: robotLines(report, key) }));
  const figures = specs.map((spec) => timeFigure(report, spec));
  const { picker, draw } = scaledAlike(figures, 'lyapunov-scale', LYAPUNOV_SCALES);
  const [v1, v3, v2] = figures.map(({ node }) => node);
  byId('lyapunov-body').append(
    el('div', { class: 'controls' }, picker),
    el('div', { class: 'pair' }, v1, v3, v2),
  );
  return draw;
}
