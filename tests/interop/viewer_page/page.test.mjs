// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The page as a user meets it. Times are generous: they bound hangs, they are no measurement.

import assert from "node:assert/strict";
import { test } from "node:test";
import { coarse, launchBrowser, openPage, screenshot, textOf, waitFor, waitForMap } from "./browser.mjs";
import { browser, open, page, serve, server, take, until } from "./harness.mjs";
import { compareLook, differing } from "./looks.mjs";

const kLooks = new URL("looks.json", import.meta.url);
const kLeastFps = { 5000: 20, 200000: 10 };

const command = (name) => `[data-command="${name}"]`;
const answerOf = (name) => waitFor(page, (selector) => /good|bad/.test(document.querySelector(`${selector} output`)?.className), command(name))
  .then(() => textOf(page, `${command(name)} output`));

test("the map appears with every point and every keyframe", async () => {
  await open({ points: 5000, keyframes: 60 });
  await waitForMap(page, 5000);
  assert.deepEqual([server.wanted[0].ready, server.wanted.at(-1).ready], [false, true], "a recording waits until the page can draw");
  const counts = await page.evaluate(() => rtdViewer.counts);
  assert.deepEqual(counts, { points: server.robots[0].room.pointCount, pointsTotal: 5000, keyframes: 60 });
  assert.equal(await textOf(page, "#state-text"), "Tracking");
  assert.equal(await page.$eval("#notice", (node) => node.hidden), true);
  await waitFor(page, () => /^Drawn without a graphics card: at most \d+ pictures? per second$/.test(document.getElementById("drawing").textContent));
  await waitFor(page, () => rtdViewer.poseAgeP50 > 0 && !document.getElementById("image").hidden);
  await waitFor(page, () => document.querySelectorAll("#services > li").length === 6 && document.getElementById("removed").textContent > "0");
});

test("buttons send their calls and show the answers", async () => {
  await open();
  await waitFor(page, (selector) => document.querySelector(selector), command("/slam/save_map"));
  await page.type(`${command("/slam/save_map")} input`, "/tmp/a.rtdmap");
  await page.click(`${command("/slam/save_map")} button`);
  assert.match(await answerOf("/slam/save_map"), /map saved to \/tmp\/a.rtdmap: 60 keyframes/);
  await page.click(`${command("/filter/set_mode")} button:nth-child(3)`);
  assert.match(await answerOf("/filter/set_mode"), /mode geometry/);
  assert.equal(await page.$eval(`${command("/filter/set_mode")} [aria-pressed=true]`, (node) => node.textContent), "geometry");
  await page.click(`${command("/slam/localize_only")} button:last-child`);
  await answerOf("/slam/localize_only");
  assert.deepEqual(server.calls, [{ name: "/slam/save_map", argument: "/tmp/a.rtdmap" }, { name: "/filter/set_mode", argument: "geometry" },
                                  { name: "/slam/localize_only", argument: "true" }]);
});

test("what destroys the map is asked about first; a refused call shows why", async () => {
  await open();
  await waitForMap(page, 5000);
  await page.click(`${command("/slam/reset")} button`);
  await page.click("#confirm [value=no]");
  assert.deepEqual(server.calls, []);
  await page.type(`${command("/slam/load_map")} input`, "/none.rtdmap");
  await page.click(`${command("/slam/load_map")} button`);
  await page.click("#confirm-yes");
  assert.match(await answerOf("/slam/load_map"), /no such file: \/none.rtdmap/);
  await page.click(`${command("/slam/reset")} button`);
  await page.click("#confirm-yes");
  assert.match(await answerOf("/slam/reset"), /the map is empty/);
  await waitFor(page, () => rtdViewer.counts.keyframes === 0 && rtdViewer.counts.points === 0);
});

test("with --read-only the buttons are shown and disabled", async () => {
  await open({ control: false });
  await waitFor(page, (selector) => document.querySelector(selector), command("/slam/reset"));
  assert.equal(await page.$eval(command("/slam/reset") + " button", (node) => node.matches(":disabled")), true);
  assert.match(await textOf(page, "#controls-off"), /--read-only/);
});

test("a replay pauses, steps, seeks and changes its speed", async () => {
  await open();
  await waitFor(page, () => !document.getElementById("replay").hidden && !document.getElementById("pause").disabled);
  await page.click("#pause");
  await waitFor(page, () => document.getElementById("pause").textContent === "Play");
  await page.click("#step");
  await page.$eval("#seek", (slider) => {
    slider.value = 12.5;
    slider.dispatchEvent(new Event("input"));
    slider.dispatchEvent(new Event("change"));
  });
  await waitFor(page, () => document.getElementById("position").textContent.startsWith("0:12.5"));
  await page.selectOption("#speed", "2");
  await waitFor(page, () => rtdViewer.state().robots[0].playback.speed === 2);
  assert.deepEqual(server.calls.map(({ name, argument }) => `${name} ${argument}`.trim()),
                   ["/replay/pause true", "/replay/step", "/replay/seek 12.50", "/replay/speed 2"]);
});

