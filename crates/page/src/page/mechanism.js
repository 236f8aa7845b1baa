// The mechanism in the current row, as SVG. In the plane the user drags a body, in space the view.

const HEIGHT = 400;
const MARGIN = 34;
// Positions of labels relative to their marks, px, and LABEL_SIZE: width of a letter and height of a line, px.
const LABEL_PLACES = [{ x: 10, y: -10 }, { x: -11, y: -10 }, { x: 10, y: 21 }, { x: -11, y: 21 }, { x: 0, y: -14 }, { x: 13, y: 5 }, { x: -13, y: 5 }, { x: 0, y: 26 }];
// Positions for a pin on the ground, whose symbol extends below it.
const GROUND_PLACES = [1, 0, 4, 6, 5, 3, 2].map(k => LABEL_PLACES[k]);
const LABEL_SIZE = [9, 13];
// Penalties for a label that covers another label, and for a label that crosses the edge; covering a mark counts 1.
const [OVER_LABEL, OVER_EDGE] = [3, 2];
const CLOSED = new Set(['plate', 'block', 'cam', 'rack']);
// Number of rows in which overlaps of labels are counted.
const LABEL_ROWS = 24;
// Length of a rod beyond its sleeve in space, in half lengths of a hinge.
const GUIDE_MARGIN = 2.6;
// Least half length of a hinge, px.
const LEAST_UNIT = 7;

