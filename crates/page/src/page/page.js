// The page. It shows one run after another in the same document.

function create(root, options = {}) {
  const state = readState(options.hash === false ? '' : location.hash);
  let run = null;
  let row = 0;
  let units = createUnits([]);
  let pending = null;
  const unitProxy = { of: (...a) => units.of(...a), text: (...a) => units.text(...a), names: () => units.names() };

  // Parts below the visible ones are filled later.
  const later = createLater();

  const actions = {
    // Moves to a row that the user selects; this stops the animation.
    move(newRow) {
      player.stop();
      move(newRow);
    },
    zoom(range) {
      state.zoom = range;
      charts.draw();
      remember();
    },
    changed() {
      state.charts.forEach(chart => { if (chart) chart.isChosen = true; });
      remember();
    },
    addColumn(column) {
      charts.add(column);
      charts.root.scrollIntoView({ block: 'nearest' });
    },
    saveSvg: (picture, name) => saveText(svgText(picture), `${fileName()}-${name}.svg`, 'image/svg+xml'),
    saveData: () => saveText(dataCsv(run), `${fileName()}.csv`, 'text/csv'),
    copyPeaks: () => navigator.clipboard.writeText(peaksCsv(run, peaks.listed())),
  };
  const fileName = () => `${run.description.scene ? run.description.scene.name : 'run'}-${run.description.command}`;

  const mechanism = createMechanism(state, newRow => actions.move(newRow), () => remember());
  const player = createPlayer(state, unitProxy, { move });
  player.controls.querySelector('.slider').addEventListener('input', () => player.stop());
  const charts = createCharts(state, unitProxy, actions);
  const peaks = createPeaks(unitProxy, actions, later);
  const words = createWords(unitProxy, actions, later);
  const title = el('h1');
  const subtitle = el('p', { class: 'subtitle' });
  const note = el('p', { class: 'scene-note' });
  const hash = el('span', { class: 'badge' });
  const unitButton = el('button', { type: 'button', title: 'units of the page', onclick: () => switchUnits() });
  const themeButton = el('button', { type: 'button', 'aria-label': 'dark or light', title: 'dark or light', onclick: () => switchTheme() }, '◐');
  const choices = createChoices(state, mechanism, () => remember());
  const help = el('p', { class: 'help' });
  const renewedHelp = createRenewed(help);
  const view = el('section', { class: 'card view', 'aria-label': 'mechanism' }, mechanism.root, player.controls, el('div', { class: 'place-line' }, player.place, choices.root), help);
  const left = el('div', { class: 'column' }, view, peaks.chipCard);
  root.classList.add('dwell-page');
  root.append(
    el('header', {}, el('div', {}, title, subtitle), el('div', { class: 'tools' }, hash, unitButton, themeButton)), note, words.top,
    el('div', { class: 'grid' }, left, charts.root), peaks.tableCard, words.root);

  // Shows a run. The position is kept if the scene and the axis are the same; otherwise the run starts at its first row.
  function show(description, numbers, isOther) {
    const axis = run && run.axis && run.axis.key;
    let before = run ? axis && run.axis.values[row] : state.at;
    run = createRun(description, numbers);
    if (isOther || (axis && (!run.axis || run.axis.key !== axis))) before = null;
    const d = run.description;
    run.isClosed = isClosed(run);
    units = createUnits(d.units);
    units.mode = state.units;
    setText(title, d.title);
    setText(subtitle, [d.subtitle || '', d.command && `dwell ${d.command}`].filter(Boolean).join(' · '));
    setText(note, d.note || '');
    note.hidden = !d.note;
    setText(hash, d.scene ? `scene ${d.scene.sha256.slice(0, 12)}` : '');
    hash.hidden = !d.scene;
    if (d.scene) hash.title = `sha256 ${d.scene.sha256}`;
    view.hidden = !d.drawing;
    left.hidden = !d.drawing && !run.axis;
    charts.root.hidden = !run.axis || !run.groups.size;
    root.classList.toggle('without-drawing', !d.drawing);
    describeHelp(d);
    row = before === undefined || before === null ? 0 : run.rowAt(before);
    mechanism.show(run);
    choices.show(mechanism.overlay());
    player.show(run);
    charts.show(run);
    peaks.show(run);
    words.show(run);
    nameUnits();
    move(row);
    if (state.check) seekCheck(words.root, state.check);
    state.check = null;
  }

  function describeHelp(d) {
    const keys = (...names) => names.map(name => el('kbd', {}, name));
    const isSpace = d.drawing && d.drawing.view;
    renewedHelp(String(Boolean(isSpace)), () => [isSpace ? 'Drag to turn the view (or ' : 'Drag a body, or move over a curve: everything follows. ', ...(isSpace ? [...keys('Alt'), ' with arrows). '] : []),
      ...keys('Space'), ' play, ', ...keys('←', '→'), ' one row (', ...keys('⇧'), ' ten), ', ...keys('Home', 'End'), ', drag in a chart to zoom, ', ...keys('Esc'), ' shows all.']);
    help.hidden = !run.axis;
  }

  function move(newRow) {
    if (!run || !run.rows) return;
    row = Math.max(0, Math.min(run.rows - 1, newRow));
    mechanism.move(row);
    player.move(row);
    charts.move(row);
    peaks.move(row);
    remember();
  }

  // Writes the state to the address after a pause of 300 ms, because browsers limit how often the address may change.
  function remember() {
    if (options.hash === false) return;
    clearTimeout(pending);
    pending = setTimeout(() => {
      const text = writeState(state, run, row);
      history.replaceState(null, '', text ? `#${text}` : location.pathname + location.search);
    }, 300);
  }

  function switchUnits() {
    state.units = units.mode = units.mode === 'si' ? 'scene' : 'si';
    nameUnits();
    charts.show(run);
    peaks.show(run);
    move(row);
  }

  function nameUnits() {
    const names = units.names();
    setText(unitButton, units.mode === 'si' ? names.si : names.scene);
    unitButton.setAttribute('aria-label', `units: ${unitButton.textContent}`);
  }

  function switchTheme() {
    const isDark = document.documentElement.dataset.theme ? document.documentElement.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
    document.documentElement.dataset.theme = isDark ? 'light' : 'dark';
  }

  function key(event) {
    const { target } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || !run || !run.axis) return;
    if (target.closest && target.closest('input:not([type=range]), textarea, select, [contenteditable]')) return;
    // Other inputs of the document, such as sliders, handle their keys themselves.
    if (target.closest && target.closest('input') && !root.contains(target)) return;
    const isButton = target.closest && target.closest('button, summary, a');
    const step = event.shiftKey ? 10 : 1;
    const rows = { ArrowRight: row + step, ArrowLeft: row - step, Home: 0, End: run.rows - 1, PageUp: row + 25, PageDown: row - 25 }[event.key];
    if (rows !== undefined) actions.move(rows);
    else if (event.key === ' ' && !isButton) player.toggle();
    else if (event.key === 'Escape') actions.zoom(null);
    else return;
    event.preventDefault();
  }
  document.addEventListener('keydown', key);
  if (options.hash !== false) window.addEventListener('hashchange', () => {
    const next = readState(location.hash);
    Object.assign(state, next, { arrows: state.arrows, paths: state.paths });
    if (run) show(run.description, run.numbers);
  });

  return {
    // Shows a run: the description (an object, or its JSON) and its numbers (a Float64Array).
    show(description, numbers, isOther) {
      show(description, numbers, isOther);
      run.numbers = numbers;
    },
    move: actions.move,
    // A promise that resolves when no deferred work is left.
    settled: later.done,
    row: () => row,
    run: () => run,
    play: () => player.toggle(),
  };
}

