// Positions of points of bodies in a row, and in the picture.

// Placements of the bodies. `place` and `direct` write x, y, z into `out`.
function createFrames(drawing, run) {
  const bodies = drawing.bodies.map(body => body.placements.map(k => run.slot(k)));
  const isPlane = drawing.view === null;
  // By body: cosine and sine of its angle in each row.
  const turns = bodies.map(p => (isPlane && p.length ? [Float64Array.from(p[2], Math.cos), Float64Array.from(p[2], Math.sin)] : null));
  function place(body, point, row, out) {
    const p = bodies[body];
    const [x, y] = point;
    if (!p.length) {
      out[0] = x; out[1] = y; out[2] = point[2] || 0;
      return out;
    }
    if (isPlane) {
      const [cos, sin] = [turns[body][0][row], turns[body][1][row]];
      out[0] = p[0][row] + cos * x - sin * y;
      out[1] = p[1][row] + sin * x + cos * y;
      out[2] = 0;
      return out;
    }
    turn(p, point, row, out);
    for (let k = 0; k < 3; k++) out[k] += p[k][row];
    return out;
  }
  // A direction of a body in the axes of the ground.
  function direct(body, axis, row, out) {
    const p = bodies[body];
    if (!p.length) {
      out[0] = axis[0]; out[1] = axis[1]; out[2] = axis[2] || 0;
    } else if (isPlane) {
      const [cos, sin] = [turns[body][0][row], turns[body][1][row]];
      out[0] = cos * axis[0] - sin * axis[1];
      out[1] = sin * axis[0] + cos * axis[1];
      out[2] = 0;
    } else turn(p, axis, row, out);
    return out;
  }
  // The third column of a rotation is the cross product of the first two.
  function turn(p, v, row, out) {
    const [a, b, c, d, e, f] = [p[3][row], p[4][row], p[5][row], p[6][row], p[7][row], p[8][row]];
    out[0] = a * v[0] + d * v[1] + (b * f - c * e) * v[2];
    out[1] = b * v[0] + e * v[1] + (c * d - a * f) * v[2];
    out[2] = c * v[0] + f * v[1] + (a * e - b * d) * v[2];
  }
  return { isPlane, place, direct, isFixed: body => !bodies[body].length, placement: (body, row) => bodies[body].map(p => p[row]) };
}

// An orthographic view: unit vectors to the right, upwards and towards the viewer, and the origin and scale in the picture.
function createView(angles) {
  const view = { scale: 1, x: 0, y: 0, right: [1, 0, 0], up: [0, 1, 0], toward: [0, 0, 1], angles: null };
  view.look = (azimuth, elevation) => {
    const [sa, ca, se, ce] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation), Math.cos(elevation)];
    view.angles = [azimuth, elevation];
    view.toward = [ce * ca, ce * sa, se];
    view.right = [-sa, ca, 0];
    view.up = [-se * ca, -se * sa, ce];
  };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  view.screen = w => [view.x + view.scale * dot(view.right, w), view.y - view.scale * dot(view.up, w)];
  view.direction = w => [view.scale * dot(view.right, w), -view.scale * dot(view.up, w)];
  view.nearness = w => dot(view.toward, w);
  if (angles) view.look(angles[0], angles[1]);
  return view;
}

// The bounding box of all parts over the run, by middle and sides, and the radius of the bounding sphere about this middle.
function boundsOf(drawing, frames, rows) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const w = [0, 0, 0];
  const points = [];
  const stride = Math.max(1, Math.floor(rows / 180));
  const add = (body, point, fixed) => {
    for (let row = 0; row < Math.max(1, fixed ? 1 : rows); row += stride) {
      frames.place(body, point, row, w);
      for (let k = 0; k < 3; k++) {
        if (w[k] < low[k]) low[k] = w[k];
        if (w[k] > high[k]) high[k] = w[k];
      }
      if (!frames.isPlane) points.push([...w]);
    }
  };
  for (const part of drawing.parts) {
    if (part.part === 'outline') {
      if (part.look === 'wheel') {
        const [[x, y], [r]] = part.points;
        for (const [dx, dy] of [[r, 0], [-r, 0], [0, r], [0, -r]]) add(part.body, [x + dx, y + dy], frames.isFixed(part.body));
      } else for (const point of part.points) add(part.body, point, frames.isFixed(part.body));
    } else if (part.part === 'link') for (const end of part.ends) add(end.body, end.point, frames.isFixed(end.body));
    else add(part.at.body, part.at.point, frames.isFixed(part.at.body));
  }
  if (!(low[0] <= high[0])) return { middle: [0, 0, 0], size: [1, 1, 1], radius: 1 };
  const middle = low.map((l, k) => 0.5 * (l + high[k]));
  const radius = Math.sqrt(Math.max(...points.map(p => (p[0] - middle[0]) ** 2 + (p[1] - middle[1]) ** 2 + (p[2] - middle[2]) ** 2)));
  return { middle, size: low.map((l, k) => high[k] - l), radius };
}