test("a closed loop moves the map and sends no point again", async () => {
  await open({ points: 20_000, keyframes: 200 });
  await waitForMap(page, 20_000);
  server.robots[0].paused = true;
  const messages = server.robots[0].closeLoop(), bytes = messages.reduce((sum, message) => sum + message.length, 0);
  assert.ok(bytes < 200 * 40, `${bytes} bytes`);
  const look = async () => coarse(page, await screenshot(page, "loop"));
  await page.keyboard.press("2");
  await waitFor(page, () => rtdViewer.fps === 0);
  const beforeLoop = await look();
  for (const message of messages) server.send(message);
  await waitFor(page, () => rtdViewer.fps > 0);
  await waitFor(page, () => rtdViewer.fps === 0);
  const moved = await look();
  assert.ok(differing(beforeLoop, moved, 4) > 0.1, "the picture changed");
  assert.equal((await page.evaluate(() => rtdViewer.counts)).points, 20_000);
});

test("the page comes back by itself after the server was killed", async () => {
  await open();
  await waitForMap(page, 5000);
  const { port } = server;
  await server.stop();
  await waitFor(page, () => document.getElementById("state-text").textContent === "Not connected");
  assert.match(await textOf(page, "#notice-detail"), new RegExp(`127.0.0.1:${port}.*rtd viewer`));
  page.complaints = page.complaints.filter((line) => !/ERR_CONNECTION_REFUSED|WebSocket/.test(line));
  await serve({ points: 3000, keyframes: 40 }, port);
  await waitForMap(page, 3000);
  assert.deepEqual(await page.evaluate(() => [rtdViewer.reconnects, rtdViewer.counts.keyframes]), [1, 40]);
  page.complaints = page.complaints.filter((line) => !/ERR_CONNECTION_REFUSED|WebSocket/.test(line));
});

test("a 3D view that could not be loaded comes once the server is back", async () => {
  const { port, address } = await serve();
  take(await browser.newPage());
  page.complaints = page.outside = [];
  await page.route("**/scene.js", (route) => route.abort(), { times: 1 });
  await page.goto(address);
  await waitFor(page, () => !document.getElementById("no-scene").hidden && rtdViewer.counts.points === 5000);
  await server.stop();
  await waitFor(page, () => rtdViewer.state().connection !== "open");
  await serve({ points: 3000, keyframes: 40 }, port);
  await waitForMap(page, 3000);
  assert.equal(await page.$eval("#no-scene", (node) => node.hidden), true);
});

test("the page says what it waits for", async () => {
  await open({ empty: true });
  await waitFor(page, () => document.getElementById("notice-title").textContent === "Waiting for a robot");
  assert.match(await textOf(page, "#notice-detail"), /DDS domain 0.*rtd run/);
  server.send({ type: "status", robot: 0, services: [{ name: "slam", state: "ready", message: "", metrics: {}, age_ms: 1 }] });
  await waitFor(page, () => document.getElementById("notice-title").textContent === "Waiting for a camera");
  server.send({ type: "status", robot: 0, services: [{ name: "camera", state: "failed", message: "no device", metrics: {}, age_ms: 1 }] });
  await waitFor(page, () => /camera failed/.test(document.getElementById("notice-title").textContent));
});

test("a lost camera is a banner above the map, which stays", async () => {
  await open({ state: "lost" });
  await waitFor(page, () => document.getElementById("notice").className === "notice banner");
  assert.equal(await textOf(page, "#notice-title"), "Tracking lost");
});

test("without WebGL the panels work and a line says why there is no map", async () => {
  const plain = await launchBrowser("--disable-gpu", "--disable-3d-apis");
  try {
    await serve();
    take(await openPage(plain, server.address));
    await waitFor(page, () => !document.getElementById("no-scene").hidden && rtdViewer.counts.points === 5000);
    assert.match(await textOf(page, "#no-scene"), /WebGL/);
    await until(() => server.wanted.at(-1).ready);
    await waitFor(page, () => rtdViewer.poseAgeP50 > 0 && !document.getElementById("image").hidden);
    page.complaints = page.complaints.filter((line) => !/WebGL/.test(line));
  } finally {
    await page.close();
    const { complaints } = page;
    take(undefined);
    await plain.close();
    assert.deepEqual(complaints, []);
  }
});

