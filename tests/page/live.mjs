// Tests of the live page in a real browser.
//
//     node live.mjs WEB PAGES
//
// WEB is the folder that `just web` fills; PAGES is a folder for scenes, results and pictures.

import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { deflateRawSync } from 'node:zlib';
import { frames, launch, open } from './browser.mjs';
import { carelessTests } from './careless.mjs';
import { parse } from './csv.mjs';
import { expect, same } from './expect.mjs';

const [web, pages] = process.argv.slice(2);
if (!web || !pages) {
  console.error('usage: node live.mjs WEB PAGES');
  process.exit(2);
}
const top = join(dirname(fileURLToPath(import.meta.url)), '../..');
const dwell = join(top, 'target/release/dwell');
const pictures = join(pages, 'pictures');
const scratch = join(pages, 'live');
mkdirSync(pictures, { recursive: true });
mkdirSync(scratch, { recursive: true });
const file = join(web, 'dwell.html');
const caseText = name => readFileSync(join(top, 'validation', name, 'scene.toml'), 'utf8');

const browser = await launch();
const failures = [];
let count = 0;

// Runs a test on the live page. It fails if its body throws or the page has a fault.
async function test(name, body, options = {}) {
  count += 1;
  const opened = await open(browser, options.file || file, { reducedMotion: 'reduce', ...options });
  try {
    await settled(opened.page);
    await body(opened.page, opened);
    const faults = opened.faults.filter(fault => !(options.allowed && options.allowed.test(fault)));
    if (faults.length) throw new Error(faults.join('; '));
  } catch (error) {
    failures.push(name);
    console.log(`FAIL ${name}: ${error.message.split('\n')[0]}`);
  } finally {
    await opened.context.close();
  }
}

const settled = page => page.waitForFunction(() => document.body.dataset.state === 'settled', null, { timeout: 90000 });
const area = '.live-editor textarea';
const text = page => page.inputValue(area);
const status = page => page.textContent('#live-status');

// Replaces the whole text in one change, as pasting does; typing would be one change for each line.
async function paste(page, scene) {
  await page.evaluate(([selector, value]) => {
    const field = document.querySelector(selector);
    field.value = value;
    field.dispatchEvent(new Event('input', { bubbles: true }));
  }, [area, scene]);
}

async function write(page, scene) {
  await paste(page, scene);
  await settled(page);
}

async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.click(button)]);
  return { name: download.suggestedFilename(), text: readFileSync(await download.path(), 'utf8') };
}

// The table that a command writes for the text of a scene.
function table(command, scene) {
  const path = join(scratch, 'scene.toml');
  writeFileSync(path, scene);
  execFileSync(dwell, [command, path, '--pictures', 'none', '--name', 'cli', '--out', scratch], { stdio: 'ignore' });
  const names = { simulate: 'motion', reduce: 'reduced' };
  return parse(readFileSync(join(scratch, `cli-${names[command] || command}.csv`), 'utf8'));
}

// Compares all columns with those of the command, to 1e-13 of the largest value of each unit.
function compare(shown, expected, what) {
  const unit = name => (/\[(.*)\]$/.exec(name) || ['', ''])[1];
  const scales = new Map();
  expected.header.forEach((name, k) => {
    const largest = Math.max(...expected.rows.map(row => Math.abs(row[k])).filter(Number.isFinite));
    scales.set(unit(name), Math.max(scales.get(unit(name)) || 0, largest));
  });
  same(shown.rows.length, expected.rows.length, `${what}: rows`);
  expected.header.forEach((name, k) => {
    const at = shown.header.indexOf(name);
    expect(at >= 0, `${what}: no column ${name}`);
    for (let row = 0; row < expected.rows.length; row++) {
      const [a, b] = [shown.rows[row][at], expected.rows[row][k]];
      const isSame = Number.isNaN(a) ? Number.isNaN(b) : Math.abs(a - b) <= 1e-13 * scales.get(unit(name));
      expect(isSame, `${what}: ${name} in row ${row}: ${a} instead of ${b}`);
    }
  });
}

