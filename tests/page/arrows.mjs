// Tests of force arrows at contacts: origin, direction and length, compared with the table of the command.

import { join } from 'node:path';
import { read } from './csv.mjs';
import { expect, same } from './expect.mjs';

// Reads the table of a command; `value(row, name)` is a number of it.
function table(pages, stem) {
  const { header, rows } = read(join(pages, `${stem}.csv`));
  const names = header.map(name => name.replace(/ \[.*/, ''));
  return { rows: rows.length, value: (row, name) => {
    expect(names.includes(name), `no column ${name}`);
    return rows[row][names.indexOf(name)];
  } };
}

// Tail and tip of an arrow on the screen, px; null for an arrow that is too short to be drawn.
async function drawn(page, name) {
  const d = await page.getAttribute(`[data-arrow="${name}"] path`, 'd');
  const ends = /^M([-\d.e]+) ([-\d.e]+)L[^M]*M([-\d.e]+) ([-\d.e]+)/.exec(d || '');
  return ends && ends.slice(1).map(Number);
}

// The map from points of the ground (m) to the screen (px), from the transform of a body in the plane whose origin is known.
async function byBody(page, body, [ax, ay]) {
  const all = await page.$$eval('.mechanism g[data-body][transform^=matrix]', (groups, own) => groups.filter(g => g.querySelector('title').textContent === own).map(g => g.getAttribute('transform')), body);
  const [a, b, , , x, y] = all[0].match(/-?\d[\d.e-]*/g).map(Number);
  const scale = Math.hypot(a, b);
  return point => [x + scale * (point[0] - ax), y - scale * (point[1] - ay)];
}

// The same map, from the marks of two joints.
async function byMarks(page, [[one, [ax, ay]], [other, [bx, by]]]) {
  const place = async joint => {
    const texts = await page.$$eval('.mechanism .mark', (all, own) => all.filter(m => m.querySelector('title').textContent.startsWith(own)).map(m => m.getAttribute('transform')), `${joint} (`);
    return texts[0].match(/-?\d[\d.e-]*/g).map(Number);
  };
  const [a, b] = [await place(one), await place(other)];
  const scale = Math.hypot(b[0] - a[0], b[1] - a[1]) / Math.hypot(bx - ax, by - ay);
  return ([x, y]) => [a[0] + scale * (x - ax), a[1] - scale * (y - ay)];
}

// Compares arrows with forces in the given rows. `expected(row)` returns the map to the screen and, for each arrow, its point and its
// force in the axes of the ground. All arrows must have the same scale in px/N.
async function compare(page, rows, expected) {
  let scale = null;
  let count = 0;
  for (const row of rows) {
    await page.evaluate(k => window.dwellPage.move(k), row);
    const { screen, forces } = expected(row);
    const toScreen = await screen;
    for (const [name, [place, [fx, fy]]] of Object.entries(forces)) {
      const found = await drawn(page, name);
      const size = Math.hypot(fx, fy);
      if (!found) {
        expect(scale !== null && size * scale < 2.1, `${name} in row ${row} is not drawn, with ${size} N`);
        continue;
      }
      const [x, y, tx, ty] = found;
      const [sx, sy] = toScreen(place);
      // Bodies are drawn in single precision.
      expect(Math.hypot(x - sx, y - sy) < 1e-3, `${name} in row ${row} begins at ${x}, ${y} instead of ${sx}, ${sy}`);
      if (scale === null) scale = Math.hypot(tx - x, ty - y) / size;
      const off = Math.hypot(tx - x - scale * fx, ty - y + scale * fy);
      expect(off < 1e-3, `${name} in row ${row} ends ${off} px beside its force of ${fx}, ${fy} N`);
      count += 1;
    }
  }
  expect(count > rows.length, `only ${count} arrows are drawn`);
}

export async function arrowTests({ onPage, pages, pictures }) {
  const rowsOf = count => [5, Math.floor(count / 3), Math.floor(0.6 * count), count - 3];

  await onPage('the forces of teeth are those of the CSV', 'planetary-teeth-kinetostatics.html', async page => {
    const { rows, value } = table(pages, 'planetary-teeth-kinetostatics');
    // The reaction on the sun is hidden by default.
    const hidden = '[data-arrow="inner.line-of-action on sun"]';
    expect(await page.locator(hidden).evaluate(g => g.style.display === 'none'), 'the reaction is shown at first');
    await page.click('summary[aria-label="which forces"]');
    await page.click('.choices label:text-is("inner.line-of-action on sun")');
    await page.click('.choices label:text-is("outer on ground")');
    await page.click('summary[aria-label="which forces"]');
    await compare(page, rowsOf(rows), row => {
      const center = [value(row, 'planet.C.x'), value(row, 'planet.C.y')];
      const length = Math.hypot(...center);
      const [ux, uy] = center.map(c => c / length);
      const [tooth, away, ring] = ['inner.tooth', 'inner.separating', 'outer.tooth'].map(name => value(row, name));
      // A positive tooth force turns the planet counter-clockwise. The sun touches the planet at 30 mm from the central axis, the ring at
      // 70 mm.
      const [inner, outer] = [0.03, 0.07].map(r => [r * ux, r * uy]);
      const tangential = [uy * tooth, -ux * tooth];
      const separating = [ux * away, uy * away];
      const whole = [0, 1].map(k => tangential[k] + separating[k]);
      const outside = [-uy * ring, ux * ring];
      return {
        screen: byBody(page, 'planet', center),
        forces: {
          inner: [inner, tangential],
          'inner.separating': [inner, separating],
          'inner.line-of-action': [inner, whole],
          'inner.line-of-action on sun': [inner, whole.map(c => -c)],
          outer: [outer, outside],
          'outer on ground': [outer, outside.map(c => -c)],
        },
      };
    });
    await page.screenshot({ path: join(pictures, 'teeth.png') });
  });

  // In this run the picture has room for the longest possible arrow, 154 px.
  await onPage('arrows stay in the picture', 'slider-crank-kinetostatics.html', async page => {
    const found = await page.evaluate(() => {
      const picture = document.querySelector('svg.mechanism');
      const { width, height } = picture.viewBox.baseVal;
      const tips = [];
      let longest = 0;
      for (let row = 0; row < window.dwellPage.run().rows; row += 7) {
        window.dwellPage.move(row);
        for (const arrow of picture.querySelectorAll('[data-arrow]')) {
          const ends = /^M([-\d.e]+) ([-\d.e]+)L[^M]*M([-\d.e]+) ([-\d.e]+)/.exec(arrow.querySelector('path').getAttribute('d') || '');
          if (!ends) continue;
          const [x, y, tx, ty] = ends.slice(1).map(Number);
          longest = Math.max(longest, Math.hypot(tx - x, ty - y));
          if (tx < 0 || ty < 0 || tx > width || ty > height) tips.push(`${arrow.dataset.arrow} in row ${row}`);
        }
      }
      return { tips: tips.join(), longest };
    });
    same(found.tips, '', 'tips beyond the picture');
    expect(found.longest > 60 && found.longest < 155, `the longest arrow has ${found.longest} px`);
  });

  await onPage('the forces of a rack are at its pitch point', 'rack-pinion-teeth-kinetostatics.html', async page => {
    const { rows, value } = table(pages, 'rack-pinion-teeth-kinetostatics');
    await compare(page, rowsOf(rows), row => {
      const [tooth, away] = [value(row, 'mesh.tooth'), value(row, 'mesh.separating')];
      const pitch = [0, -0.02];
      return {
        screen: byBody(page, 'pinion', [0, 0]),
        forces: { mesh: [pitch, [tooth, 0]], 'mesh.separating': [pitch, [0, away]], 'mesh.line-of-action': [pitch, [tooth, away]] },
      };
    });
    await page.screenshot({ path: join(pictures, 'rack.png') });
  });

  await onPage('a rolling wheel has its force where it touches', 'rolling-wheel-kinetostatics.html', async page => {
    const { rows, value } = table(pages, 'rolling-wheel-kinetostatics');
    await compare(page, rowsOf(rows), row => ({
      screen: byBody(page, 'wheel', [value(row, 'wheel.C.x'), value(row, 'wheel.C.y')]),
      forces: {
        track: [[value(row, 'wheel.C.x'), value(row, 'wheel.C.y') - 0.2], [value(row, 'track.tangent'), value(row, 'track.normal')]],
        H: [[value(row, 'rod.H.x'), value(row, 'rod.H.y')], [value(row, 'H.x'), value(row, 'H.y')]],
      },
    }));
    await page.screenshot({ path: join(pictures, 'rolling.png') });
  });

  await onPage('a coupling pushes its follower', 'cam-whole-kinetostatics.html', async page => {
    const { rows, value } = table(pages, 'cam-whole-kinetostatics');
    await compare(page, rowsOf(rows), row => ({
      screen: byBody(page, 'cam', [0, 0]),
      forces: {
        contact: [[value(row, 'follower.F.x'), value(row, 'follower.F.y')], [0, value(row, 'contact.force')]],
        O: [[0, 0], [value(row, 'O.x'), value(row, 'O.y')]],
      },
    }));
    await page.screenshot({ path: join(pictures, 'cam.png') });
  });

  await onPage('teeth in space push along their normal at the pitch point', 'bevel-kinetostatics.html', async page => {
    const { rows, value } = table(pages, 'bevel-kinetostatics');
    const [azimuth, elevation] = await page.evaluate(() => window.dwellPage.run().description.drawing.view);
    const [sa, ca, se, ce] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation), Math.cos(elevation)];
    // The projection to the picture: components to the right and upwards.
    const seen = ([x, y, z]) => [ca * y - sa * x, ce * z - se * (ca * x + sa * y)];
    const vector = (row, name) => ['x', 'y', 'z'].map(axis => value(row, `${name}.${axis}`));
    const forces = row => Object.fromEntries([['left-teeth', 'carrier.L'], ['right-teeth', 'carrier.R']].map(([teeth, point]) => {
      const force = vector(row, teeth);
      // The normal turns with the cage about x.
      const turn = value(row, 'carrier.rotation.x');
      const along = -Math.sin(turn) * force[1] + Math.cos(turn) * force[2];
      expect(Math.abs(Math.hypot(...force) - Math.abs(along)) < 1e-9 * Math.abs(along), `${teeth}: ${force} is not along the normal`);
      return [teeth, [seen(vector(row, point)), seen(force)]];
    }));
    await compare(page, rowsOf(rows), row => ({ screen: byMarks(page, [['left', [0, 0]], ['planet', seen(vector(row, 'planet.P'))]]), forces: forces(row) }));
    await page.screenshot({ path: join(pictures, 'bevel.png') });
  });
}
