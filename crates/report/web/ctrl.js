// ---------------------------------------------------------------- main

const roomWords = (metres) => (metres < 0 ? quantity(millimetres(-metres), 1, 'mm') : `${quantity(millimetres(metres), 1, 'mm')} to spare`);

/** What was kept or not, and by how much. */
function boundWords({ robots, leastHeadway, clearance }) {
  const who = robots.length === 2 ? 'the follower' : robots.length === 1 ? 'the robot' : 'the robots';
  const its = robots.length > 2 ? 'their' : 'its';
  const lane = clearance < 0 ? `left ${its} lane by ${roomWords(clearance)}` : `kept ${its} lane with ${roomWords(clearance)}`;
  const short = `fell short of ${its} headway by ${roomWords(leastHeadway)}`;
  const keeps = clearance >= 0 ? '' : 'kept ';
  const headway = leastHeadway < 0 ? short : `${keeps}${its} headway with ${roomWords(leastHeadway)}`;
  const parts = [...(Number.isFinite(clearance) ? [lane] : []), ...(Number.isFinite(leastHeadway) ? [headway] : [])];
  return parts.length > 0 ? `${who} ${parts.join(' and ')}` : '';
}

function outcomeSentence({ outcomes }) {
  const { optimal, relaxed, braking } = outcomes;
  const total = optimal + relaxed + braking;
  if (!(total > 0)) return '';
  if (optimal === total) return 'every step was optimal';
  const some = [[relaxed, 'relaxed'], [braking, 'braking']].filter(([count]) => count > 0);
  const words = some.map(([count, name]) => `${fixed(count, 0)} ${count === 1 ? 'was' : 'were'} ${name}`);
  return `of ${plural(total, 'step')} ${words.join(' and ')}`;
}

const VERDICTS = [[true, 'Safe'], [false, 'Not safe'], [null, 'Whether it was safe is not known']];

function verdict(report) {
  const { safe, firstUnsafeS, endS } = report;
  const word = VERDICTS.find(([value]) => value === safe)[1];
  const since = safe === false && Number.isFinite(firstUnsafeS) ? `, first at ${quantity(firstUnsafeS, 1, 's')}` : '';
  const over = Number.isFinite(endS) ? ` over ${quantity(endS, 0, 's')}` : '';
  const bounds = boundWords(report);
  const parts = [...(bounds ? [`${bounds}${over}`] : []), outcomeSentence(report)].filter((part) => part !== '');
  return `${word}${since}${parts.length > 0 ? `: ${parts.join('; ')}` : ''}.`;
}

function runWords({ scenario, testbed, preset, seed, disturbed, rateHz }) {
  const parts = [
    `Scenario ${scenario}${testbed ? ` on ${testbed}` : ''}`,
    ...(preset ? [`preset ${preset}`] : []),
    ...(Number.isFinite(rateHz) ? [quantity(rateHz, 0, 'Hz')] : []),
    disturbed ? `with disturbances${Number.isFinite(seed) ? ` of seed ${seed}` : ''}` : 'without disturbances',
  ];
  return scenario ? ` ${parts.join(', ')}.` : '';
}

function introduce(report) {
  byId('version').append(report.version);
  byId('headline').append(`${verdict(report)}${runWords(report)}`);
  const { relaxed, braking } = report.outcomes;
  const facts = [
    ['Least headway h', millimetres(report.leastHeadway), 1, 'mm'],
    ['Least distance to the edge', millimetres(report.clearance), 1, 'mm'],
    ['Mean speed', report.meanSpeed, 3, 'm/s'],
    ['Steps relaxed', relaxed, 0, ''],
    ['Steps braking', braking, 0, ''],
    ['Step, median', report.loop.median, 1, 'µs'],
  ].filter(([, value]) => Number.isFinite(value));
  byId('facts').hidden = facts.length === 0;
  byId('facts').append(...facts.map(([term, value, digits, unit]) => fact(term, fixed(value, digits), unit)));
}

function main() {
  const report = readControl(parseDocument());
  introduce(report);
  problems(report, SCHEMA);
  const sections = [viewSection, barrierSection, lyapunovSection, pathSection, programmeSection, loopSection];
  const draws = sections.map((section) => section(report));
  byId('findings-body').append(...findings(report));
  byId('provenance-body').append(configuration(report), inputs(report));
  keepDrawn(() => draws.forEach((draw) => draw()));
}

main();