// The scene with its first nonzero length multiplied by a factor.
const longer = (scene, part) => scene.replace(/(points = \{[^}]*\[)([1-9]\d*\.?\d*)/, (_, before, number) => `${before}${Number(number) * part}`);

const SAVE_CSV = '.dwell-page button:text("all data")';

await test('a changed length gives the numbers of the command line', async page => {
  const scene = longer(caseText('jansen'), 1.01);
  await write(page, scene);
  compare(parse((await saved(page, SAVE_CSV)).text), table('kinetostatics', scene), 'kinetostatics');
  await page.screenshot({ path: join(pictures, 'live-jansen.png') });
});

// All results of the page, as text.
const shownResults = async page => {
  // The table fills in the values of the current row after an observer has reported its visible lines.
  await frames(page, 3);
  return page.evaluate(shownNow);
};

const shownNow = () => {
  const all = (selector, of) => [...document.querySelectorAll(selector)].map(of);
  const attributes = element => [...element.attributes].map(a => `${a.name}=${a.value}`).sort().join(' ');
  return {
    lines: all('.peaks tbody tr', line => [...line.children].map(cell => cell.textContent + [...cell.querySelectorAll('path')].map(attributes) + cell.title).join('|')),
    chips: all('.chip', chip => `${chip.title} ${[...chip.children].map(part => part.textContent)}`),
    charts: all('.chart *', element => attributes(element) + (element.children.length ? '' : element.textContent)),
    said: all('.chart', chart => chart.getAttribute('aria-label')),
    legends: all('.legend li, .chart-head select', element => element.textContent),
    mechanism: all('svg.mechanism *', element => attributes(element) + (element.children.length ? '' : element.textContent)),
    choices: all('.choices label', label => label.textContent),
    words: all('.words .card', card => card.textContent),
  };
};

// The changes are so small that the same curves vary most, because charts keep their curves while a scene is edited.
for (const [name, changed] of [['jansen', scene => longer(scene, 1.001)], ['spatial/rssr', scene => scene.replace(/mass = (\d+\.?\d*)/, (_, mass) => `mass = ${1.5 * mass}`)]]) {
  await test(`a change of ${name} shows what is shown without the scene before it`, async page => {
    const before = name.includes('/') ? readFileSync(join(top, 'validation', `${name}.toml`), 'utf8') : caseText(name);
    const after = changed(before);
    expect(after !== before, 'nothing is changed');
    const first = page.url();
    await write(page, after);
    const expected = await shownResults(page);
    await page.goto('about:blank');
    await page.goto(first);
    await settled(page);
    await write(page, before);
    await page.evaluate(() => document.querySelectorAll('.peaks tr, .chart *, svg.mechanism *').forEach(element => { element.isBefore = true; }));
    await write(page, after);
    const shown = await shownResults(page);
    const kept = await page.evaluate(() => [...document.querySelectorAll('.peaks tr, .chart path.curve, svg.mechanism [data-body]')].every(element => element.isBefore));
    expect(kept, 'elements are made anew');
    for (const [part, texts] of Object.entries(expected)) {
      same(shown[part].length, texts.length, part);
      texts.forEach((text, k) => same(shown[part][k], text, `${part} ${k}`));
    }
  });
}

await test('what is asked for gives the numbers of the command line', async page => {
  const scene = caseText('single-dwell').replace('mass = 2.1', 'mass = 2.2');
  await write(page, scene);
  for (const command of ['reduce', 'simulate']) {
    await page.click(`[data-command=${command}]`);
    await settled(page);
    // Rounding errors of the steps add up in an integration, and differ between processors.
    const expected = table(command, scene);
    if (command === 'reduce') {
      // The column of rounding errors is itself known only to rounding.
      const kept = expected.header.map((name, k) => k).filter(k => expected.header[k] !== 'relative_error');
      compare(parse((await saved(page, SAVE_CSV)).text), { header: kept.map(k => expected.header[k]), rows: expected.rows.map(row => kept.map(k => row[k])) }, command);
    } else {
      const shown = parse((await saved(page, SAVE_CSV)).text);
      const q = t => t.rows[t.rows.length - 1][t.header.indexOf('phi [rad]')];
      expect(Math.abs(q(shown) - q(expected)) < 1e-7, `${command}: ${q(shown)} instead of ${q(expected)}`);
    }
  }
  await page.screenshot({ path: join(pictures, 'live-simulate.png') });
});

await test('the page begins with the single-dwell mechanism, follows its crank, and is drawn', async page => {
  await page.screenshot({ path: join(pictures, 'live.png') });
  expect((await page.textContent('.dwell-page h1')).includes('ingle-dwell'), 'no title');
  expect(/computed in/.test(await status(page)), await status(page));
  const place = await page.textContent('.dwell-page output.place');
  const slider = page.locator('.dwell-page input.slider');
  await slider.focus();
  await page.keyboard.press('ArrowRight');
  expect(place !== await page.textContent('.dwell-page output.place'), 'the row does not move');
  const box = await page.locator('.dwell-page svg.mechanism').boundingBox();
  // A point on the crank near its end.
  const from = await page.evaluate(() => {
    const groups = [...document.querySelectorAll('.dwell-page svg.mechanism g[data-body]')];
    const path = groups.find(group => group.querySelector('title').textContent === 'crank').querySelector('path');
    const { x, y } = path.getPointAtLength(0.45 * path.getTotalLength()).matrixTransform(path.getScreenCTM());
    return { x, y };
  });
  const before = await page.textContent('.dwell-page output.place');
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2, box.y + 20, { steps: 6 });
  await page.mouse.up();
  expect(before !== await page.textContent('.dwell-page output.place'), 'the crank is not dragged');
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.screenshot({ path: join(pictures, 'live-dark.png') });
});

