// The overlay of the mechanism: forces as arrows, and paths of points. Check boxes select them.

// Length of the longest arrow, px. It is reduced if the arrow would leave the picture, at most by the factor LEAST_PART.
const ARROW_LENGTH = 154;
const LEAST_PART = 0.4;
// Number of rows in which the lengths are fitted to the picture, and the least distance of an arrow from its edge, px.
const ARROW_ROWS = 24;
const ARROW_EDGE = 4;

function createOverlay(first, layers, state) {
  let drawing = first;
  let run = null;
  let frames = null;
  let view = null;
  let arrows = [];
  let largest = {};
  // By group: length of the longest arrow, px.
  let lengths = {};
  const w = [0, 0, 0];
  const u = [0, 0, 0];

  // Takes a drawing of the same shape, with its run.
  function show(...next) {
    [drawing, run, frames, view] = next;
    arrows = drawing.arrows.map((arrow, index) => ({ ...arrow, index, size: sizeOf(arrow) }));
    largest = {};
    for (const arrow of arrows) largest[arrow.group] = Math.max(largest[arrow.group] || 0, arrow.size);
    state.arrows = chosen(state.arrows, arrows.filter(a => a.size > 0), a => a.initially_visible);
    state.paths = chosen(state.paths, drawing.paths, p => p.requested);
  }

  // The largest force of an arrow over all rows, N.
  function sizeOf(arrow) {
    const columns = arrow.direction === 'components' ? arrow.columns : arrow.parts.map(part => part.column);
    let most = 0;
    for (let row = 0; row < run.rows; row++) {
      let sum = 0;
      for (const k of columns) sum += run.columns[k].values[row] ** 2;
      if (sum > most) most = sum;
    }
    return Math.sqrt(most);
  }

  const elements = drawing.arrows.map(arrow => {
    const path = svg('path', { class: `force force-${arrow.group === 'Loads' ? 'load' : 'reaction'}` });
    const title = svg('title', {}, arrow.title);
    const group = svg('g', { 'data-arrow': arrow.name }, title, path);
    layers.forces.append(group);
    return { group, path };
  });
  const paths = drawing.paths.map(path => {
    const line = svg('path', { class: 'path' }, svg('title', {}, `path of ${path.name}`));
    layers.paths.append(line);
    return line;
  });

  // The point of application of a force (m) and its vector (N), in the axes of the ground.
  function forceOf(arrow, row) {
    const value = k => run.columns[k].values[row];
    if (arrow.direction === 'line') {
      const [a, b] = arrow.ends.map(end => [...frames.place(end.body, end.point, row, w)]);
      const d = [b[0] - a[0], b[1] - a[1]];
      const length = Math.hypot(...d) || 1;
      const [x, y] = d.map(c => c / length);
      const [along, across] = [0, 1].map(k => arrow.parts.reduce((sum, part) => sum + part.axis[k] * value(part.column), 0));
      return [[a[0] + arrow.place * d[0], a[1] + arrow.place * d[1], 0], [along * x - across * y, along * y + across * x, 0]];
    }
    const at = [...frames.place(arrow.at.body, arrow.at.point, row, w)];
    if (arrow.direction === 'components') return [at, [value(arrow.columns[0]), value(arrow.columns[1]), arrow.columns.length > 2 ? value(arrow.columns[2]) : 0]];
    if (arrow.offset.length) frames.direct(arrow.body, arrow.offset, row, u).forEach((c, k) => { at[k] += c; });
    const force = [0, 0, 0];
    for (const part of arrow.parts) frames.direct(arrow.body, part.axis, row, u).forEach((c, k) => { force[k] += c * value(part.column); });
    return [at, force];
  }

  // Tail and vector of an arrow in a row, px. `length` is the length of the arrow for the largest force of the group.
  function onScreen(arrow, row, length) {
    const [at, force] = forceOf(arrow, row);
    const scale = largest[arrow.group] > 0 ? length / (largest[arrow.group] * view.scale) : 0;
    return [...view.screen(at), ...view.direction(force.map(c => c * scale))];
  }

  // Chooses the lengths so that arrows stay in the picture. A group has one scale in all rows, independent of the selection.
  function fitLengths(width, height) {
    lengths = {};
    // In space no fit is made, because the scale would change while the view is turned.
    const stride = Math.max(1, Math.floor(run.rows / ARROW_ROWS));
    for (const arrow of arrows) {
      let part = lengths[arrow.group] === undefined ? 1 : lengths[arrow.group] / ARROW_LENGTH;
      for (let row = 0; frames.isPlane && row < run.rows; row += stride) {
        const [x, y, dx, dy] = onScreen(arrow, row, ARROW_LENGTH);
        for (const [from, by, end] of [[x, dx, width], [y, dy, height]]) {
          const free = by < 0 ? from - ARROW_EDGE : end - ARROW_EDGE - from;
          if (free < part * Math.abs(by)) part = Math.max(LEAST_PART, free / Math.abs(by));
        }
      }
      lengths[arrow.group] = part * ARROW_LENGTH;
    }
  }

  function layOut() {
    drawing.paths.forEach((path, k) => {
      const isShown = state.paths.has(path.name);
      paths[k].style.display = isShown ? '' : 'none';
      if (!isShown) return;
      let d = '';
      const stride = Math.max(1, Math.floor(run.rows / 720));
      for (let row = 0; row < run.rows; row += stride) {
        const [x, y] = view.screen(frames.place(path.at.body, path.at.point, row, w));
        d += `${d ? 'L' : 'M'}${tenth(x)} ${tenth(y)}`;
      }
      paths[k].setAttribute('d', d);
    });
    arrows.forEach((arrow, k) => { elements[k].group.style.display = state.arrows.has(arrow.name) && state.forces !== false ? '' : 'none'; });
    layers.paths.style.display = state.showPaths === false ? 'none' : '';
  }

  function move(row) {
    if (state.forces === false) return;
    arrows.forEach((arrow, k) => {
      if (state.arrows.has(arrow.name)) elements[k].path.setAttribute('d', arrowPath(...onScreen(arrow, row, lengths[arrow.group])));
    });
  }

  return { show, fitLengths, layOut, move, arrows: () => arrows, paths: () => drawing.paths };
}

// The names of the shown items. Names that the user has seen keep their state; a new name is shown if `isFirst` says so.
function chosen(before, all, isFirst) {
  const names = before || Object.assign(new Set(), { known: new Set() });
  for (const one of all) {
    if (names.known.has(one.name)) continue;
    names.known.add(one.name);
    if (isFirst(one)) names.add(one.name);
  }
  return names;
}

// The path of an arrow from a point (x, y); empty if the arrow is at most 2 px long.
function arrowPath(x, y, dx, dy) {
  const length = Math.hypot(dx, dy);
  if (!(length > 2)) return '';
  const [ux, uy] = [dx / length, dy / length];
  const head = Math.min(11, 0.6 * length);
  const [tx, ty] = [x + dx, y + dy];
  const [bx, by] = [tx - ux * head, ty - uy * head];
  const half = 0.42 * head;
  return `M${x} ${y}L${bx} ${by}M${tx} ${ty}L${bx - uy * half} ${by + ux * half}L${bx + uy * half} ${by - ux * half}Z`;
}
