// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// A headless Chromium with software graphics, and the page in it.

import { join } from "node:path";
import { requirePackage } from "../../support/viewer_page/fake_server.mjs";

const kWait_ms = 20_000;   // for what takes a second on a quiet machine

export async function launchBrowser(...args) {
  const graphics = args.length > 0 ? args : ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
  return requirePackage("playwright-core").chromium.launch({
    executablePath: process.env.RTD_CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", ...graphics] });
}

/**
 * The page at an address, in a browser or in the context of another page; view: {width, height, phone, theme}.
 * page.complaints collects what must not happen.
 */
export async function openPage(browser, address, { width = 960, height = 600, phone = false, theme = "dark" } = {}) {
  const look = { viewport: { width, height }, isMobile: phone, hasTouch: phone, colorScheme: theme };
  const page = await (await browser.newContext?.(look) ?? browser).newPage();
  page.complaints = [];
  page.outside = [];
  page.on("console", (line) => {
    if (["error", "warning"].includes(line.type())) page.complaints.push(`console: ${line.text()}`);
  });
  page.on("pageerror", (error) => page.complaints.push(String(error.stack ?? error)));
  page.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith(address) && !/^(blob|data):/.test(url)) page.outside.push(url.slice(0, 200));
  });
  await page.goto(address);
  return page;
}

export const waitFor = (page, condition, value) => page.waitForFunction(condition, value, { timeout: kWait_ms, polling: 100 });

export const waitForMap = (page, points) => waitFor(page, (n) => rtdViewer.counts.points === n && rtdViewer.fps > 0, points);

export const textOf = (page, selector) => page.$eval(selector, (node) => node.textContent.trim());

/** In base64. Kept as a file when RTD_SCREENSHOTS names a folder. */
export async function screenshot(page, name) {
  const folder = process.env.RTD_SCREENSHOTS;
  return (await page.screenshot(folder ? { path: join(folder, `${name}.png`) } : {})).toString("base64");
}

/**
 * What a screenshot looks like from afar: the mean colour of each of columns x rows cells, and the share of the pixels that
 * differ clearly from the most frequent colour. Read by the browser itself, which knows PNG.
 */
export function coarse(page, png, columns = 16, rows = 12) {
  return page.evaluate(async ([base64, columns, rows]) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))]));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), context = canvas.getContext("2d", { willReadFrequently: true });
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const sums = new Float64Array(4 * columns * rows), often = new Map();
    for (let i = 0; i < data.length / 4; ++i) {
      const column = Math.floor((i % bitmap.width) * columns / bitmap.width), row = Math.floor(Math.floor(i / bitmap.width) * rows / bitmap.height);
      const cell = 4 * (row * columns + column), key = (data[4 * i] << 16) | (data[4 * i + 1] << 8) | data[4 * i + 2];
      for (let k = 0; k < 3; ++k) sums[cell + k] += data[4 * i + k];
      sums[cell + 3] += 1;
      often.set(key, (often.get(key) ?? 0) + 1);
    }
    const [background] = [...often].reduce((a, b) => (b[1] > a[1] ? b : a));
    let other = 0;
    for (const [key, count] of often) {
      const distance = [16, 8, 0].reduce((sum, shift) => sum + Math.abs(((key >> shift) & 255) - ((background >> shift) & 255)), 0);
      if (distance > 60) other += count;
    }
    const cells = Array.from({ length: columns * rows }, (_, i) => [0, 1, 2].map((k) => Math.round(sums[4 * i + k] / sums[4 * i + 3])));
    return { cells, background, other: other / (data.length / 4) };
  }, [png, columns, rows]);
}
