// Tests of the live page with careless and hurried input.

import { expect, same } from './expect.mjs';

const area = '.live-editor textarea';
const heading = page => page.textContent('.dwell-page h1');
const hasHeading = (page, words) => page.waitForFunction(own => document.querySelector('.dwell-page h1').textContent.includes(own), words);

export async function carelessTests({ test, settled, paste, write, text, status, caseText, linked }) {
  // With colours, this text needs half a million elements, and the browser ended the tab.
  await test('900 kB that are no scene do not end the page', async page => {
    const before = await text(page);
    await write(page, 'a=[1,{b}\n'.repeat(100000));
    expect(/not valid TOML/.test(await page.textContent('#live-messages')), 'nothing is said');
    await write(page, before);
    expect(/computed in/.test(await status(page)), await status(page));
    expect((await page.locator('.live-editor pre .number').count()) > 10, 'no colours');
  });

  await test('edits outlive a reload, and going back leads to the scene before', async page => {
    await page.selectOption('#live-example', 'four-bar');
    await settled(page);
    await write(page, caseText('four-bar').replace('title = "', 'title = "Edited '));
    await page.waitForFunction(() => history.state && history.state.scene.includes('Edited'));
    await page.selectOption('#live-example', 'jansen');
    await settled(page);
    await page.goBack();
    await hasHeading(page, 'Edited');
    await page.goBack();
    await hasHeading(page, 'ingle-dwell');
    await page.goForward();
    await hasHeading(page, 'Edited');
    await page.reload();
    await settled(page);
    expect((await heading(page)).startsWith('Edited'), `after a reload: ${await heading(page)}`);
    // A link opened in the same tab still opens its scene.
    await page.evaluate(hash => { location.hash = hash; }, linked(Buffer.from(caseText('whitworth'))));
    await hasHeading(page, 'Whitworth');
    await page.goBack();
    await hasHeading(page, 'Edited');
  });

  await test('an address that holds the scene does so until the next change', async page => {
    const before = await text(page);
    await page.click('#live-share');
    await page.waitForFunction(() => location.hash.startsWith('#scene='));
    await write(page, before.replace('title = "', 'title = "Later '));
    await page.waitForFunction(() => !location.hash);
    await page.reload();
    await settled(page);
    expect((await heading(page)).startsWith('Later'), await heading(page));
  });

  // Ten million periods take longer than the time limit of one minute.
  await test('what was asked for is ended when it is left', async page => {
    await write(page, caseText('single-dwell').replace(/periods = \d+/, 'periods = 10000000'));
    await page.click('[data-command=simulate]');
    await page.waitForFunction(() => /computing/.test(document.getElementById('live-status').textContent));
    await page.click('[data-command=statics]');
    await page.waitForFunction(() => document.body.dataset.state === 'settled', null, { timeout: 30000 });
    expect(/dwell statics/.test(await page.textContent('.dwell-page .subtitle')), 'no statics');
  });

  await test('a number has its slider by the keyboard, too', async page => {
    const scene = await text(page);
    const at = scene.search(/mass = 20/) + 'mass = '.length;
    await page.focus(area);
    await page.evaluate(([selector, place]) => document.querySelector(selector).setSelectionRange(place, place), [area, at]);
    await page.keyboard.press('Control+Space');
    await page.keyboard.press('ArrowRight');
    await settled(page);
    same((await text(page)).slice(at, at + 4), '20.1', 'the number');
    await page.keyboard.press('Escape');
    same(await page.evaluate(() => document.activeElement.tagName), 'TEXTAREA', 'what has the focus');
  });

  await test('nothing jumps when errors come or results are old', async page => {
    const places = () => page.evaluate(() => JSON.stringify(['.live-editor', '.dwell-page h1', '#live-messages'].map(selector => {
      const { top, height } = document.querySelector(selector).getBoundingClientRect();
      return [selector, top, height];
    })));
    const before = await places();
    const scene = caseText('single-dwell');
    await write(page, scene.replace('{ revolute', '{ revolte').replace('mass = 2.1', 'mass = -2.1'));
    same(await places(), before, 'with errors');
    await write(page, scene);
    await page.click('[data-command=simulate]');
    await settled(page);
    await write(page, `${scene}\n`);
    expect(await page.locator('#live-again').isVisible(), 'it is not said that results are old');
    same(await places(), before, 'with old results');
    await page.click('#live-again');
    await settled(page);
    expect(!(await page.locator('#live-again').isVisible()), 'they are not computed again');
  });

  await test('a file of more than 1 MB is not opened, and no link is made of as much', async page => {
    const before = await text(page);
    await page.setInputFiles('#live-file', { name: 'large.toml', mimeType: 'text/plain', buffer: Buffer.alloc(1000001, '#') });
    await page.waitForFunction(() => /not opened: large.toml/.test(document.getElementById('live-status').textContent));
    same(await text(page), before, 'the scene');
    await write(page, '#'.repeat(1000001));
    await page.click('#live-share');
    await page.waitForFunction(() => /no link/.test(document.getElementById('live-status').textContent));
    expect(!page.url().includes('#scene='), page.url().slice(0, 200));
  });

  await test('half a link is refused', async page => {
    expect(/^# The scene of the link cannot be read/.test(await text(page)), (await text(page)).slice(0, 200));
    await write(page, caseText('single-dwell'));
    expect(/computed in/.test(await status(page)), await status(page));
  }, { hash: linked(Buffer.from(caseText('single-dwell'))).slice(0, 1000) });

  await test('no script but its own acts, and nothing is loaded', async page => {
    const policy = await page.getAttribute('meta[http-equiv="Content-Security-Policy"]', 'content');
    expect(policy.includes("default-src 'none'") && !/unsafe-inline|unsafe-eval'(?<!wasm-unsafe-eval')/.test(policy), policy);
    const found = await page.evaluate(async () => {
      const script = document.createElement('script');
      script.textContent = 'window.intruder = 1';
      document.body.append(script);
      const loaded = await fetch('data:text/plain,a').then(() => 'loaded', () => 'refused');
      return `${window.intruder} ${loaded}`;
    });
    same(found, 'undefined refused', 'a script and a request');
  }, { allowed: /Content Security Policy|request: data:/ });

  await test('a tab that is closed while it computes', async page => {
    await paste(page, caseText('jansen'));
    await page.close();
  });
}
