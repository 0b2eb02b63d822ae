// ---------------------------------------------------------------- a session while it runs

const LIVE = {
  ...{ windowS: 30, trailS: 10, quietMs: 1000, retryMs: 1000, notes: 200 },
  ...{ tickMs: 100, cardsMs: 100, chartsMs: 200, restMs: 500 },
};
const STOP = { answerMs: 1500, reliefMs: 250, pausesMs: [0, 100, 400, 1000] };
const STATES = {
  connecting: { words: 'connecting', colour: '--other' },
  waiting: { words: 'waiting for the robots', colour: '--other' },
  running: { words: 'running', colour: '--acceleration' },
  stopping: { words: 'stopping', colour: '--series-4' },
  quiet: { words: 'no data', colour: '--braking' },
  lost: { words: 'connection lost – reconnecting', colour: '--braking' },
};
SCENE.trailS = LIVE.trailS;

const restful = window.matchMedia('(prefers-reduced-motion: reduce)');

const live = {
  ...{ session: '', token: '', mayStop: false, hasStopped: false, ended: null },
  ...{ source: null, isOpen: false, since: 0, frame: 0, palette: null },
};

/** Nothing is known of the robots yet. */
function forget(lane) {
  const raw = object(lane);
  const body = object(raw.robot);
  Object.assign(live, {
    lane: readLane(raw),
    body: { length: number(body.length_m), offset: number(body.offset_m), base: number(body.wheel_base_m) },
    headwayS: number(raw.headway_s),
    ...{ time: [], robots: [], cards: [], snapshot: null, noted: 0, drawnAt: 0, cardsAt: 0, chartsAt: 0 },
  });
}

// ---------------------------------------------------------------- values

const LOOP = [
  { label: 'Step late by', unit: 'µs', digits: 0, of: ({ late_us }) => number(late_us) },
  { label: 'Deadlines missed', unit: '', digits: 0, of: ({ missed }) => number(missed) },
].map(valueRow);

function tellDropped(counts) {
  const rows = Object.entries(object(counts)).filter(([, count]) => count > 0);
  if (rows.length === 0) return byId('dropped').replaceChildren(note('None.'));
  const row = ([reason, count]) => el('tr', {}, el('th', { scope: 'row' }, reason.replace(/[-_]/g, ' ')), el('td', {}, fixed(count, 0)));
  const head = el('tr', {}, heading('Reason', 'text'), heading('Packets'));
  byId('dropped').replaceChildren(tableBox('Packets dropped by reason', [head], [el('tbody', {}, ...rows.map(row))]));
}

function tellCards() {
  const { snapshot, robots, cards } = live;
  for (const robot of robots.slice(cards.length)) {
    cards.push(robotCard(robot));
    byId('robots-body').append(cards.at(-1).node);
  }
  cards.forEach((card) => card.tell());
  const of = snapshot.duration_s > 0 ? ` of ${quantity(snapshot.duration_s, 0, 's')}` : '';
  byId('time').textContent = `${quantity(number(snapshot.time_s), 1, 's')}${of}`;
  LOOP.forEach((row) => row.tell(snapshot));
}

function buildCharts() {
  const { windowS } = LIVE;
  live.charts = [
    { title: 'Headway', key: 'h_headway', unit: 'mm', digits: 1, scale: 1000, windowS },
    { title: 'Distance to the edge of the lane', key: 'lane_clearance', unit: 'mm', digits: 1, scale: 1000, windowS },
  ].map((spec) => runningChart(live, spec));
  byId('barriers-body').replaceChildren(...live.charts.map(({ node }) => node));
}

/** Each part as often as it can be read. */
function draw(isForced = false) {
  const now = performance.now();
  const rest = restful.matches ? LIVE.restMs : 0;
  const isDue = (key, periodMs) => {
    if (!isForced && now - live[key] < Math.max(periodMs, rest)) return false;
    live[key] = now;
    return true;
  };
  if (isDue('drawnAt', 0)) drawRobots();
  if (live.snapshot === null) return;
  if (isDue('cardsAt', LIVE.cardsMs)) tellCards();
  if (!isDue('chartsAt', LIVE.chartsMs)) return;
  tellDropped(live.snapshot.dropped);
  live.charts.forEach((chart) => chart.draw());
}

function wake() {
  if (live.frame !== 0) return;
  live.frame = requestAnimationFrame(() => {
    live.frame = 0;
    draw();
  });
}

// ---------------------------------------------------------------- the state of the session

function stateNow() {
  const { ended, isOpen, session, snapshot, since, hasStopped } = live;
  if (ended !== null) return { words: `ended: ${ended}`, colour: ended.startsWith('lost') ? '--braking' : '--other' };
  if (!isOpen) return session === '' ? STATES.connecting : STATES.lost;
  if (performance.now() - since > LIVE.quietMs) return STATES.quiet;
  if (hasStopped) return STATES.stopping;
  return snapshot === null ? STATES.waiting : STATES.running;
}

function setText(id, words) {
  if (byId(id).textContent !== words) byId(id).textContent = words;
}

