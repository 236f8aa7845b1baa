// The player: slider, animation, speed, and the read-out of the current row.

const PASS_SECONDS = 6;

function createPlayer(state, units, actions) {
  const slider = el('input', { type: 'range', min: 0, step: 1, value: 0, class: 'slider', 'aria-label': 'position', oninput: () => { stop(); actions.move(Number(slider.value)); } });
  const play = el('button', { type: 'button', class: 'play', 'aria-label': 'play', title: 'play (space)', onclick: () => toggle() }, '▶');
  const speed = el('select', { 'aria-label': 'speed', title: 'speed' }, [0.1, 0.25, 0.5, 1, 2, 4].map(s => el('option', { value: s }, `${s}×`)));
  const place = el('output', { class: 'place' });
  speed.value = '1';
  const controls = el('div', { class: 'controls' }, play, slider, speed);
  let run = null;
  let row = 0;
  let running = null;

  function show(newRun) {
    run = newRun;
    stop();
    slider.max = Math.max(0, run.rows - 1);
    controls.hidden = !run.axis || run.rows < 2;
    slider.setAttribute('aria-label', run.axis ? run.axis.label : 'position');
  }

  function move(newRow) {
    row = newRow;
    if (!run || !run.axis) return;
    if (slider.value !== String(row)) slider.value = row;
    const text = `${run.axis.label} = ${units.text(run.axis.values[row], run.axis.unit, 6)}`;
    const others = run.columns.filter(c => c !== run.axis && c.group === 'Coordinates' && /^(rad|m)$/.test(c.unit) && !c.key.includes('.')).slice(0, 2);
    const more = others.map(c => `${c.label} = ${units.text(c.values[row], c.unit, 6)}`);
    setText(place, [text, ...more].join('   '));
    slider.setAttribute('aria-valuetext', text);
  }

  function toggle() {
    if (running) return stop();
    if (!run || !run.axis || run.rows < 2) return;
    setText(play, '❚❚');
    play.setAttribute('aria-label', 'pause');
    const values = run.axis.values;
    const [first, last] = [values[0], values[run.rows - 1]];
    let part = row >= run.rows - 1 ? 0 : (values[row] - first) / (last - first || 1);
    let before = null;
    const frame = now => {
      if (!running) return;
      if (before !== null) part = (part + ((now - before) / 1000 / PASS_SECONDS) * Number(speed.value)) % 1;
      before = now;
      actions.move(run.rowAt(first + part * (last - first)));
      running = requestAnimationFrame(frame);
    };
    running = requestAnimationFrame(frame);
  }

  function stop() {
    if (running) cancelAnimationFrame(running);
    running = null;
    setText(play, '▶');
    play.setAttribute('aria-label', 'play');
  }

  return { controls, place, show, move, toggle, stop };
}
