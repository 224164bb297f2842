// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Shows the page of an endless run for a while, in Chromium that draws in software, and prints each minute what the page
// holds in memory after a collection of garbage, and what it shows:
//   node tests/campaigns/page_heap.mjs [MINUTES=60] [SOURCE [OPTION OF RTD RUN ...]]
// RTD: the program (build/release/bin/rtd); RTD_NODE_TOOLS, RTD_CHROMIUM: as for the tests (deploy/setup.sh --viewers).

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { launchBrowser, openPage } from "../interop/viewer_page/browser.mjs";

const kMinute_ms = 60_000;
const [minutes = "60", source = "synthetic:office?fps=10&frames=1000000", ...options] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "rtd_page_heap_"));
const run = spawn(process.env.RTD ?? "build/release/bin/rtd", ["run", "--source", source, "--pace", "realtime", "--out",
  join(folder, "run"), "--domain", "85", "--quiet", ...options, "--viewer=now", "--set", "viewer.port=8796"], { stdio: "inherit" });
const ended = new Promise((resolve) => run.once("exit", resolve));
const browser = await launchBrowser();
const address = "http://127.0.0.1:8796/";
while (!(await fetch(address).catch(() => null))) await new Promise((resolve) => setTimeout(resolve, 200));
const page = await openPage(browser, address, { width: 320, height: 240 });
const inspector = await page.createCDPSession();
console.log("minute heap_MB nodes keyframes points dense complaints");
for (let minute = 1; minute <= Number(minutes); ++minute) {
  await new Promise((resolve) => setTimeout(resolve, kMinute_ms));
  await inspector.send("HeapProfiler.collectGarbage");
  const { usedSize } = await inspector.send("Runtime.getHeapUsage");
  const { Nodes } = await page.metrics();
  const shown = await page.evaluate(() => ({ ...rtdViewer.counts, dense: rtdViewer.state().robots[0]?.maps[0]?.dense ?? 0 }));
  console.log(minute, (usedSize / 1e6).toFixed(1), Nodes, shown.keyframes, shown.points, shown.dense, page.complaints.length);
}
await browser.close();
run.kill("SIGINT");
await ended;
rmSync(folder, { recursive: true });