// Whether all bodies have the same position in the last row as in the first.
function isClosed(run) {
  const d = run.description.drawing;
  if (!d || run.rows < 3) return false;
  const last = run.rows - 1;
  return d.bodies.every(body => body.placements.every((k, which) => {
    const values = run.slot(k);
    const difference = d.view === null && which === 2 ? 2 * Math.sin((values[last] - values[0]) / 2) : values[last] - values[0];
    return Math.abs(difference) < 1e-5 * Math.max(1, d.size);
  }));
}

// The check boxes that select the forces and paths to show.
function createChoices(state, mechanism, changed) {
  const root = el('div', { class: 'choices' });
  const renewed = createRenewed(root);
  const group = (name, isOn, set, names, chosen) => {
    if (!names.length) return null;
    const main = el('input', { type: 'checkbox', onchange: () => { set(main.checked); mechanism.refresh(); changed(); } });
    main.checked = isOn;
    const boxes = names.map(({ name: own, title }) => {
      const box = el('input', { type: 'checkbox', onchange: () => {
        if (box.checked) chosen.add(own); else chosen.delete(own);
        if (box.checked && !main.checked) { main.checked = true; set(true); }
        mechanism.refresh();
      } });
      box.checked = chosen.has(own);
      return el('label', { title }, box, ' ', own);
    });
    return el('div', { class: 'choice' }, el('label', {}, main, ' ', name), el('details', { class: 'picker' }, el('summary', { 'aria-label': `which ${name}` }, '▾'), el('div', { class: 'picker-list' }, boxes)));
  };
  return {
    root,
    show(overlay) {
      if (!overlay) return renewed('', () => []);
      const arrows = overlay.arrows().filter(a => a.size > 0).map(a => ({ name: a.name, title: a.title }));
      const paths = overlay.paths().map(p => ({ name: p.name, title: p.name }));
      renewed(JSON.stringify([arrows, paths]), () => [group('forces', state.forces !== false, v => { state.forces = v; }, arrows, state.arrows), group('paths', state.showPaths !== false, v => { state.showPaths = v; }, paths, state.paths)].filter(Boolean));
    },
  };
}