function createMechanism(state, onMove, onTurn) {
  const root = svg('svg', { class: 'mechanism', role: 'img', tabindex: 0, height: HEIGHT });
  let run = null;
  let drawing = null;
  let frames = null;
  let view = null;
  let bounds = null;
  let items = [];
  let layers = null;
  let overlay = null;
  let shape = null;
  let width = 0;
  let row = 0;

  function show(newRun) {
    run = newRun;
    row = Math.min(row, Math.max(0, run.rows - 1));
    drawing = run.description.drawing;
    if (!drawing) {
      root.replaceChildren();
      [shape, items, overlay] = [null, [], null];
      return;
    }
    frames = createFrames(drawing, run);
    view = createView(frames.isPlane ? null : state.view || drawing.view);
    bounds = boundsOf(drawing, frames, run.rows);
    const nextShape = shapeOf(drawing);
    if (nextShape === shape) {
      items.forEach((item, k) => item.renew(drawing.parts[k]));
      overlay.show(drawing, run, frames, view);
      return fit();
    }
    shape = nextShape;
    root.replaceChildren();
    items = [];
    layers = { parts: svg('g'), paths: svg('g'), marks: svg('g'), forces: svg('g'), axes: svg('g', { class: 'ground-axes', 'aria-hidden': 'true' }), words: svg('g', { 'aria-hidden': 'true' }) };
    root.append(svg('title', {}, frames.isPlane ? 'The mechanism in this position' : 'The mechanism in this position, seen from one side'));
    root.append(layers.parts, layers.paths, layers.marks, layers.forces, layers.axes, layers.words);
    for (const part of drawing.parts) items.push(createItem(part));
    overlay = createOverlay(drawing, layers, state);
    overlay.show(drawing, run, frames, view);
    root.classList.toggle('turnable', !frames.isPlane);
    fit();
  }

  // Scales the picture to the region that the mechanism covers during the run.
  function fit() {
    // A ResizeObserver tracks the width, as in charts.
    if (!width) width = root.clientWidth || 560;
    root.setAttribute('viewBox', `0 0 ${width} ${HEIGHT}`);
    const { middle, size, radius } = bounds;
    const across = frames.isPlane ? size : [2 * radius, 2 * radius];
    const free = [width - 2 * MARGIN, HEIGHT - 2 * MARGIN];
    const scales = [0, 1].map(k => (across[k] > 0 ? free[k] / across[k] : Infinity));
    const scale = Math.min(...scales);
    view.scale = Number.isFinite(scale) ? scale : 100;
    [view.x, view.y] = [0, 0];
    const [x, y] = view.screen(middle);
    [view.x, view.y] = [width / 2 - x, HEIGHT / 2 - y];
    overlay.fitLengths(width, HEIGHT);
    overlay.layOut();
    if (!frames.isPlane) drawAxes();
    placeLabels();
    move(row);
  }

  // Chooses the position of each label relative to its mark: the one with the fewest overlaps in LABEL_ROWS rows of the run.
  function placeLabels() {
    const last = Math.max(0, run.rows - 1);
    const rows = Array.from({ length: Math.min(LABEL_ROWS, run.rows) }, (_, k) => Math.round((k * last) / LABEL_ROWS));
    const marks = items.filter(item => item.placeLabel);
    const taken = rows.map(r => marks.flatMap(mark => mark.boxes(r)));
    // While labels overlap, further passes take later labels into account.
    for (let pass = 0; pass < 3; pass++) {
      if (!marks.map(mark => mark.placeLabel(rows, taken)).some(Boolean)) break;
    }
  }

  // The axes of the ground, in a corner.
  function drawAxes() {
    const at = [46, HEIGHT - 46];
    layers.axes.replaceChildren(...[[1, 0, 0], [0, 1, 0], [0, 0, 1]].flatMap((axis, k) => {
      const [x, y] = view.direction(axis).map(v => (v / view.scale) * 30);
      return [svg('path', { d: arrowPath(at[0], at[1], x, y) }), svg('text', { x: at[0] + 1.3 * x, y: at[1] + 1.3 * y + 4, 'text-anchor': 'middle' }, 'xyz'[k])];
    }));
  }

  const colored = body => {
    const paint = body === null || body === undefined ? null : drawing.bodies[body].paint;
    return paint === null ? 'paint-ground' : `paint-${paint}`;
  };

  function createItem(first) {
    let part = first;
    const renew = next => { part = next; };
    const w = [0, 0, 0];
    const at = (anchor, r) => view.screen(frames.place(anchor.body, anchor.point, r, w));
    if (part.part === 'outline') return createOutline(part, w);
    if (part.part === 'link') {
      const line = svg('path', { class: `${part.look === 'shaft' ? 'guide' : part.look} ${colored(part.body)}` });
      const barrel = part.look === 'cylinder' ? svg('path', { class: `barrel ${colored(part.body)}` }) : null;
      const group = svg('g', { 'data-body': part.body }, svg('title', {}, part.title), line, barrel);
      layers.parts.append(group);
      return {
        element: group,
        renew,
        depth: r => 0.5 * (view.nearness(frames.place(part.ends[0].body, part.ends[0].point, r, w)) + view.nearness(frames.place(part.ends[1].body, part.ends[1].point, r, w))),
        move(r) {
          const [a, b] = part.look === 'shaft' ? shaft(part, r) : part.ends.map(end => at(end, r));
          line.setAttribute('d', part.look === 'drive' ? drivePath(a, b, unit()) : part.look === 'spring' ? springPath(a, b, 9) : part.look === 'damper' ? damperPath(a, b, 7) : linePath(a, b));
          if (barrel) barrel.setAttribute('d', linePath(a, [0, 1].map(k => 0.5 * (a[k] + b[k]))));
        },
      };
    }
    return createMark(part, at, w);
  }

  // Half the length of a hinge in space, px; on small screens at least LEAST_UNIT.
  const unit = () => Math.max(LEAST_UNIT, drawing.size * view.scale);

  // The ends of a rod through a sleeve. They lie beyond the sleeve and beyond the point where the rod is fixed to its body.
  function shaft({ ends, axis }, r) {
    const [u, a, b] = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
    frames.direct(ends[0].body, axis, r, u);
    frames.place(ends[0].body, ends[0].point, r, a);
    frames.place(ends[1].body, ends[1].point, r, b);
    const apart = u.reduce((sum, c, k) => sum + c * (b[k] - a[k]), 0);
    return [Math.min(apart, 0) - GUIDE_MARGIN * drawing.size, Math.max(apart, 0) + GUIDE_MARGIN * drawing.size].map(s => view.screen(a.map((c, k) => c + s * u[k])));
  }

  function createOutline(first, w) {
    let part = first;
    let renew = next => { part = next; };
    const title = svg('title', {}, drawing.bodies[part.body].name);
    const classes = `${part.look} ${colored(part.body)}`;
    const main = svg('path', { class: classes });
    const inner = part.look === 'slot' ? svg('path', { class: 'slot-inside' }) : null;
    // In space a bar has a rim that interrupts lines behind it, and a guide on the ground ends at walls.
    const rim = !frames.isPlane && part.look === 'bar' ? svg('path', { class: 'rim' }) : null;
    const walls = !frames.isPlane && part.look === 'guide' && frames.isFixed(part.body) ? svg('path', { class: 'ground-line' }) : null;
    const group = svg('g', { 'data-body': part.body }, title, rim, main, inner, walls);
    layers.parts.append(group);
    if (part.look === 'ground-line') {
      return {
        element: group,
        renew,
        depth: () => -Infinity,
        move(r) {
          const [a, b] = part.points.map(p => view.screen(frames.place(part.body, p, r, w)));
          main.setAttribute('d', linePath(a, b) + hatching(a, b));
        },
      };
    }
    const nearness = r => {
      // Lines to centres of mass are drawn last.
      let sum = part.look === 'arm' ? Infinity : 0;
      for (const p of part.points) sum += view.nearness(frames.place(part.body, p, r, w));
      return sum / part.points.length;
    };
    if (!frames.isPlane) {
      return {
        element: group,
        renew,
        depth: nearness,
        move(r) {
          let d = '';
          for (const p of part.points) {
            const [x, y] = view.screen(frames.place(part.body, p, r, w));
            d += `${d ? 'L' : 'M'}${x.toFixed(2)} ${y.toFixed(2)}`;
          }
          main.setAttribute('d', CLOSED.has(part.look) ? d + 'Z' : d);
          if (!rim && !walls) return;
          const ends = part.points.map(p => [...frames.place(part.body, p, r, w)]);
          const [a, b] = ends.map(view.screen);
          if (rim) rim.setAttribute('d', linePath(...[[5, 1], [1, 5]].map(([s, t]) => [0, 1].map(k => (s * a[k] + t * b[k]) / 6))));
          else {
            const seen = Math.hypot(b[0] - a[0], b[1] - a[1]) / (view.scale * Math.hypot(...ends[0].map((c, k) => c - ends[1][k])));
            walls.setAttribute('d', wallPath(a, [a[0] - b[0], a[1] - b[1]], seen, unit()) + wallPath(b, [b[0] - a[0], b[1] - a[1]], seen, unit()));
          }
        },
      };
    }
    // In the plane the outline has coordinates of its body, in metres; only the transform of the group changes.
    renew = next => {
      part = next;
      const d = outlinePath(part, frames.isFixed(part.body));
      for (const path of [main, inner]) if (path) path.setAttribute('d', d);
    };
    renew(part);
    return {
      element: group,
      renew,
      depth: nearness,
      move(r) {
        const [x, y, angle] = frames.isFixed(part.body) ? [0, 0, 0] : frames.placement(part.body, r);
        const [c, s] = [Math.cos(angle) * view.scale, Math.sin(angle) * view.scale];
        group.setAttribute('transform', `matrix(${c} ${-s} ${-s} ${-c} ${view.x + view.scale * x} ${view.y - view.scale * y})`);
      },
    };
  }

  function createMark(first, at, w) {
    let part = first;
    const shape = svg('g', { class: `mark mark-${part.look} ${colored(part.body)}`, 'data-body': part.at.body }, svg('title', {}, part.title), frames.isPlane ? markElements(part.look) : null);
    const label = part.label ? svg('text', { class: 'label' }, part.label) : null;
    const isBehind = part.look === 'support';
    layers[isBehind ? 'parts' : 'marks'].append(shape);
    if (label) layers.words.append(label);
    // `placeLabel` chooses the position of the label.
    const places = frames.isPlane && part.ground.length ? GROUND_PLACES : LABEL_PLACES;
    let [place] = places;
    let labelBoxes = [];
    return {
      element: shape,
      renew(next) { part = next; },
      // The boxes that the mark covers: left, top, width and height in px, and the mark.
      boxes(r) {
        const [x, y] = at(part.at, r);
        const own = [[x - 7, y - 7, 14, 14, shape]];
        if (isBehind) own.push([x - 20, y + 5, 40, 24, shape]);
        return own;
      },
      // Chooses the position with the least overlap, adds its boxes to `taken`, and returns the overlap.
      placeLabel(rows, taken) {
        if (!label) return 0;
        rows.forEach((_, k) => { taken[k] = taken[k].filter(box => box !== labelBoxes[k]); });
        const middles = rows.map(r => at(part.at, r));
        let least = Infinity;
        for (const candidate of places) {
          const boxes = middles.map(middle => labelBox(part.label, candidate, middle, shape));
          const inWay = boxes.reduce((sum, box, k) => sum + inWayOf(box, taken[k], width), 0);
          if (inWay < least) [least, place, labelBoxes] = [inWay, candidate, boxes];
          if (!least) break;
        }
        labelBoxes.forEach((box, k) => taken[k].push(box));
        return least;
      },
      inMarks: !isBehind,
      // Centres of mass and symbols of driven joints are drawn last.
      depth: r => (['center-of-mass', 'turned', 'pushed'].includes(part.look) ? Infinity : view.nearness(frames.place(part.at.body, part.at.point, r, w))),
      move(r) {
        const [x, y] = at(part.at, r);
        shape.setAttribute('transform', `translate(${x} ${y})`);
        if (label) {
          label.setAttribute('x', x + place.x);
          label.setAttribute('y', y + place.y);
          label.setAttribute('text-anchor', place.x < 0 ? 'end' : place.x > 0 ? 'start' : 'middle');
        }
        if (!frames.isPlane) renewPaths(shape, spatial(part, r, [x, y]));
      },
    };
  }

  // The symbol of a mark in space.
  function spatial(part, r, [x, y]) {
    const direction = axis => (axis.length ? [...frames.direct(part.frame, axis, r, [0, 0, 0])] : [0, 0, 0]);
    const [a, n] = [direction(part.axis), direction(part.normal)];
    const c = [a[1] * n[2] - a[2] * n[1], a[2] * n[0] - a[0] * n[2], a[0] * n[1] - a[1] * n[0]];
    const see = (i, j, k) => {
      const p = a.map((_, axis) => i * n[axis] + j * c[axis] + k * a[axis]);
      return [...view.direction(p).map(v => (v * unit()) / view.scale), view.nearness(p)];
    };
    const others = part.ground.map(anchor => view.screen(frames.place(anchor.body, anchor.point, r, [0, 0, 0])).map((v, k) => v - [x, y][k]));
    const away = others.length === 1 ? others[0].map(v => -v) : null;
    const paths = solidPaths(part.look, see, unit(), away);
    if (others.length > 1) paths.unshift(['ground-line', railPath(...others, Math.hypot(...see(0, 0, 1).slice(0, 2)) / unit(), unit())]);
    return paths;
  }

  function move(newRow) {
    row = newRow;
    if (!drawing || !items.length) return;
    for (const item of items) item.move(row);
    if (!frames.isPlane) sort();
    overlay.move(row);
  }

  // Orders the elements so that near parts are drawn over far ones.
  function sort() {
    for (const layer of ['parts', 'marks']) {
      const own = items.filter(item => (item.inMarks ? 'marks' : 'parts') === layer);
      const order = own.map(item => [item.depth(row), item.element]).sort((a, b) => a[0] - b[0]);
      const children = layers[layer].children;
      if (order.some(([, element], k) => children[k] !== element)) layers[layer].append(...order.map(([, element]) => element));
    }
  }

  dragging(root, {
    isPlane: () => !frames || frames.isPlane,
    // The point of a body under the pointer, in its frame.
    grab(body, [sx, sy]) {
      if (frames.isFixed(body)) return null;
      const [x, y, angle] = frames.placement(body, row);
      const [dx, dy] = [(sx - view.x) / view.scale - x, (view.y - sy) / view.scale - y];
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      return { body, point: [c * dx + s * dy, -s * dx + c * dy] };
    },
    follow: (anchor, at) => onMove(nearestRow(run, frames, view, anchor, at, row)),
    turn(dx, dy) {
      const [azimuth, elevation] = view.angles;
      view.look(azimuth - dx * 0.01, Math.max(-1.57, Math.min(1.57, elevation + dy * 0.01)));
      turned();
    },
  });
  root.addEventListener('keydown', event => {
    if (!frames || frames.isPlane || !event.altKey) return;
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!steps) return;
    event.preventDefault();
    const [azimuth, elevation] = view.angles;
    view.look(azimuth + 0.1 * steps[0], Math.max(-1.57, Math.min(1.57, elevation - 0.1 * steps[1])));
    turned();
  });
  function turned() {
    state.view = view.angles;
    fit();
    onTurn();
  }
  new ResizeObserver(([{ contentRect }]) => {
    const newWidth = Math.round(contentRect.width);
    if (!newWidth || newWidth === width) return;
    width = newWidth;
    if (drawing) fit();
  }).observe(root);
  return { root, show, move, overlay: () => overlay, refresh: () => { if (drawing) { overlay.layOut(); overlay.move(row); } }, angles: () => view && view.angles };
}

