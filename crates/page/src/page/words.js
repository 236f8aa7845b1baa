// The texts of a run: messages, findings, numbers, tables, events, the scene and the provenance of the results.

function createWords(units, actions, later) {
  const root = el('div', { class: 'words' });
  const top = el('div', { class: 'messages' });

  // The cards in their order, each with the signature of its contents.
  let cards = [];
  let shownRun = null;
  const renewedTop = createRenewed(top);

  function show(run) {
    const d = run.description;
    const isFirst = !shownRun;
    shownRun = run;
    renewedTop(JSON.stringify(d.messages), () => d.messages.map(message));
    if (isFirst) fill();
    else later.add('words', () => { fill(); return true; });
  }

  // A card with unchanged contents is kept, open or closed.
  function fill() {
    const d = shownRun.description;
    const { axis } = shownRun;
    const parts = [
      ...d.pictures.map((picture, k) => [`picture ${k}`, picture, () => card('Picture', `picture-${k}`, el('img', { src: picture.path, alt: picture.title }))]),
      ['findings', d.findings, () => findingsCard(d.findings)], ['printed', d.printed, () => printedCard(d.printed)],
      ['events', [d.events, axis && axis.unit], () => eventsCard(d.events, () => shownRun, actions)], ['numbers', d.numbers, () => numbersCard(d.numbers, units)],
      ...d.tables.map((table, k) => [`table ${k}`, table, () => tableCard(table, k)]),
      ['scene', d.scene, () => sceneCard(d)], ['provenance', [d.version, d.command, d.method, d.scene && d.scene.sha256, d.files], () => provenanceCard(d)],
    ];
    const before = new Map(cards.map(own => [own.signature, own]));
    cards = parts.map(([name, of, make]) => {
      const signature = name + JSON.stringify(of);
      const own = before.get(signature) || { name, signature, card: make() };
      const old = cards.find(other => other.name === name);
      if (own.card && old && old.card && old !== own) keepOpen(old.card, own.card);
      return own;
    });
    root.replaceChildren(...cards.map(own => own.card).filter(Boolean));
  }
  return { root, top, show };
}

// Opens the sections that are open in the previous card.
function keepOpen(before, now) {
  const [old, details] = [before.querySelectorAll('details'), now.querySelectorAll('details')];
  if (old.length === details.length) details.forEach((own, k) => { own.open = old[k].open; });
}

function message({ severity, text, help }) {
  return el('div', { class: `message ${severity === 'error' ? 'error' : 'warning'}`, role: severity === 'error' ? 'alert' : 'note' },
    el('strong', {}, severity), ' ', el('span', {}, text), help ? el('p', {}, `try: ${help}`) : null);
}

// Shows failed findings first. More than 12 passed findings are collapsed.
function findingsCard(findings) {
  if (!findings.length) return null;
  const failed = findings.filter(f => !f.pass);
  const passed = findings.filter(f => f.pass);
  const header = ['', 'check', 'what is compared', 'difference', 'tolerance'];
  const line = f => el('tr', { class: f.pass ? 'pass' : 'fail', 'data-check': f.check.split(' ')[0] },
    el('td', {}, el('span', { 'aria-label': f.pass ? 'pass' : 'fail' }, f.pass ? '✓' : '✗')),
    el('td', {}, f.check),
    el('td', {}, f.comparison, el('span', { class: 'detail' }, [f.domain, f.worst_at && `worst at ${f.worst_at}`, f.scale && f.scale !== 'none' && `relative to ${f.scale}`].filter(Boolean).join(' · '))),
    el('td', { class: 'number' }, scientific(Number(f.relative_difference))),
    el('td', { class: 'number', title: f.tolerance_reason }, scientific(Number(f.tolerance))));
  const table = some => el('div', { class: 'wide' }, el('table', { class: 'findings' }, el('thead', {}, el('tr', {}, header.map(t => el('th', { scope: 'col' }, t)))), el('tbody', {}, some.map(line))));
  const count = `${passed.length} of ${findings.length} checks pass`;
  return card('Findings', 'findings', el('p', { class: failed.length ? 'verdict fail' : 'verdict pass' }, count), failed.length ? table(failed) : null,
    passed.length ? el('details', { open: passed.length <= 12 }, el('summary', {}, `${passed.length} that pass`), table(passed)) : null);
}

