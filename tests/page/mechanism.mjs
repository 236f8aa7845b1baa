// Tests of the picture of the mechanism, its slider and its keys.

import { join } from 'node:path';
import { frames } from './browser.mjs';
import { read } from './csv.mjs';
import { expect, near, printed, same } from './expect.mjs';

const row = page => page.evaluate(() => window.dwellPage.row());

export async function mechanismTests({ onPage, pages, pictures }) {
  const file = 'slider-crank-kinetostatics.html';
  await onPage('the slider reads the numbers of the CSV', file, async page => {
    const table = read(join(pages, 'slider-crank-kinetostatics.csv'));
    await page.click('button:has-text("°, mm")');
    const box = await page.locator('.slider').boundingBox();
    await page.mouse.move(box.x + 8, box.y + box.height / 2);
    await page.mouse.down();
    for (const part of [0.2, 0.6, 0.35]) {
      await page.mouse.move(box.x + box.width * part, box.y + box.height / 2, { steps: 4 });
      const k = await row(page);
      expect(k > 0 && k < table.rows.length, `row ${k}`);
      const shown = await page.$$eval('.legend li', all => all.map(li => [li.querySelector('.name').textContent, li.querySelector('.value').textContent]));
      expect(shown.length >= 5, 'no curves');
      for (const [name, text] of shown) {
        const column = table.header.findIndex(h => h.replace(/ \[.*/, '') === name);
        near(printed(text), table.rows[k][column], 1e-4, `${name} in row ${k}`);
      }
      const now = await page.$$eval('.now[data-value]', all => all.map(td => [td.closest('tr').querySelector('.name').textContent, td.dataset.value]));
      for (const [name, value] of now) {
        const column = table.header.findIndex(h => h.replace(/ \[.*/, '') === name);
        same(Number(value), table.rows[k][column], `${name} in row ${k}`);
      }
    }
    await page.mouse.up();
  });

  await onPage('keys move the row', file, async page => {
    await page.locator('.mechanism').focus();
    const steps = [['ArrowRight', 1], ['Shift+ArrowRight', 11], ['ArrowLeft', 10], ['End', 360], ['Home', 0]];
    for (const [key, expected] of steps) {
      await page.keyboard.press(key);
      same(await row(page), expected, key);
    }
    await page.keyboard.press('Space');
    await page.waitForFunction(() => window.dwellPage.row() > 3);
    await page.keyboard.press('Space');
    const at = await row(page);
    await frames(page, 10);
    same(await row(page), at, 'the row after a pause');
    const text = await page.getAttribute('.slider', 'aria-valuetext');
    expect(/^t = .* s$/.test(text), `aria-valuetext ${text}`);
  });

  await onPage('the crank follows the pointer', file, async page => {
    // The crank connects A, on the ground, and B: the first two pins.
    const [center, from] = await page.$$eval('.mark-pin .pin', all => all.map(pin => {
      const b = pin.getBoundingClientRect();
      return [b.x + b.width / 2, b.y + b.height / 2];
    }));
    const [dx, dy] = [from[0] - center[0], from[1] - center[1]];
    // A point on the bar, a little inside the pin.
    await page.mouse.move(center[0] + 0.8 * dx, center[1] + 0.8 * dy);
    await page.mouse.down();
    const turn = angle => [center[0] + 0.8 * (dx * Math.cos(angle) + dy * Math.sin(angle)), center[1] + 0.8 * (dy * Math.cos(angle) - dx * Math.sin(angle))];
    for (let k = 1; k <= 20; k++) await page.mouse.move(...turn(0.05 * k));
    await page.mouse.up();
    const coordinate = await page.evaluate(() => {
      const run = window.dwellPage.run();
      const { values } = run.byKey.get('phi');
      return values[window.dwellPage.row()] - values[0];
    });
    expect(Math.abs(coordinate - 1) < 0.12, `the crank has turned by ${coordinate} rad instead of 1`);
    await page.screenshot({ path: join(pictures, 'slider-crank-dragged.png') });
  });

  await onPage('the view in space turns', 'rssr-kinematics.html', async page => {
    const drawn = () => page.$$eval('.mechanism path', all => all.map(p => p.getAttribute('d')).join());
    const before = await drawn();
    await page.screenshot({ path: join(pictures, 'space.png'), fullPage: true });
    const box = await page.locator('.mechanism').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 90, box.y + box.height / 2 + 30, { steps: 5 });
    await page.mouse.up();
    expect((await drawn()) !== before, 'the view has not turned');
    expect((await page.locator('.mechanism .bar').count()) > 1, 'no bars');
    await page.screenshot({ path: join(pictures, 'space-turned.png') });
    await page.waitForFunction(() => location.hash.includes('view='));
  });
}