await test('what is wrong has the words of the command line, and its place', async page => {
  const scene = caseText('single-dwell').replace('{ revolute', '{ revolte').replace('mass = 2.1', 'mass = -2.1');
  await write(page, scene);
  const path = join(scratch, 'wrong.toml');
  writeFileSync(path, scene);
  const printed = spawnSync(dwell, ['kinetostatics', path, '--out', scratch], { encoding: 'utf8' });
  same(printed.status, 2, 'exit status');
  const plain = words => words.replace(/[\s│╭╰─×·┬├╯▶]+/gu, '');
  const messages = await page.locator('#live-messages li').all();
  expect(messages.length >= 2, `${messages.length} messages`);
  for (const message of messages) {
    const words = await message.locator('b').textContent();
    expect(plain(printed.stderr).includes(plain(words)), `the command line does not say: ${words}`);
  }
  const marked = await page.locator('.live-editor pre .error').allTextContents();
  expect(marked.includes('revolte') || marked.join('').includes('revolte'), `underlined: ${marked}`);
  await page.screenshot({ path: join(pictures, 'live-errors.png') });
  await write(page, scene.replace('{ revolte', '{ revolute').replace('-2.1', '2.1'));
  same(await page.locator('#live-messages li.error').count(), 0, 'messages that stay');
});

await test('a number has a slider, which everything follows', async page => {
  const scene = await text(page);
  const at = scene.search(/mass = \d/) + 'mass = '.length;
  await page.evaluate(([selector, place]) => {
    const field = document.querySelector(selector);
    field.focus();
    field.setSelectionRange(place, place);
    field.click();
  }, [area, at]);
  const slider = page.locator('[data-part=slider] input');
  expect(await slider.isVisible(), 'no slider');
  await page.screenshot({ path: join(pictures, 'live-slider.png') });
  await slider.focus();
  for (let k = 0; k < 5; k++) await page.keyboard.press('ArrowRight');
  await settled(page);
  const changed = await text(page);
  expect(changed !== scene && /computed in/.test(await status(page)), 'nothing followed');
  // Only this number has changed.
  same(changed.slice(0, at), scene.slice(0, at), 'text before the number');
});

await test('a step of the slider is one step of undo', async page => {
  const scene = await text(page);
  await page.focus(area);
  await page.keyboard.press('Control+Home');
  await page.keyboard.type('# mine\n');
  const typed = await text(page);
  const at = typed.search(/mass = \d/) + 'mass = '.length;
  await page.evaluate(([selector, place]) => {
    const field = document.querySelector(selector);
    field.setSelectionRange(place, place);
    field.click();
  }, [area, at]);
  await page.focus('[data-part=slider] input');
  await page.keyboard.press('ArrowRight');
  await settled(page);
  expect(await text(page) !== typed, 'nothing is slid');
  await page.focus(area);
  await page.keyboard.press('Control+z');
  same(await text(page), typed, 'after one step back');
  for (let k = 0; k < 20 && await text(page) !== scene; k++) await page.keyboard.press('Control+z');
  same(await text(page), scene, 'after all steps back');
});

