// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Shows the page of an endless run for a while, in Chromium that draws in software, and prints each minute what the page
// holds in memory after a collection of garbage, and what it shows:
//   node tests/campaigns/page_heap.mjs [MINUTES=60] [SOURCE [OPTION OF RTD RUN ...]]
// RTD_EXECUTABLE, RTD_NODE_TOOLS, RTD_CHROMIUM: as for the tests (deploy/setup.sh --viewers).

import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Service } from "../interop/viewer_live/rtd_process.mjs";
import { launchBrowser, openPage } from "../interop/viewer_page/browser.mjs";

const kMinute_ms = 60_000;
const [minutes = "60", source = "synthetic:office?fps=10&frames=1000000", ...options] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "rtd_page_heap_"));
const run = new Service("run", "--source", source, "--pace", "realtime", "--out", join(folder, "run"), ...options,
                        "--viewer=now", "--set", "viewer.port=0");
const browser = await launchBrowser();
const [, address] = await run.waitFor(/viewer: (http:\S+)/);
const page = await openPage(browser, address, { width: 320, height: 240 });
const inspector = await page.context().newCDPSession(page);
console.log("minute heap_MB nodes keyframes points dense complaints");
for (let minute = 1; minute <= Number(minutes); ++minute) {
  await new Promise((resolve) => setTimeout(resolve, kMinute_ms));
  await inspector.send("HeapProfiler.collectGarbage");
  const { usedSize } = await inspector.send("Runtime.getHeapUsage");
  const { nodes } = await inspector.send("Memory.getDOMCounters");
  const shown = await page.evaluate(() => ({ ...rtdViewer.counts, dense: rtdViewer.state().robots[0]?.maps[0]?.dense ?? 0 }));
  console.log(minute, (usedSize / 1e6).toFixed(1), nodes, shown.keyframes, shown.points, shown.dense, page.complaints.length);
}
await browser.close();
await run.stop();
rmSync(folder, { recursive: true });