// Shows the findings of a check, by its number.
function seekCheck(root, check) {
  const lines = [...root.querySelectorAll('tr[data-check]')].filter(line => line.dataset.check === check);
  if (!lines.length) return;
  for (const line of lines) {
    line.classList.add('sought');
    const details = line.closest('details');
    if (details) details.open = true;
  }
  lines[0].scrollIntoView({ block: 'center' });
}

function printedCard(printed) {
  return printed ? card('Summary', 'summary', el('pre', {}, printed)) : null;
}

function eventsCard(events, runNow, actions) {
  if (!events.length) return null;
  const shown = events.slice(0, 200);
  const item = e => {
    const { axis } = runNow();
    const isTime = axis && axis.unit === 's';
    const text = `${format(Number(e.t), 6)} s`;
    return el('li', {}, isTime ? el('button', { type: 'button', class: 'jump', onclick: () => actions.move(runNow().rowAt(Number(e.t))) }, text) : text, ` ${e.name}`);
  };
  const more = events.length - shown.length;
  return card('Events', 'events', el('ul', { class: 'events' }, shown.map(item)), more > 0 ? el('p', { class: 'note' }, `and ${more} more`) : null);
}

function numbersCard(numbers, units) {
  if (!numbers.length) return null;
  const line = n => el('tr', {}, el('th', { scope: 'row' }, n.name), el('td', { class: 'number', 'data-value': n.value, title: String(n.value) }, format(Number(n.value), 9)),
    el('td', { class: 'unit' }, printedUnit(n.unit)), el('td', { class: 'number' }, n.error === null ? '' : scientific(Number(n.error))));
  const table = el('table', {}, el('thead', {}, el('tr', {}, ['quantity', 'value', 'unit', 'estimated error'].map((t, k) => el('th', { scope: 'col', class: k % 2 ? 'number' : null }, t)))), el('tbody', {}, numbers.map(line)));
  return card('Numbers', 'numbers', el('details', { open: numbers.length <= 40 }, el('summary', {}, `${numbers.length} numbers`), el('div', { class: 'wide' }, table)));
}

function tableCard({ title, header, rows }, k) {
  const table = el('table', {}, el('thead', {}, el('tr', {}, header.map(t => el('th', { scope: 'col' }, t)))), el('tbody', {}, rows.map(r => el('tr', {}, r.map(c => el('td', {}, c))))));
  return card(title || 'Table', `table-${k}`, el('div', { class: 'wide' }, table));
}

function sceneCard(d) {
  if (!d.scene) return null;
  return card('Scene', 'scene', el('details', {}, el('summary', {}, `${d.scene.name}.toml, ${d.scene.text.split('\n').length} lines`), el('pre', { class: 'scene-text' }, d.scene.text)));
}

function provenanceCard(d) {
  const pairs = [['program', d.version && `Dwell ${d.version}`], ['command', d.command && `dwell ${d.command}`], ['method', d.method], ['scene', d.scene && d.scene.name], ['sha256 of the scene', d.scene && d.scene.sha256]];
  const files = d.files.map(f => el('li', {}, el('a', { href: encodeURI(f.path) }, f.title || f.path)));
  return card('Provenance', 'provenance', el('dl', {}, pairs.filter(([, value]) => value).map(([name, value]) => [el('dt', {}, name), el('dd', {}, value)])),
    files.length ? el('details', {}, el('summary', {}, `${files.length} files beside this page`), el('ul', { class: 'files' }, files)) : null);
}