test("what is hidden is not asked for", async () => {
  await open();
  await waitForMap(page, 5000);
  await page.click("#panel-image > summary");
  await waitFor(page, () => !document.getElementById("panel-image").open);
  await page.click("#layer-dense");
  await until(() => server.wanted.some(({ image, mask, features, dense }) => !image && !mask && !features && !dense));
});

test("a message that cannot be read is counted, and the page continues", async () => {
  await open();
  await waitForMap(page, 5000);
  server.send(Buffer.from([3, 0, 0, 0, 9, 0, 0, 0, 1]));
  await waitFor(page, () => /1 message could not be read/.test(document.getElementById("undecoded").textContent));
  const fresh = await page.evaluate(() => rtdViewer.state().robots[0].tracking.seq);
  await waitFor(page, (seq) => rtdViewer.state().robots[0].tracking.seq > seq + 5, fresh);
});

test("robots and maps are layers that can be hidden; N chooses the next robot", async () => {
  await open({ robots: 2 });
  await waitForMap(page, 5000);
  await waitFor(page, () => document.querySelectorAll("#maps input").length === 2);
  await page.keyboard.press("n");
  await waitFor(page, () => document.getElementById("robot").value === "1" && rtdViewer.state().selected === 1);
});

test("the keyboard: modes, themes, large text, help", async () => {
  await open();
  await waitForMap(page, 5000);
  await page.keyboard.press("2");
  assert.equal(await page.evaluate(() => rtdViewer.state().scene), "above");
  await page.keyboard.press("l");
  assert.equal(await page.$eval("html", (node) => node.classList.contains("large")), true);
  await page.keyboard.press("l");
  await page.keyboard.press("t");
  assert.equal(await page.$eval("html", (node) => node.dataset.theme), "light");
  await page.keyboard.press("t");
  await page.keyboard.press("t");
  await page.keyboard.press("?");
  assert.ok(await page.$("#help[open] kbd"));
});

const kLarge = { width: 1280, height: 800 };
for (const [name, view] of Object.entries({ dark: kLarge, light: { ...kLarge, theme: "light" }, phone: { phone: true, width: 390, height: 844 } })) {
  test(`it looks as it should: ${name}`, async () => {
    await open({}, view);
    await waitForMap(page, 5000);
    await page.keyboard.press("2");
    Object.assign(server.robots[0], { paused: true, time_s: 12 });
    const robot = server.robots[0];
    for (const message of [robot.tracking(), robot.movers(), ...robot.view()]) server.send(message);
    await waitFor(page, () => rtdViewer.fps === 0 && rtdViewer.state().robots[0].imageStamp_s === 12);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);
    assert.ok(wide, "nothing is wider than the screen");
    compareLook(kLooks, name, await coarse(page, await screenshot(page, name)));
  });
}

test("following, the robot is in the lower third of the view: what it goes to fills the rest", async () => {
  await open();
  await waitForMap(page, 5000);
  Object.assign(server.robots[0], { paused: true, time_s: 12 });
  server.send(server.robots[0].tracking());
  await waitFor(page, () => rtdViewer.fps === 0);
  await page.click("#share-open");
  const fields = new URLSearchParams(new URL(await page.$eval("#share-link", ({ value }) => value)).hash.slice(1));
  const [eye, target] = ["eye", "target"].map((name) => fields.get(name).split(",").map(Number));
  const [x, y, z] = await page.evaluate(() => rtdViewer.state().robots[0].tracking.pose);
  const down = (point) => Math.atan2(eye[1] - point[1], Math.hypot(point[0] - eye[0], point[2] - eye[2]));
  const below = Math.tan(down([x, -y, -z]) - down(target)) / Math.tan(27.5 * Math.PI / 180);   // of the middle; 1: at the edge
  assert.ok(below > 1 / 3 && below < 2 / 3, `${below.toFixed(2)} of half the height below the middle`);
});

for (const [points, keyframes] of [[5000, 60], [200_000, 1000]]) {
  test(`frames per second at ${points} points, 800 x 600`, async (context) => {
    await open({ points, keyframes }, { width: 800, height: 600 });
    await waitForMap(page, points);
    const rates = [];
    for (let i = 0; i < 3; ++i) rates.push(await page.evaluate(() => rtdViewer.measureFps(2)));
    const age_ms = await page.evaluate(() => rtdViewer.poseAgeP50);
    context.diagnostic(`${Math.max(...rates).toFixed(1)} frames/s, pose age p50 ${age_ms.toFixed(0)} ms`);
    if (Math.max(...rates) < kLeastFps[points]) context.diagnostic(`below ${kLeastFps[points]}: is the machine busy?`);
    assert.ok(Math.max(...rates) > kLeastFps[points] / 4, `${rates} frames/s`);
  });
}