// The box of a label at a position relative to its mark: left, top, width and height in px, and the mark.
function labelBox(text, place, [x, y], mark) {
  const long = text.length * LABEL_SIZE[0];
  const before = place.x < 0 ? long : place.x > 0 ? 0 : 0.5 * long;
  return Object.assign([x + place.x - before, y + place.y - LABEL_SIZE[1], long, LABEL_SIZE[1], mark], { isLabel: true });
}

// Sets the paths of a group after its title. Each has its class, and a shaded path the percentage of its colour.
function renewPaths(group, paths) {
  while (group.children.length > paths.length + 1) group.lastChild.remove();
  paths.forEach(([name, d, part], k) => {
    const path = group.children[k + 1] || group.appendChild(svg('path'));
    path.setAttribute('class', name);
    path.setAttribute('d', d);
    if (part === undefined) path.removeAttribute('style');
    else path.style.setProperty('--part', `${part}%`);
  });
}

// The weighted number of boxes of other marks that a label covers, plus the penalty for the edges of the picture.
function inWayOf([left, top, long, high, mark], others, width) {
  let sum = left < 0 || left + long > width || top < 0 || top + high > HEIGHT ? OVER_EDGE : 0;
  for (const other of others) {
    const [x, y, w, h, of] = other;
    if (of !== mark && left < x + w && x < left + long && top < y + h && y < top + high) sum += other.isLabel ? OVER_LABEL : 1;
  }
  return sum;
}

