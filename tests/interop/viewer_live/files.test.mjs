// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The pages that a run leaves behind, opened as files: its map, its report, and a saved map that was exported.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { coarse, launchBrowser, openPage, screenshot, textOf, waitFor } from "../viewer_page/browser.mjs";
import { compareLook } from "../viewer_page/looks.mjs";
import { kDomain } from "./rtd_process.mjs";

const kLooks = new URL("looks.json", import.meta.url);
const kSource = "synthetic:office?frames=90&people=1&boxes=0&figures=drawn";   // in lockstep every run is the same
const rtd = (...args) => execFileSync(process.env.RTD_EXECUTABLE, args, { encoding: "utf8", stdio: "pipe" });
const kRoomShare = 0.04, kLandmarkShare = 0.004;
let browser, folder;

before(async () => {
  browser = await launchBrowser();
  folder = mkdtempSync(join(tmpdir(), "rtd_files_"));
  rtd("run", "--domain", kDomain, "--source", kSource, "--pace", "lockstep", "--detector", "off", "--dense", "--out", folder, "--save-map", join(folder, "room.rtdmap"));
  rtd("map", "export", join(folder, "room.rtdmap"), "--format", "html", "--out", join(folder, "saved.html"));
});
after(async () => {
  await browser.close();
  rmSync(folder, { recursive: true });
});

/** Opens a file, waits until it is ready, and compares its look. */
async function look(file, name, ready) {
  const page = await openPage(browser, pathToFileURL(join(folder, file)).href, { width: 1280, height: 800 });
  await waitFor(page, ready);
  compareLook(kLooks, name, await coarse(page, await screenshot(page, `file_${name}`)));
  assert.deepEqual([page.complaints, page.outside], [[], []], "errors, and requests to other hosts");
  return page;
}
/** Share of the pixels on which a map is drawn, without its card. */
async function drawnShare(page) {
  await page.$eval("aside", (card) => { card.hidden = true; });
  return (await coarse(page, await screenshot(page, "file_bare"))).other;
}
const drawn = () => document.documentElement.dataset.drawn === "yes";

test("map.html of a run shows the room in colour", async () => {
  const page = await look("map.html", "map", drawn);
  assert.match(await textOf(page, "#layers"), /Room \([\d,]+ points\)/);
  assert.ok(statSync(join(folder, "map.html")).size < 5e6);
  assert.ok(await drawnShare(page) > kRoomShare);
  await page.close();
});

test("a saved map as a page shows landmarks and keyframes", async () => {
  const page = await look("saved.html", "saved", drawn);
  assert.match(await textOf(page, "#layers"), /Landmarks \(1,\d+ points\)/);
  assert.ok(await drawnShare(page) > kLandmarkShare);
  await page.close();
});

test("report.html of a run opens without a network", async () => {
  const page = await look("report.html", "report", () => document.readyState === "complete" && document.querySelectorAll("svg").length > 2);
  assert.match(await textOf(page, "body"), /90/);
  for (const file of ["map.html", "report.html"]) {   // there and back
    await page.click(`a[href$="${file}"]`);
    await page.waitForURL(`**/${file}`);
  }
  await page.close();
});
