// Tests of the appearance: dark theme, print, phone, reduced motion. The screenshots are kept for inspection.

import { join } from 'node:path';
import { frames } from './browser.mjs';
import { expect, same } from './expect.mjs';

const NARROW = { viewport: { width: 390, height: 844 } };

export async function lookTests({ onPage, pictures }) {
  const file = 'whole-dwell-simulate.html';
  const picture = (page, name, options) => page.screenshot({ path: join(pictures, `${name}.png`), ...options });
  const ground = page => page.evaluate(() => getComputedStyle(document.body).backgroundColor);

  await onPage('light and dark', file, async page => {
    await page.evaluate(() => window.dwellPage.move(60));
    await picture(page, 'light');
    const light = await ground(page);
    await page.click('button[aria-label="dark or light"]');
    expect((await ground(page)) !== light, 'the button does not make it dark');
    await picture(page, 'dark');
  });
  await onPage('names of the largest values are not broken within a word', file, async page => {
    const broken = await page.$$eval('.chip-name', all => all.flatMap(name => {
      const node = name.firstChild;
      let from = 0;
      return node.nodeValue.split(/(?<=[._])\u200b?/).filter(word => {
        const range = document.createRange();
        range.setStart(node, node.nodeValue.indexOf(word, from));
        from = range.startOffset + word.length;
        range.setEnd(node, from);
        return new Set([...range.getClientRects()].map(box => box.top)).size > 1;
      });
    }).join());
    same(broken, '', 'broken words');
  });

  await onPage('dark by the system', file, async page => same(await ground(page), 'rgb(22, 23, 26)', 'the ground'), { colorScheme: 'dark' });

  await onPage('a phone does not scroll sideways', file, async page => {
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    expect(wide <= 0, `${wide} pixels too wide`);
    await picture(page, 'narrow', { fullPage: true });
  }, NARROW);

  await onPage('print keeps tables and curves and drops controls', file, async page => {
    await page.emulateMedia({ media: 'print' });
    same(await page.locator('.slider').isVisible(), false, 'the slider');
    same(await page.locator('.peaks .jump').first().isVisible(), true, 'places of peaks');
    same(await page.locator('.chip').first().isVisible(), true, 'the largest values');
    await picture(page, 'print', { fullPage: true });
    await page.pdf({ path: join(pictures, 'print.pdf'), format: 'A4' });
  });

  await onPage('nothing moves by itself', file, async page => {
    const before = await page.evaluate(() => window.dwellPage.row());
    await frames(page, 25);
    same(await page.evaluate(() => window.dwellPage.row()), before, 'the row');
    same(await page.evaluate(() => document.getAnimations().length), 0, 'animations');
  }, { reducedMotion: 'reduce' });

  await onPage('the layout does not jump while it moves', file, async page => {
    const heights = new Set();
    for (let k = 0; k < 1000; k += 37) {
      heights.add(await page.evaluate(row => { window.dwellPage.move(row); return document.documentElement.scrollHeight; }, k));
    }
    same(heights.size, 1, 'heights of the page');
  });

  await onPage('a page is shown anew with other data and keeps row and curves', file, async page => {
    const result = await page.evaluate(() => {
      const own = window.dwellPage;
      const run = own.run();
      own.move(500);
      const charts = [...document.querySelectorAll('.chart-head select')].map(s => s.value).join();
      const numbers = run.numbers.map((v, k) => (Math.floor(k / run.rows) === run.axis.slot ? v : v * 1.5));
      const description = { ...run.description, title: 'Changed' };
      for (let k = 0; k < 20; k++) own.show(JSON.stringify(description), k % 2 ? run.numbers : numbers);
      return { title: document.querySelector('h1').textContent, kept: charts === [...document.querySelectorAll('.chart-head select')].map(s => s.value).join(), row: own.row(), charts: document.querySelectorAll('.chart').length };
    });
    same(result.title, 'Changed', 'the title');
    same(result.kept, true, 'the curves');
    same(result.row, 500, 'the row');
    same(result.charts, 3, 'charts');
  });

  for (const [name, other] of [['check', 'single-dwell-check'], ['reduce', 'single-dwell-reduce'], ['hostile', 'hostile-kinematics'], ['wobble', 'wobble-plate-statics'], ['space-forces', 'space-forces-kinetostatics'], ['space-reduce', 'rssr-reduce']]) {
    await onPage('picture', `${other}.html`, async page => {
      await page.evaluate(() => { if (window.dwellPage.run().rows) window.dwellPage.move(40); });
      await picture(page, name, { fullPage: true });
    });
  }
}