// The contents of a drawing as text: two drawings with the same shape differ only in numbers.
function shapeOf(drawing) {
  const part = p => [p.part, p.look, p.title, p.label, p.body, (p.ground || []).length, p.at && p.at.body, (p.points || []).length, (p.axis || []).length].join();
  const arrow = a => [a.name, a.title, a.group, a.direction, a.columns || a.parts.map(part => part.column)].join();
  return [drawing.view === null, drawing.bodies.map(b => `${b.name}|${b.paint}|${b.placements.length}`).join(), ...drawing.parts.map(part), ...drawing.arrows.map(arrow), ...drawing.paths.map(p => `${p.name}|${p.requested}`)].join('\n');
}

// The path of an outline in the frame of its body, m. A moving wheel has a spoke.
function outlinePath(part, isFixed) {
  if (part.look === 'wheel') {
    const [[x, y], [r]] = part.points;
    return `M${x + r} ${y}A${r} ${r} 0 1 1 ${x - r} ${y}A${r} ${r} 0 1 1 ${x + r} ${y}${isFixed ? '' : linePath([x, y], [x + r, y])}`;
  }
  return part.points.map(([x, y], k) => `${k ? 'L' : 'M'}${x} ${y}`).join('') + (CLOSED.has(part.look) ? 'Z' : '');
}

