// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Called by viewer_screenshots.sh: node viewer_screenshots.mjs ADDRESS FOLDER

import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";
import { launchBrowser } from "../interop/viewer_page/browser.mjs";

const [address, folder] = process.argv.slice(2);
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

const browser = await launchBrowser();
try {
  for (const { name, width, height, theme, phone = false, large = false } of kViews) {
    const page = await browser.newPage({ viewport: { width, height }, isMobile: phone, hasTouch: phone, colorScheme: theme,
                                         deviceScaleFactor: phone ? 2 : 1 });
    await visit(page);
    await page.waitForFunction(([keyframes, room]) => window.rtdViewer?.counts.keyframes >= keyframes && rtdViewer.counts.points > 0 &&
      rtdViewer.state().robots[0]?.maps[0]?.dense >= room && !document.getElementById("image").hidden, [kLeastKeyframes, kLeastRoom], { timeout: kPatience_ms, polling: 200 });
    if (large) await page.keyboard.press("l");
    await sleep(1500);
    await page.evaluate(() => rtdViewer.measureFps(1));   // a slow driver has then drawn all that is there
    await page.waitForFunction((removed) => Number(document.getElementById("removed").textContent.match(/\d+/)?.[0]) >= removed,
                               kLeastRemoved, { timeout: kPatience_ms, polling: 50 });   // people are in view
    const path = join(folder, `${name}.webp`);
    const inspector = await page.context().newCDPSession(page);   // Playwright itself makes no WebP
    const { data } = await inspector.send("Page.captureScreenshot", { format: "webp", quality: 60 });
    writeFileSync(path, Buffer.from(data, "base64"));
    console.log(path);
    await page.close();
  }
} finally {
  await browser.close();
}
