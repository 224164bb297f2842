// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The page in Chromium with the real services: a rendered camera, filter, slam and viewer.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { getPriority, tmpdir } from "node:os";
import { join } from "node:path";
import { after, afterEach, before, test } from "node:test";
import { setTimeout } from "node:timers/promises";
import { launchBrowser, openPage, screenshot, textOf, waitFor } from "../viewer_page/browser.mjs";
import { kDomain, Service, startViewer, stopAll } from "./rtd_process.mjs";

const kFrames = 120, kRecordedFrames = 300;
const kLockstep = ["--pace", "lockstep"];  // the mapper is done with a frame when its result is there
let browser, page, services = [], folder;

before(async () => {
  browser = await launchBrowser();
  folder = mkdtempSync(join(tmpdir(), "rtd_live_"));
});
after(async () => {
  await browser.close();
  rmSync(folder, { recursive: true });
});
afterEach(async () => {
  const complaints = page?.complaints ?? [];
  await page?.close();
  await stopAll(services);
  services = [];
  page = undefined;
  const serious = complaints.filter((line) => !/ERR_CONNECTION|WebSocket connection/.test(line));
  assert.deepEqual(serious, [], "errors and warnings of the page");
});

function start(...args) {
  services.push(new Service(...args));
  return services.at(-1);
}

async function startRun() {
  services.push(await startViewer());
  const viewer = services.at(-1);
  page = await openPage(browser, viewer.address);
  start("slam", "--out", join(folder, "out"), ...kLockstep);
  start("filter", "--set", "filter.detector=off", ...kLockstep);
  return viewer;
}

const startCamera = () =>
  start("camera", "--source", `synthetic:office?frames=${kFrames}`, "--wait-for", "filter,slam,viewer", ...kLockstep);

/** All frames are tracked, and the page has every landmark that slam says it has. */
const waitForWholeMap = () => waitFor(page, (last) => {
  const tracking = rtdViewer.state().robots[0]?.tracking;
  return tracking?.seq === last && rtdViewer.counts.pointsTotal === tracking.landmarks && tracking.landmarks > 500;
}, kFrames - 1).catch(async (error) => {
  const seen = await page.evaluate(() => JSON.stringify([rtdViewer.counts, rtdViewer.state().robots[0]?.tracking]));
  throw new Error(`${error.message}: ${seen}`);
});

const command = (name) => `[data-command="${name}"]`;
async function press(name, selector, value) {
  await waitFor(page, (button) => document.querySelector(button)?.disabled === false, `${command(name)} ${selector}`);
  if (value !== undefined) await page.type(`${command(name)} input`, value);
  await page.click(`${command(name)} ${selector}`);
}
async function answerOf(name) {
  await waitFor(page, (output) => /good|bad/.test(document.querySelector(output)?.className), `${command(name)} output`);
  return textOf(page, `${command(name)} output`);
}

test("the page waits, shows the map as it grows, and has as many points as slam", async () => {
  await startRun();
  await waitFor(page, () => !document.getElementById("notice").hidden);
  startCamera();
  await waitFor(page, () => rtdViewer.counts.keyframes > 2 && rtdViewer.counts.points > 100);
  await waitFor(page, () => !document.getElementById("image").hidden);
  assert.ok(await page.evaluate(() => rtdViewer.poseAgeP50) > 0);
  await waitForWholeMap();
  await screenshot(page, "live_map");
});

test("a first page that opens after the end has the map, the plots and the last image", async () => {
  services.push(await startViewer());
  const viewer = services.at(-1), slam = start("slam", "--out", join(folder, "late"), ...kLockstep);
  start("filter", "--set", "filter.detector=off", ...kLockstep);
  await startCamera().ended;
  await setTimeout(1500);   // the last changes of the map
  await slam.stop();
  page = await openPage(browser, viewer.address);
  await waitFor(page, () => {
    const { tracking, imageStamp_s } = rtdViewer.state().robots[0] ?? {};
    return tracking?.landmarks > 500 && rtdViewer.counts.pointsTotal > 0.9 * tracking.landmarks && imageStamp_s !== null;
  });
  await waitFor(page, () => !document.getElementById("image").hidden);
  await screenshot(page, "late");
});

test("slam answers what the page asks of a landmark, a keyframe and the pose", async () => {
  await startRun();
  startCamera();
  await waitForWholeMap();
  const { x, y, width, height } = await (await page.$("#map canvas")).boundingBox();
  const titles = new Set();
  for (let i = 0; i < 400 && titles.size < 2; ++i) {
    await page.mouse.click(x + width * (0.2 + 0.03 * (i % 20)), y + height * (0.25 + 0.025 * Math.floor(i / 20)));
    const title = await page.$eval("#inspect", (card) => (card.hidden ? "" : card.querySelector("#inspect-title").textContent));
    if (!/^(Landmark|Keyframe)/.test(title) || titles.has(title.split(" ")[0])) continue;
    const pattern = title.startsWith("Landmark") ? "\\d+ keyframes; in \\d+ of \\d+ frames.*along the worst axis" : "Features\\d+.*Taken";
    await waitFor(page, (text) => new RegExp(text, "s").test(document.getElementById("inspect-rows").textContent), pattern);
    titles.add(title.split(" ")[0]);
  }
  assert.ok(titles.has("Landmark"), [...titles].join());
  const doubt = JSON.parse(spawnSync(process.env.RTD_EXECUTABLE, ["call", "--domain", kDomain, "/slam/ask", "doubt"], { encoding: "utf8" }).stdout);
  assert.ok(doubt.agree > 30 && doubt.landmarks.length === doubt.disagree, JSON.stringify(doubt));
  await screenshot(page, "live_asked");
});