// Opens a scene through the file input.
async function openScene(page, scene) {
  await page.setInputFiles('#live-file', { name: 'mine.toml', mimeType: 'text/plain', buffer: Buffer.from(scene) });
  await page.waitForFunction(([selector, value]) => document.querySelector(selector).value === value, [area, scene]);
  await settled(page);
}

await test('another scene opens at its first position', async page => {
  const slider = '.dwell-page .slider';
  await page.focus(slider);
  await page.keyboard.press('End');
  expect(Number(await page.inputValue(slider)) > 0, 'the last position');
  await openScene(page, caseText('jansen'));
  same(await page.inputValue(slider), '0', 'the position of the scene that was opened');
});

await test('what belongs to another text is not saved', async page => {
  const first = await text(page);
  const isSaved = () => page.isVisible(SAVE_CSV);
  expect(await isSaved(), 'a scene without errors');
  await write(page, first.replace('[joints]', '[jonts]'));
  expect(!await isSaved(), 'after an edit with an error');
  await write(page, first);
  expect(await isSaved(), 'after the edit was taken back');
  await openScene(page, 'title = "My own mechanism"\n[bodies.ground]\n');
  expect(!await isSaved() && !await page.isVisible('.dwell-page h1'), 'a file with an error');
});

await test('keys are completed and explained', async page => {
  await write(page, '[bodies.crank]\n');
  await page.focus(area);
  await page.keyboard.press('Control+End');
  await page.keyboard.type('ine');
  expect(await page.locator('[data-part=completion]').isVisible(), 'no list');
  // The explanation remains after the events of the typed letters.
  await page.screenshot({ path: join(pictures, 'live-keys.png') });
  const explained = async () => /^inertia: .*inertia/im.test(await page.textContent('[data-part=hint]'));
  expect(await explained(), 'no explanation of the chosen key');
  await page.keyboard.press('Enter');
  same(await text(page), '[bodies.crank]\ninertia', 'completed text');
  expect(await explained(), `no explanation: ${await page.textContent('[data-part=hint]')}`);
});

await test('200 random edits never leave it dead', async page => {
  let seed = 20;
  const random = bound => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return seed % bound;
  };
  const original = caseText('slider-crank');
  const pieces = ['[', ']', '{', '}', '=', '"', '\n', '0', '-', '1e300', 'nan', '#', 'é', '𝜑', '.', ',', ' ', 'x'];
  let scene = original;
  for (let k = 0; k < 200; k++) {
    const at = random(scene.length + 1);
    const kind = random(3);
    if (kind === 0) scene = scene.slice(0, at) + pieces[random(pieces.length)] + scene.slice(at);
    else if (kind === 1) scene = scene.slice(0, at) + scene.slice(at + 1 + random(6));
    else scene = scene.replace(/\d+\.?\d*/g, number => (random(12) === 0 ? String(Number(number) * (random(40) - 10)) : number));
    if (k % 20 === 19) scene = original;
    await paste(page, scene);
    // Edits are faster than results: the test waits for the results of every tenth edit only.
    if (k % 10 !== 9) continue;
    await settled(page);
    expect((await status(page)).length > 0, `nothing is said after edit ${k}`);
    expect((await page.locator('#live-messages li').count()) > 0 || /computed in/.test(await status(page)), `neither results nor messages after edit ${k}`);
  }
  await write(page, original);
  expect(/computed in/.test(await status(page)), 'it does not compute any more');
});

await test('a hostile title is text', async page => {
  const title = '</title><script>document.body.dataset.bad=1</script><img src=x onerror=document.body.dataset.bad=1>';
  const scene = caseText('single-dwell').replace(/^title = .*$/m, `title = ${JSON.stringify(title)}`);
  await write(page, scene);
  same(await page.textContent('.dwell-page h1'), title, 'heading');
  same(await page.evaluate(() => document.images.length + Number(document.body.dataset.bad || 0)), 0, 'pictures and marks');
});