/** Says how it stands. The seconds without data are for the eye only: read out each time they would drown the rest. */
function tellState() {
  const state = stateNow();
  const silentS = (performance.now() - live.since) / 1000;
  const isOld = state === STATES.quiet || state === STATES.lost;
  setText('state', state.words);
  setText('quiet', isOld && live.since > 0 ? `for ${quantity(silentS, 1, 's')}` : '');
  byId('sign').style.background = `var(${state.colour})`;
  byId('report').classList.toggle('old', isOld);
}

function tellAccess() {
  const { session, mayStop, ended } = live;
  byId('stop').hidden = !mayStop;
  byId('stop').disabled = ended !== null;
  const keys = ended === null ? 'or space, or Esc' : '';
  setText('access', mayStop ? keys : session === '' ? '' : 'read only');
}

// ---------------------------------------------------------------- stop

function tellStop(button, problem = '') {
  byId('stop').textContent = button;
  setText('stop-state', problem);
  byId('stop-state').hidden = problem === '';
}

/** The status of the answer, or 0 without one. */
async function askToStop() {
  try {
    const headers = { Authorization: `Bearer ${live.token}` };
    const answer = await fetch('/stop', { method: 'POST', headers, signal: AbortSignal.timeout(STOP.answerMs) });
    return answer.status;
  } catch {
    return 0;
  }
}

/** A browser has few connections to one server, and its pages may hold all of them: the one of the events goes to the stop. */
function giveWay() {
  live.source.close();
  live.isOpen = false;
  setTimeout(connect, LIVE.retryMs);
}

async function stop() {
  if (!live.mayStop || live.ended !== null) return;
  tellStop('Stopping…');
  for (const pauseMs of STOP.pausesMs) {
    await new Promise((done) => setTimeout(done, pauseMs));
    const relief = setTimeout(giveWay, STOP.reliefMs);
    const status = await askToStop();
    clearTimeout(relief);
    if (live.ended !== null) return;
    live.hasStopped ||= status === 200;
    if (live.hasStopped) return tellStop('Stopping…');
    if (status === 403) break;
  }
  tellStop('Stop', 'The stop did not arrive. Press it again, or end the program where it runs.');
}

function stopByKey(event) {
  const isOther = event.ctrlKey || event.altKey || event.metaKey;
  if (!live.mayStop || isOther || event.repeat || (event.key !== ' ' && event.key !== 'Escape')) return;
  event.preventDefault();
  stop();
}

// ---------------------------------------------------------------- events

function hello(said) {
  Object.assign(live, { isOpen: true, mayStop: said.may_stop === true });
  if (text(said.session) !== live.session) {
    Object.assign(live, { session: text(said.session), since: performance.now(), hasStopped: false });
    forget(said.lane);
    tellStop('Stop');
    byId('title').textContent = text(said.title);
    document.title = `${text(said.title)} – drivekit live`;
    byId('robots-body').replaceChildren();
    byId('notes-body').replaceChildren();
    buildStage();
    buildCharts();
  }
  tellAccess();
  draw(true);
}

function take(snapshot) {
  // After a connection was lost the newest snapshot comes once more.
  if (number(snapshot.time_s) <= live.time.at(-1)) return;
  Object.assign(live, { snapshot, since: performance.now() });
  remember(live, snapshot, LIVE.windowS);
  wake();
}

function addNote({ index, time_s: timeS, text: words }) {
  if (index <= live.noted) return;
  live.noted = index;
  const at = Number.isFinite(timeS) ? quantity(timeS, 1, 's') : '';
  byId('notes-body').prepend(el('li', {}, el('span', {}, at), text(words)));
  while (byId('notes-body').children.length > LIVE.notes) byId('notes-body').lastChild.remove();
}

function end(how) {
  live.ended = text(how);
  live.source.close();
  tellStop('Stop');
  tellAccess();
  draw(true);
}

function connect() {
  if (live.ended !== null || (live.source !== null && live.source.readyState !== EventSource.CLOSED)) return;
  const source = new EventSource(live.token === '' ? '/events' : `/events?token=${encodeURIComponent(live.token)}`);
  live.source = source;
  for (const [name, action] of Object.entries({ hello, snapshot: take, note: addNote, end })) {
    source.addEventListener(name, ({ data }) => {
      action(JSON.parse(data));
      tellState();
    });
  }
  source.addEventListener('error', () => {
    live.isOpen = false;
    if (source.readyState === EventSource.CLOSED) setTimeout(connect, LIVE.retryMs);
    tellState();
  });
}

function main() {
  const token = new URLSearchParams(window.location.search).get('token') ?? '';
  window.history.replaceState(null, '', window.location.pathname);
  live.token = token;
  live.palette = readPalette();
  LOOP.forEach(({ node }) => byId('loop-body').append(node));
  byId('dropped').append(note('None.'));
  byId('stop').addEventListener('click', stop);
  window.addEventListener('keydown', stopByKey);
  setInterval(tellState, LIVE.tickMs);
  connect();
  keepDrawn(() => {
    live.palette = readPalette();
    if (live.session !== '') draw(true);
  });
}

forget(null);
main();
