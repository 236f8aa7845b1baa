// Tests of charts: read-out, zoom, selection of curves, and state in the address.

import { join } from 'node:path';
import { openRun, launch } from './browser.mjs';
import { expect, same } from './expect.mjs';

const file = 'slider-crank-kinetostatics.html';
const ticks = page => page.$$eval('.chart', all => all.map(c => [...c.querySelectorAll('.axes text')].map(t => t.textContent).join(' ')));

export async function chartTests({ onPage, test, pages }) {
  await onPage('hovering a curve moves everything', file, async page => {
    const box = await page.locator('.chart').nth(1).boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + 60);
    const k = await page.evaluate(() => window.dwellPage.row());
    expect(Math.abs(k - 180) < 25, `row ${k} in the middle of a chart`);
    const x = await page.$$eval('.chart .cursor', all => all.map(c => c.getAttribute('transform')));
    expect(new Set(x).size === 1 && x.length === 3, `the cursors are apart: ${x}`);
    same(await page.inputValue('.slider'), String(k), 'the slider');
  });

  await onPage('a drag zooms all charts, Escape shows all', file, async page => {
    const before = await ticks(page);
    const box = await page.locator('.chart').first().boundingBox();
    await page.mouse.move(box.x + 200, box.y + 60);
    await page.mouse.down();
    await page.mouse.move(box.x + 300, box.y + 60, { steps: 4 });
    await page.mouse.up();
    const zoomed = await ticks(page);
    zoomed.forEach((text, k) => expect(text !== before[k], `chart ${k + 1} is not zoomed`));
    await page.waitForFunction(() => location.hash.includes('zoom='));
    await page.keyboard.press('Escape');
    same((await ticks(page)).join(), before.join(), 'the axes after Escape');
  });

  await onPage('the address brings row, curves and units back', file, async page => {
    await page.selectOption('.chart-head select >> nth=0', { index: 2 });
    await page.click('.badge ~ button >> nth=0');
    await page.keyboard.press('End');
    await page.waitForFunction(() => ['at=', 'units=si', 'chart1='].every(part => location.hash.includes(part)));
    const hash = await page.evaluate(() => location.hash);
    const chosen = await page.locator('.chart-head select').first().inputValue();
    const browser = await launch();
    const { page: other } = await openRun(browser, join(pages, file), { hash });
    same(await other.locator('.chart-head select').first().inputValue(), chosen, 'the chosen curves');
    same(await other.evaluate(() => window.dwellPage.row()), 360, 'the row');
    same((await other.textContent('.badge ~ button >> nth=0')), 'rad, m', 'the units');
    await browser.close();
  });

  await onPage('a chart says its extremes', file, async page => {
    const label = await page.locator('.chart').first().getAttribute('aria-label');
    expect(/^Chart over t: A\.magnitude from [\d.]+ N at [\d.]+ s to [\d.]+ N at [\d.]+ s/.test(label), label);
  });

  await onPage('a curve can be taken out and brought in', file, async page => {
    const chart = page.locator('.chart-card').first();
    await chart.locator('.picker summary').click();
    await chart.locator('.picker-list input').first().click();
    same(await chart.locator('.legend li').count(), 3, 'curves that are left');
    same(await chart.locator('path.curve').count(), 3, 'curves that are drawn');
  });

  await test('a move of the slider with six curves (reported)', async () => {
    const browser = await launch();
    const { page } = await openRun(browser, join(pages, 'whole-dwell-simulate.html'));
    const cost = await page.evaluate(async () => {
      const curves = document.querySelectorAll('path.curve').length;
      const times = [];
      for (let k = 0; k < 400; k++) {
        const from = performance.now();
        window.dwellPage.move((k * 7) % window.dwellPage.run().rows);
        times.push(performance.now() - from);
        if (k % 20 === 0) await new Promise(requestAnimationFrame);
      }
      times.sort((a, b) => a - b);
      return { curves, median: times[200], most: times[395] };
    });
    console.log(`one move with ${cost.curves} curves: ${cost.median.toFixed(2)} ms of script (median), ${cost.most.toFixed(2)} ms (99 of 100)`);
    await browser.close();
  });
}