await test('a link holds the scene', async page => {
  const scene = caseText('four-bar').replace(/^title = .*$/m, 'title = "Linked é 𝜑"');
  await write(page, scene);
  await page.click('#live-share');
  await page.waitForFunction(() => /link|address/.test(document.getElementById('live-status').textContent));
  const address = page.url();
  const other = await page.context().newPage();
  await other.goto(address);
  await settled(other);
  same(await text(other), scene, 'the scene of the link');
  expect(!other.url().includes('scene='), 'the address still holds the scene');
});

const linked = bytes => `#scene=${deflateRawSync(bytes).toString('base64url')}`;

await test('a link that would fill the memory is refused', async page => {
  expect(/longer than 1000000 bytes/.test(await text(page)), (await text(page)).slice(0, 200));
}, { hash: linked(Buffer.alloc(300e6)) });

await test('a damaged link is refused', async page => {
  expect(/cannot be read/.test(await text(page)), (await text(page)).slice(0, 200));
}, { hash: '#scene=____' });

await test('a panic costs an instance, not the page', async page => {
  const before = await text(page);
  const worker = page.workers()[0];
  // The next request makes the module panic, because it asks for more memory than there is.
  await worker.evaluate(() => {
    const { exports } = instance;
    instance = { exports: { ...exports, respond: () => exports.room(0xffffffff) } };
  });
  await write(page, before.replace('title = "', 'title = "Once '));
  expect(/could not be computed here/.test(await page.textContent('#live-messages')), 'the panic is not said');
  await write(page, before);
  expect(/computed in/.test(await status(page)), `it does not recover: ${await status(page)}`);
});

await test('what takes too long is ended', async page => {
  const before = await text(page);
  // Replaces the module by one that never answers.
  await page.workers()[0].evaluate(() => {
    instance = { exports: { ...instance.exports, respond: () => { for (;;); } } };
  });
  await write(page, before.replace('title = "', 'title = "Long '));
  expect(/not done after 5 s/.test(await page.textContent('#live-messages')), await page.textContent('#live-messages'));
  await write(page, before);
  expect(/computed in/.test(await status(page)), 'it does not go on');
});

await test('the machine as C', async page => {
  const saves = ['.h', '.c'].map(end => page.waitForEvent('download', { predicate: download => download.suggestedFilename().endsWith(end), timeout: 60000 }));
  await page.click('#live-c');
  await Promise.all(saves);
  await page.waitForFunction(() => /exported/.test(document.getElementById('live-status').textContent));
});

await test('narrow screens', async page => {
  await page.screenshot({ path: join(pictures, 'live-narrow.png'), fullPage: true });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  expect(wide <= 1, `${wide} pixels too wide`);
}, { viewport: { width: 400, height: 900 } });

// The number of pairs of labels in 24 rows that overlap by more than 3 px, the space above and below their letters.
const labelsMeet = page => page.evaluate(() => {
  const slider = document.querySelector('input.slider');
  let count = 0;
  for (let k = 0; k < 24; k++) {
    slider.value = Math.round((k * Number(slider.max)) / 24);
    slider.dispatchEvent(new Event('input'));
    const boxes = [...document.querySelectorAll('svg.mechanism text.label')].map(label => label.getBoundingClientRect());
    const meet = (a, b) => a.left < b.right && b.left < a.right && a.top + 3 < b.bottom - 3 && b.top + 3 < a.bottom - 3;
    count += boxes.filter((a, i) => boxes.slice(0, i).some(b => meet(a, b))).length;
  }
  return count;
});

// Two pairs remain, each in one row, of pins so near to each other that there is no room.
const NEAR_PINS = { 'four-bar': 1, 'bricard-a04': 1 };

