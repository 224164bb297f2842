// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Called by viewer_screenshots.sh: node viewer_screenshots.mjs ADDRESS FOLDER

import { createRequire } from "node:module";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

const [address, folder] = process.argv.slice(2);
const puppeteer = createRequire(join(process.env.RTD_NODE_TOOLS, "x.js"))("puppeteer-core");
const kViews = [
  { name: "viewer", width: 1280, height: 800, theme: "light" },
  { name: "viewer_dark", width: 1280, height: 800, theme: "dark" },
  { name: "viewer_phone", width: 390, height: 780, theme: "light", phone: true },
  { name: "viewer_projector", width: 1920, height: 1080, theme: "dark", large: true },
];
const kLeastKeyframes = 15, kLeastRoom = 10_000, kLeastRemoved = 100, kPatience_ms = 90_000;

/** The viewer is there a moment after the run has begun. */
async function visit(page) {
  for (const until = Date.now() + kPatience_ms; ; await sleep(200)) {
    try {
      return await page.goto(address);
    } catch (error) {
      if (Date.now() > until) throw error;
    }
  }
}

const browser = await puppeteer.launch({
  executablePath: process.env.RTD_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
});
try {
  for (const { name, width, height, theme, phone = false, large = false } of kViews) {
    const page = await browser.newPage();
    await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: theme }]);
    await page.setViewport({ width, height, isMobile: phone, hasTouch: phone, deviceScaleFactor: phone ? 2 : 1 });
    await visit(page);
    await page.waitForFunction((keyframes, room) => window.rtdViewer?.counts.keyframes >= keyframes && rtdViewer.counts.points > 0 &&
      rtdViewer.state().robots[0]?.maps[0]?.dense >= room && !document.getElementById("image").hidden, { timeout: kPatience_ms, polling: 200 }, kLeastKeyframes, kLeastRoom);
    if (large) await page.keyboard.press("l");
    await sleep(1500);
    await page.evaluate(() => rtdViewer.measureFps(1));   // a slow driver has then drawn all that is there
    await page.waitForFunction((removed) => Number(document.getElementById("removed").textContent.match(/\d+/)?.[0]) >= removed,
                               { timeout: kPatience_ms, polling: 50 }, kLeastRemoved);   // people are in view
    const path = join(folder, `${name}.webp`);
    await page.screenshot({ path, type: "webp", quality: 60 });
    console.log(path);
    await page.close();
  }
} finally {
  await browser.close();
}
