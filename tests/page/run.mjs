// Tests of the HTML pages in a real browser.
//
//     node run.mjs PAGES REPORTS
//
// PAGES is the folder that make.sh fills; REPORTS is the folder that `dwell validate` fills. Screenshots go to PAGES/pictures.

import { mkdirSync, readdirSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { launch, open, openRun } from './browser.mjs';
import { arrowTests } from './arrows.mjs';
import { chartTests } from './charts.mjs';
import { lookTests } from './look.mjs';
import { mechanismTests } from './mechanism.mjs';
import { numberTests } from './numbers.mjs';

const [pages, reports] = process.argv.slice(2);
if (!pages || !reports) {
  console.error('usage: node run.mjs PAGES REPORTS');
  process.exit(2);
}
const pictures = join(pages, 'pictures');
mkdirSync(pictures, { recursive: true });

const browser = await launch();
const failures = [];
let count = 0;

// Runs a named test. It fails if its body throws or its page has a fault.
async function test(name, body) {
  count += 1;
  try {
    await body();
  } catch (error) {
    failures.push(`${name}: ${error.message}`);
    console.log(`FAIL ${name}: ${error.message.split('\n')[0]}`);
  }
}

// Runs a test on a page of PAGES.
const onPage = (name, file, body, options) => test(`${file}: ${name}`, async () => {
  const opened = await openRun(browser, join(pages, file), options);
  try {
    await body(opened.page, opened);
    if (opened.faults.length) throw new Error(opened.faults.join('; '));
  } finally {
    await opened.context.close();
  }
});

const tools = { test, onPage, pages, pictures };
await mechanismTests(tools);
await arrowTests(tools);
await chartTests(tools);
await numberTests(tools);
await lookTests(tools);

const htmlOf = folder => readdirSync(folder).filter(file => file.endsWith('.html')).map(file => join(folder, file));

// Every page opens without errors and requests, and shows contents.
for (const file of [...htmlOf(pages), ...htmlOf(reports)]) {
  await test(file, async () => {
    const { page, faults, context } = await open(browser, file);
    const isRun = await page.evaluate(() => Boolean(document.getElementById('page-description')));
    if (isRun) await page.waitForFunction(() => document.documentElement.dataset.ready === 'yes', null, { timeout: 60000 });
    const heading = await page.textContent('h1');
    if (!heading) throw new Error('no heading');
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    if (isRun && wide > 1) throw new Error(`the page is ${wide} pixels too wide`);
    await context.close();
    // Documents load the pictures beside them.
    const real = isRun || file.endsWith('index.html') ? faults : faults.filter(fault => !/request: file:.*\.png$/.test(fault));
    if (real.length) throw new Error(real.join('; '));
  });
}

const size = file => statSync(file).size;
await test('sizes', async () => {
  const limits = [[join(pages, 'whole-dwell-kinematics.html'), 900e3], [join(pages, 'whole-dwell-simulate.html'), 900e3], [join(reports, 'index.html'), 300e3]];
  for (const [file, limit] of limits) {
    console.log(`${file}: ${Math.round(size(file) / 1000)} kB`);
    if (size(file) > limit) throw new Error(`${file} has ${size(file)} bytes, more than ${limit}`);
  }
});

await browser.close();
console.log(`${count - failures.length} of ${count} tests of pages pass`);
process.exit(failures.length ? 1 : 0);
