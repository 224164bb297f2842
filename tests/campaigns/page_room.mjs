// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// How long after slam's first pose a page shows poses, and the room in colour: opens the page of a run that waits for
// it, as a user does, in Chromium that draws in software on the same computer.
//   node tests/campaigns/page_room.mjs SOURCE [RUNS=5 [OPTION OF RTD RUN ...]]
// RTD_EXECUTABLE, RTD_NODE_TOOLS, RTD_CHROMIUM: as for the tests (deploy/setup.sh --viewers).

import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Service } from "../interop/viewer_live/rtd_process.mjs";
import { launchBrowser, openPage } from "../interop/viewer_page/browser.mjs";

const kLook_ms = 20, kPatience_ms = 60_000, kLeastRoom = 1000;
const [source, runs = "5", ...options] = process.argv.slice(2);

/** The time of day of an event in a log, in ms since 1970. */
function timeOf(log, event) {
  const [, time] = readFileSync(log, "utf8").match(new RegExp(`^(\\S+) .*event=${event} `, "m"));
  return Date.parse(`${new Date().toISOString().slice(0, 10)}T${time}`);
}

/** When the condition held first, which gives the time of day then. */
const firstTime = (page, condition) => page.waitForFunction(condition, kLeastRoom, { polling: kLook_ms, timeout: kPatience_ms })
  .then((handle) => handle.jsonValue());

async function measure(browser) {
  const folder = mkdtempSync(join(tmpdir(), "rtd_page_room_"));
  const run = new Service("run", "--source", source, "--pace", "realtime", "--out", join(folder, "run"), ...options,
                          "--viewer", "--set", "viewer.port=0");
  const page = await openPage(browser, (await run.waitFor(/viewer: (http:\S+)/))[1]);
  const pose = firstTime(page, () => window.rtdViewer?.state().robots[0]?.tracking?.seq >= 0 && Date.now());
  const room = firstTime(page, (least) => window.rtdViewer?.state().robots[0]?.maps[0]?.dense > least && rtdViewer.drawnShare > 0 && Date.now());
  const [posed_ms, shown_ms] = await Promise.all([pose, room]);
  const first_ms = timeOf(join(folder, "run", "logs", "slam.log"), "map_started");
  await page.close();
  await run.stop();
  rmSync(folder, { recursive: true });
  return [posed_ms - first_ms, shown_ms - first_ms];
}

const browser = await launchBrowser();
console.log("after slam's first pose: pose_s room_s");
for (let run = 0; run < Number(runs); ++run) console.log(...(await measure(browser)).map((ms) => (ms / 1000).toFixed(2)));
await browser.close();
