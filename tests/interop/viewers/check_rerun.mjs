// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Opens a recording in Rerun's web viewer in a headless Chromium: node check_rerun.mjs FILE DIGEST.json CHROMIUM PICTURE.png
// The viewer must load it as MCAP without an error, and its time line must span our first to our last message.
import assert from "node:assert/strict";
import { createReadStream } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { basename, dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const kOpenTimeoutMs = 120_000;
const kContentType = { ".js": "text/javascript", ".wasm": "application/wasm" };
const kPage = `<!doctype html><body style="margin:0"><div id="viewer"></div><script type="module">
  import { WebViewer } from "/viewer/index.js";
  globalThis.viewer = new WebViewer();
  viewer.on("recording_open", (event) => { globalThis.opened = event; });
  await viewer.start(location.origin + "/recording.mcap", document.getElementById("viewer"),
                     { hide_welcome_screen: true, width: "1280px", height: "800px", render_backend: "webgl" });
</script>`;

const [recording, digestFile, executablePath, picture] = process.argv.slice(2);
const viewerFolder = dirname(fileURLToPath(import.meta.resolve("@rerun-io/web-viewer")));

function answer(request, response) {
  const path = new URL(request.url, "http://localhost").pathname;
  if (path === "/") {
    response.setHeader("content-type", "text/html").end(kPage);
    return;
  }
  const name = basename(path) === "re_viewer" ? "re_viewer.js" : basename(path);  // imported without extension
  const file = path === "/recording.mcap" ? recording : join(viewerFolder, name);
  response.setHeader("content-type", kContentType[extname(file)] ?? "application/octet-stream");
  createReadStream(file).on("error", () => response.writeHead(404).end()).pipe(response);
}

const expected = JSON.parse(await readFile(digestFile, "utf8"));
const server = createServer(answer).listen(0, "127.0.0.1");
await new Promise((resolve) => server.once("listening", resolve));
const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
});
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  const complaints = [];
  page.on("console", (line) => { if (/^\s*ERROR\b|^WebViewer failure/.test(line.text())) complaints.push(line.text().slice(0, 500)); });
  page.on("pageerror", (error) => complaints.push(String(error)));
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  await page.waitForFunction(() => globalThis.opened !== undefined, undefined, { timeout: kOpenTimeoutMs });
  const firstNs = Number(expected.first_log_time), lastNs = Number(expected.last_log_time);
  await page.waitForFunction((end) => {
    const range = viewer.get_time_range(opened.recording_id, "message_log_time");
    return range !== null && range.max >= end;
  }, lastNs, { timeout: kOpenTimeoutMs });
  const range = await page.evaluate(() => viewer.get_time_range(opened.recording_id, "message_log_time"));
  const source = await page.evaluate(() => opened.source);
  await new Promise((resolve) => setTimeout(resolve, 2000));  // let it draw
  await page.screenshot({ path: picture });
  assert.equal(source, "McapImporter", "loaded as");
  assert.deepEqual([range.min, range.max], [firstNs, lastNs], "time line");
  assert.deepEqual(complaints, [], "complaints of the viewer");
  console.log(`rerun: opened, time line of ${((lastNs - firstNs) * 1e-9).toFixed(3)} s equal, picture ${picture}`);
} finally {
  await browser.close();
  server.close();
}