await test('labels keep apart on narrow screens', async page => {
  const names = await page.locator('#live-example option').evaluateAll(all => all.map(one => one.value).filter(Boolean));
  for (const name of names) {
    await page.selectOption('#live-example', name);
    await settled(page);
    const count = await labelsMeet(page);
    expect(count <= (NEAR_PINS[name] || 0), `${name}: labels over each other, ${count}`);
  }
  // A long name stays within the picture.
  await write(page, caseText('single-dwell').replace(/\bA\b(?= = \[)/g, 'point_of_a_long_name').replace(/\.A"/g, '.point_of_a_long_name"').replace('"A"', '"point_of_a_long_name"').replace(/^A = /m, 'point_of_a_long_name = '));
  const outside = await page.$$eval('svg.mechanism text.label', all => all.filter(label => {
    const [own, picture] = [label.getBoundingClientRect(), label.ownerSVGElement.getBoundingClientRect()];
    return own.left < picture.left || own.right > picture.right;
  }).map(label => label.textContent).join());
  same(outside, '', 'labels beyond the picture');
  expect((await page.locator('svg.mechanism text.label').allTextContents()).some(name => name.includes('long_name')), 'no long label');
}, { viewport: { width: 390, height: 844 } });

await test('examples', async page => {
  const names = await page.locator('#live-example option').evaluateAll(all => all.map(one => one.value).filter(Boolean));
  expect(names.length > 25, `${names.length} examples`);
  for (const name of names) {
    await page.selectOption('#live-example', name);
    await settled(page);
    const said = await status(page);
    expect(/computed in/.test(said) || (await page.locator('#live-messages li').count()) > 0, `${name}: ${said}`);
    if (!/computed in/.test(said)) console.log(`  ${name}: ${await page.locator('#live-messages li b').first().textContent()}`);
  }
});

// The names of the visible arrows.
const arrows = page => page.$$eval('svg.mechanism [data-arrow]', all => all.filter(g => g.style.display !== 'none').map(g => g.dataset.arrow));

await test('forces of a scene are shown after another scene, and what is chosen stays', async page => {
  same((await arrows(page)).length, 0, 'arrows of a motion without forces');
  await write(page, caseText('planetary'));
  const first = await arrows(page);
  expect(['C', 'inner', 'outer'].every(name => first.includes(name)) && !first.includes('inner on sun'), `arrows ${first}`);
  // The first chart shows the default group of the new command.
  same(await page.inputValue('.chart-head select >> nth=0'), 'Reactions, magnitudes|N', 'the first chart');
  await page.click('summary[aria-label="which forces"]');
  await page.click('.choices label:text-is("inner")');
  await page.click('.choices label:text-is("inner on sun")');
  await page.click('summary[aria-label="which forces"]');
  const toothed = caseText('planetary').replace('radii = [30, 20]', 'radii = [30, 20], pressure-angle = 0.35');
  for (const scene of [caseText('planetary').replace('mass = 1.4', 'mass = 1.5'), toothed]) {
    await write(page, scene);
    const now = await arrows(page);
    expect(!now.includes('inner'), `arrows ${now}`);
    same(now.includes(scene === toothed ? 'inner.line-of-action' : 'inner on sun'), true, 'an arrow that is chosen or new');
  }
  await page.screenshot({ path: join(pictures, 'live-teeth.png') });
});

// Writes the live page with `dwell view`.
spawnSync(dwell, ['view', join(top, 'validation/four-bar/scene.toml'), '--page', file, '--out', scratch], { stdio: 'ignore' });
await test('dwell view opens its scene', async page => {
  same(await text(page), caseText('four-bar'), 'the scene');
  expect(/computed in/.test(await status(page)), await status(page));
}, { file: join(scratch, 'four-bar-live.html') });

await carelessTests({ test, settled, paste, write, text, status, caseText, linked });

await test('times', async page => {
  const scene = caseText('jansen');
  const number = /(points = \{[^}]*\[)([1-9]\d*\.?\d*)/.exec(scene);
  const times = [];
  for (let k = 0; k < 40; k++) {
    await write(page, scene.replace(number[0], `${number[1]}${Number(number[2]) * (1 + 1e-4 * k)}`));
    const said = /computed in ([\d.]+) ms, drawn in ([\d.]+) ms/.exec(await status(page));
    if (said && k >= 10) times.push([Number(said[1]), Number(said[2])]);
  }
  const middle = which => times.map(pair => pair[which]).sort((a, b) => a - b)[times.length >> 1];
  const least = which => Math.min(...times.map(pair => pair[which]));
  console.log(`Jansen leg, a length changed: computed in ${middle(0)} ms, drawn in ${middle(1)} ms (medians of ${times.length}; least ${least(0)} and ${least(1)})`);
});

await browser.close();
console.log(`${count - failures.length} of ${count} tests of the live page pass`);
process.exit(failures.length ? 1 : 0);
