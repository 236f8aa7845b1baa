// A browser with one page. It records faults of the page: errors, and requests other than that of the file itself.

import { chromium } from 'playwright-core';
import { existsSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const PLACES = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

export async function launch() {
  const executablePath = PLACES.find(path => path && existsSync(path));
  if (!executablePath) throw new Error('no Chromium: install it, or name it in CHROMIUM');
  return chromium.launch({ executablePath, args: ['--no-sandbox'] });
}

// Opens the page of a file; `faults` collects errors and requests.
export async function open(browser, file, { hash = '', ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 1100 }, offline: true, acceptDownloads: true, permissions: ['clipboard-read', 'clipboard-write'], ...options });
  const page = await context.newPage();
  const faults = [];
  const own = pathToFileURL(file).href;
  page.on('pageerror', error => faults.push(`error: ${error.message}`));
  page.on('console', message => { if (['error', 'warning'].includes(message.type())) faults.push(`console: ${message.text()}`); });
  page.on('request', request => {
    const url = request.url().split('#')[0];
    if (url !== own && !url.startsWith('blob:')) faults.push(`request: ${url.slice(0, 100)}`);
  });
  page.on('dialog', dialog => {
    faults.push(`dialog: ${dialog.message()}`);
    dialog.dismiss();
  });
  await page.goto(own + hash);
  return { context, page, faults };
}

export async function openRun(browser, file, options) {
  const opened = await open(browser, file, options);
  await opened.page.waitForFunction(() => document.documentElement.dataset.ready === 'yes', null, { timeout: 60000 });
  return opened;
}

// Waits for `count` frames, so that observers of the layout and timers of the page have run.
export const frames = (page, count) => page.evaluate(async number => {
  for (let k = 0; k < number; k++) await new Promise(requestAnimationFrame);
}, count);
