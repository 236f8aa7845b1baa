// Tests of downloaded data, and of texts that contain markup.

import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { frames } from './browser.mjs';
import { parse, read } from './csv.mjs';
import { expect, same } from './expect.mjs';

async function downloaded(page, button) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.click(button)]);
  return readFileSync(await download.path(), 'utf8');
}

export async function numberTests({ onPage, pages }) {
  for (const stem of ['slider-crank-kinetostatics', 'whole-dwell-kinematics']) {
    await onPage('all data come back to the last bit', `${stem}.html`, async page => {
      const own = parse(await downloaded(page, 'button:has-text("all data")'));
      const table = read(join(pages, `${stem}.csv`));
      same(own.header.join(), table.header.join(), 'the header');
      same(own.rows.length, table.rows.length, 'rows');
      let count = 0;
      table.rows.forEach((row, k) => row.forEach((value, c) => {
        same(own.rows[k][c], value, `${table.header[c]} in row ${k}`);
        count += 1;
      }));
      console.log(`${stem}: ${count} numbers are those of the CSV`);
    });
  }

  await onPage('peaks are those of the command', 'slider-crank-kinetostatics.html', async page => {
    const lines = readFileSync(join(pages, 'slider-crank-kinetostatics-extrema.csv'), 'utf8').trim().split('\n').slice(1);
    const peaks = await page.evaluate(() => Object.fromEntries(window.dwellPage.run().columns.filter(c => c.peak).map(c => [c.key, c.peak])));
    expect(lines.length > 20, 'no peaks');
    for (const line of lines) {
      const [name, , min, minAt, max, maxAt] = line.split(',');
      const { min: low, max: high } = peaks[name];
      [[low.value, min], [low.at, minAt], [high.value, max], [high.at, maxAt]].forEach(([found, text]) => same(found, Number(text), name));
    }
  });

  await onPage('a chart is a picture by itself', 'slider-crank-kinetostatics.html', async page => {
    const text = await downloaded(page, 'button:has-text("SVG") >> nth=0');
    expect(text.startsWith('<svg') && text.includes('stroke="rgb(') && !text.includes('var(') && !text.includes('class='), text.slice(0, 200));
  });

  await onPage('the filter finds quantities, a jump goes to their peak', 'slider-crank-kinetostatics.html', async page => {
    await page.fill('input[type=search]', 'guide travel.velocity');
    same(await page.locator('.peaks tbody tr:visible').count(), 1, 'rows that are left');
    await page.click('.peaks tbody tr:visible .jump >> nth=1');
    const found = await page.evaluate(() => {
      const run = window.dwellPage.run();
      const column = run.byKey.get('guide.travel.velocity');
      const [k, most] = [window.dwellPage.row(), Math.max(...column.values)];
      return [column.values[k], most];
    });
    expect(Math.abs(found[0] - found[1]) < 1e-3 * found[1], `${found[0]} at the peak ${found[1]}`);
    await page.click('button:has-text("copy as CSV")');
    await page.waitForFunction(() => navigator.clipboard.readText().then(copied => copied.split('\n').length === 3 && copied.includes('guide.travel.velocity,m/s,')));
  });

  await onPage('a hostile title and note are text', 'hostile-kinematics.html', async (page, opened) => {
    const title = `</title></script><script>alert('title')</script><img src=x onerror="alert('image')">`;
    same(await page.textContent('h1'), title, 'the heading');
    same(await page.title(), title, 'the title');
    same(await page.locator('img, b').count(), 0, 'elements of a scene');
    await frames(page, 10);
    // A script inserted into the page does not run.
    const told = page.waitForEvent('console', message => message.type() === 'error');
    const ran = await page.evaluate(() => {
      const script = document.createElement('script');
      script.textContent = 'window.intruder = 1';
      document.body.append(script);
      return window.intruder;
    });
    same(ran, undefined, 'a script without a hash');
    await told;
    const refused = opened.faults.splice(0);
    expect(refused.length === 1 && refused[0].includes('Content Security Policy'), `the browser does not say why: ${refused}`);
  });
}