// The row in which a point of a body is nearest to the pointer. A term for the distance from this row keeps the branch of the motion.
function nearestRow(run, frames, view, anchor, [sx, sy], row) {
  const rows = run.rows;
  const reach = Math.max(12, Math.ceil(rows / 5));
  const w = [0, 0, 0];
  let best = row;
  let least = Infinity;
  for (let step = -reach; step <= reach; step++) {
    // A closed motion continues at its first row.
    const k = run.isClosed ? (((row + step) % (rows - 1)) + rows - 1) % (rows - 1) : row + step;
    if (k < 0 || k >= rows) continue;
    const [x, y] = view.screen(frames.place(anchor.body, anchor.point, k, w));
    const jump = (40 * step) / rows;
    const distance = (x - sx) ** 2 + (y - sy) ** 2 + jump * jump;
    if (distance < least) [least, best] = [distance, k];
  }
  return best;
}

// Handles pointer drags: of a body in the plane, of the view in space.
function dragging(root, { isPlane, grab, follow, turn }) {
  let held = null;
  let last = null;
  const at = event => {
    const box = root.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  root.addEventListener('pointerdown', event => {
    if (event.button !== 0) return;
    const group = event.target.closest('[data-body]');
    if (isPlane()) {
      held = group && grab(Number(group.dataset.body), at(event));
      if (!held) return;
    }
    last = at(event);
    root.setPointerCapture(event.pointerId);
    root.classList.add('held');
    event.preventDefault();
    root.focus({ preventScroll: true });
  });
  root.addEventListener('pointermove', event => {
    if (!last) return;
    const now = at(event);
    if (held) follow(held, now);
    else turn(now[0] - last[0], now[1] - last[1]);
    last = now;
  });
  const end = () => {
    held = null;
    last = null;
    root.classList.remove('held');
  };
  root.addEventListener('pointerup', end);
  root.addEventListener('pointercancel', end);
}