test("a viewer that was killed and started again gives the page the whole map again", async () => {
  const viewer = await startRun();
  startCamera();
  await waitForWholeMap();
  await viewer.stop("SIGKILL");
  await waitFor(page, () => rtdViewer.state().connection !== "open");
  services.push(await startViewer("--port", viewer.port));
  await waitFor(page, () => rtdViewer.reconnects > 0 && rtdViewer.counts.keyframes > 2);
  await waitFor(page, () => rtdViewer.counts.pointsTotal > 500);
});

test("buttons act: save the map, change the filter's mode, reset the map", async () => {
  await startRun();
  startCamera();
  await waitForWholeMap();
  const file = join(folder, "out", "button.rtdmap");
  await press("/slam/save_map", "button", "button");
  assert.match(await answerOf("/slam/save_map"), /saved/);
  assert.ok(existsSync(file));
  await press("/filter/set_mode", "button:nth-child(1)");
  assert.match(await answerOf("/filter/set_mode"), /off/);
  await press("/slam/reset", "button");
  await page.click("#confirm [value=yes]");
  await answerOf("/slam/reset");
  await waitFor(page, () => rtdViewer.counts.keyframes === 0 && rtdViewer.counts.points === 0);
});

test("a replay can be paused, stepped and sought from the page", async () => {
  const recording = join(folder, "run.mcap");
  const recorder = start("record", "--topics", "rtd/features", "--topics", "rtd/tracking", "-o", recording);
  await recorder.waitFor(/event=/);
  start("slam", "--out", join(folder, "recorded"));
  start("filter", "--set", "filter.detector=off");
  await start("camera", "--source", `synthetic:office?frames=${kRecordedFrames}`, "--wait-for", "filter,slam").ended;
  await stopAll(services);

  services = [await startViewer()];
  page = await openPage(browser, services[0].address);
  start("replay", recording, "--topics", "rtd/features");
  await waitFor(page, () => !document.getElementById("replay").hidden && !document.getElementById("pause").disabled);
  await page.click("#pause");
  await waitFor(page, () => rtdViewer.state().robots[0].playback?.state === "paused");
  await page.$eval("#seek", (slider) => {
    slider.value = "1";
    slider.dispatchEvent(new Event("input"));
    slider.dispatchEvent(new Event("change"));
  });
  await waitFor(page, () => Math.abs(rtdViewer.state().robots[0].playback.position_s - 1) < 0.15);
  const position = () => page.evaluate(() => rtdViewer.state().robots[0].playback.position_s);
  let before = await position();
  for (let last = NaN; last !== before; before = await position()) {  // on a busy computer the seek continues for a while
    last = before;
    await setTimeout(500);
  }
  await page.click("#step");
  await waitFor(page, (at) => rtdViewer.state().robots[0].playback.position_s > at, before);
  await page.click("#pause");
  await waitFor(page, () => rtdViewer.state().robots[0].playback.state === "playing");
});

const kViewer = ["--set", "viewer.port=0"];
const addressOf = async (service) => (await service.waitFor(/viewer: (http:\S*)/))[1];

test("a run with --viewer waits for its page, shows the room, and the page stays until Ctrl-C", async () => {
  const out = join(folder, "stays");
  const run = start("run", "--source", `synthetic:office?frames=${kFrames}`, "--pace", "lockstep", "--detector", "off", "--out", out, "--viewer", ...kViewer);
  await run.waitFor(/waits until the page is open/);
  page = await openPage(browser, await addressOf(run));
  await waitFor(page, () => rtdViewer.state().robots[0]?.maps[0]?.dense > 1000);
  const { pid } = await page.evaluate(() => rtdViewer.state().robots[0].services.find(({ name }) => name === "dense"));
  assert.equal(getPriority(pid), 19, "nothing waits for the room that only the page shows");
  await run.waitFor(/the page stays until Ctrl-C: viewer: http/, 120);
  assert.match(run.output, /frames .*120 used/);
  assert.ok(existsSync(join(out, "map.html")) && !existsSync(join(out, "static_map.ply")));
  await waitFor(page, () => document.getElementById("state-text").textContent === "The source has ended");
  assert.equal(await page.evaluate(() => rtdViewer.state().connection), "open");
  await screenshot(page, "live_stays");
  assert.equal(await run.stop(), 0);
});

test("with --viewer=now,exit nothing waits", async () => {
  const run = start("run", "--source", "synthetic:office?frames=20", "--pace", "lockstep", "--detector", "off", "--out", join(folder, "now"),
                    "--viewer=now,exit", ...kViewer);
  await addressOf(run);
  assert.equal(await run.ended, 0);
  assert.doesNotMatch(run.output, /waits until the page/);
});

test("a replay with --viewer waits for its page, stays at its end, and begins again", async () => {
  const recording = join(folder, "short.mcap");
  await start("run", "--source", "synthetic:office?frames=45", "--pace", "lockstep", "--detector", "off", "--out", join(folder, "short"), "--record", recording).ended;
  const replay = start("replay", recording, "--viewer", ...kViewer);
  await replay.waitFor(/waits_for_page/);
  page = await openPage(browser, await addressOf(replay));
  await waitFor(page, () => rtdViewer.state().robots[0]?.tracking?.seq >= 44);
  await waitFor(page, () => rtdViewer.state().robots[0].playback.state === "paused" && !document.getElementById("pause").disabled);
  await page.click("#pause");
  await waitFor(page, () => rtdViewer.state().robots[0].tracking.seq < 40);
  assert.equal(await replay.stop(), 0);
});
