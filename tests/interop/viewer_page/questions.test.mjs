// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What the page shows and answers beside the map: the room, depth, why a pose is doubtful, what happened, what is asked.

import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { test } from "node:test";
import { coarse, openPage, screenshot, textOf, waitFor, waitForMap } from "./browser.mjs";
import { browser, open, page, server, until } from "./harness.mjs";

test("the room is drawn in colour, what moved and the floor plan on request", async () => {
  await open({ dense: 20_000 });
  await waitForMap(page, 5000);
  await waitFor(page, () => rtdViewer.state().robots[0].maps[0].dense === 20_000);
  await page.click("#layer-moving");
  await page.click("#layer-plan");
  await until(() => server.wanted.at(-1)?.moving && server.wanted.at(-1).plan && server.wanted.at(-1).dense);
  assert.deepEqual(await page.evaluate(() => rtdViewer.state().robots[0].maps.map(({ moving, plan }) => [moving, plan])), [[500, true]]);
});

test("a doubtful pose is explained, and becomes an event", async () => {
  await open({ state: "ok", replay: false });
  await waitForMap(page, 5000);
  server.robots[0].state = "doubtful";
  await waitFor(page, () => /Moving now: person/.test(document.getElementById("notice-detail").textContent));
  await waitFor(page, () => [...document.querySelectorAll("#events .event")].some((node) => /tracking: doubtful/.test(node.textContent)));
  await waitFor(page, () => /38 landmarks disagree with it, 41 agree. Of the former, 30 moved together, 12.0 cm/.test(document.getElementById("notice-detail").textContent));
  await waitFor(page, () => !document.getElementById("doubt-key").hidden && document.getElementById("disagree").textContent === "38");
  const drawn = await page.$eval("#image", (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(380, 230, 120, 90);
    return data.reduce((count, red, i) => count + (i % 4 === 0 && Math.abs(red - 232) + Math.abs(data[i + 1] - 121) + Math.abs(data[i + 2] - 249) < 12), 0);
  });
  assert.ok(drawn > 300, `${drawn} pixels have the colour of the motion that 30 landmarks follow`);
  await screenshot(page, "doubt");
  await page.selectOption("#events-filter", "trouble");
  await waitFor(page, () => [...document.querySelectorAll("#events .event")].every((node) => node.dataset.level !== "ok"));
});

test("a click on an event of a replay seeks there", async () => {
  await open();
  await waitFor(page, () => document.querySelector("#events .event") && !document.getElementById("seek").disabled);
  server.robots[0].state = "lost";
  await waitFor(page, () => /tracking: lost/.test(document.querySelector("#events .event").textContent));
  const at_s = server.robots[0].time_s;
  await page.click("#events .event");
  await until(() => server.calls.some(({ name }) => name === "/replay/seek"));
  assert.ok(Math.abs(Number(server.calls.at(-1).argument) - at_s) < 1.5, server.calls.at(-1).argument);
});

test("a live run can be scrubbed back and two of its moments compared", async () => {
  await open({ replay: false });
  await waitForMap(page, 5000);
  await waitFor(page, () => !document.getElementById("history").hidden);
  await page.click("#history-pin");
  await page.$eval("#history-seek", (slider) => {
    slider.value = -2.5;
    slider.dispatchEvent(new Event("input"));
  });
  await waitFor(page, () => / s ago, ok/.test(document.getElementById("history-time").textContent));
  await waitFor(page, () => /s apart: moved .* turned/.test(document.getElementById("compare-text").textContent));
  assert.equal(await page.$$eval("#compare img", (images) => images.length), 2);
  await page.click("#history-live");
  assert.equal(await textOf(page, "#history-time"), "live");
  server.robots[0].sendsPoses = false;
  await waitFor(page, () => document.getElementById("history-time").textContent === "last pose");
  assert.equal(await textOf(page, "#age"), "–", "of no pose that comes");
  server.robots[0].sendsPoses = true;
});

test("a click asks a thing, Shift and a click measures", async () => {
  await open({ points: 20_000 });
  await waitForMap(page, 20_000);
  await page.keyboard.press("2");
  await page.waitForFunction(() => rtdViewer.state().scene === "above");
  const { x, y, width, height } = await (await page.$("#map canvas")).boundingBox();
  const ask = async (u) => {
    for (let i = 0; i < 30; ++i) {
      await page.mouse.click(x + width * (u + 0.005 * i), y + height / 2);
      if (!(await page.$eval("#inspect", (card) => card.hidden))) return textOf(page, "#inspect-title");
    }
    return "";
  };
  assert.match(await ask(0.4), /^(Landmark|Keyframe|person) /);
  await page.keyboard.down("Shift");
  assert.notEqual(await ask(0.55), "");
  await page.keyboard.up("Shift");
  await page.click("#inspect-close");
  assert.equal(await page.$eval("#inspect", (card) => card.hidden), true);
});

test("slam is asked about a landmark: observations, certainty, and the images that saw it", async () => {
  await open({ points: 20_000, replay: false });
  await waitForMap(page, 20_000);
  await waitFor(page, () => !document.getElementById("history").hidden);
  await page.click("#layer-keyframes");
  await page.click("#layer-movers");
  const { x, y, width, height } = await (await page.$("#map canvas")).boundingBox();
  let title = "";
  for (let i = 0; i < 400 && !title.startsWith("Landmark"); ++i) {
    await page.mouse.click(x + width * (0.25 + 0.025 * (i % 20)), y + height * (0.3 + 0.02 * Math.floor(i / 20)));
    title = await page.$eval("#inspect", (card) => (card.hidden ? "" : card.querySelector("#inspect-title").textContent));
  }
  assert.match(title, /^Landmark/);
  await waitFor(page, () => /60 keyframes; in 130 of 160 frames.*0\.4 cm along the worst axis.*First seen.*Last seen/s.test(document.getElementById("inspect-rows").textContent));
  assert.match(server.calls.at(-1).argument, /^landmark \d+ -?\d+\.\d+ -?\d+\.\d+ -?\d+\.\d+$/);
  await screenshot(page, "landmark");
});

test("a link opens the same layers and view; a file holds the map", async () => {
  await open({ dense: 5000 });
  await waitForMap(page, 5000);
  await waitFor(page, () => rtdViewer.state().robots[0].maps[0].dense === 5000);
  await page.click("#layer-keyframes");
  await page.keyboard.press("3");
  await page.evaluate(() => rtdViewer.measureFps(0.2));   // frames were drawn
  for (const key of ["h", "Escape"]) await page.keyboard.press(key);
  await page.click("#share-open");
  const linkNow = () => page.$eval("#share-link", (field) => field.value);
  const link = await linkNow();
  assert.ok(link.includes("token=picture"), "it lets others look");
  await screenshot(page, "share");
  await page.click("#share-control");
  assert.ok(!(await linkNow()).includes("token=picture"), "with control it has the page's own token");
  const folder = mkdtempSync(join(tmpdir(), "rtd_share_")), file = join(folder, "saved.html");
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#share-save")]);
  assert.match(download.suggestedFilename(), /\.html$/);
  await waitFor(page, () => /MB, opens in any browser/.test(document.getElementById("share-answer").textContent));
  await download.saveAs(file);
  const saved = await openPage(browser, pathToFileURL(file).href);
  await waitFor(saved, () => document.documentElement.dataset.drawn === "yes");
  assert.match(await textOf(saved, "#layers"), /Room \(5,000 points\)/);
  assert.ok((await coarse(saved, await screenshot(saved, "map_file"))).other > 0.01, "the map is drawn");
  assert.deepEqual([saved.complaints, saved.outside], [[], []]);
  await saved.close();
  rmSync(folder, { recursive: true });
  const other = await openPage(page.context(), link);
  await waitForMap(other, 5000);
  assert.equal(await other.$eval("#layer-keyframes", (box) => box.checked), false);
  assert.equal(await other.evaluate(() => rtdViewer.state().scene), "free");
  await other.close();
});

test("several robots at a glance; a click goes to one", async () => {
  await open({ robots: 3 });
  await waitFor(page, () => document.querySelectorAll("#fleet tr").length === 4);
  await waitFor(page, () => document.querySelector("#fleet tr:nth-child(3) td").textContent === "Tracking");
  await page.click("#fleet tr:nth-child(3) button");
  await waitFor(page, () => rtdViewer.state().selected === 1 && document.querySelector("#fleet tr:nth-child(3)").classList.contains("selected"));
});

test("the path is coloured by error, with a legend", async () => {
  await open();
  await waitForMap(page, 5000);
  await page.selectOption("#path-coloring", "error");
  await waitFor(page, () => /red: .* and more/.test(document.getElementById("path-legend").textContent));
});

test("the depth is shown beside the image on request, and asked for only then", async () => {
  await open();
  await waitFor(page, () => !document.getElementById("image").hidden);
  assert.deepEqual([server.wanted.at(-1).depth, await page.$eval("#depth-figure", (figure) => figure.hidden)], [false, true]);
  await page.click("#overlay-depth");
  await until(() => server.wanted.at(-1).depth);
  await waitFor(page, () => document.getElementById("depth").width === 320 && !document.getElementById("depth").hidden);
  const colors = await page.$eval("#depth", (canvas) => [[150, 20], [20, 200]].map(([x, y]) => [...canvas.getContext("2d").getImageData(x, y, 1, 1).data]));
  assert.ok(colors[0][2] < 60 && colors[1][2] > 180, `above nothing is measured, below it is far: ${colors}`);
  await screenshot(page, "depth");
  await page.click("#overlay-depth");
  await waitFor(page, () => document.getElementById("depth-figure").hidden);
  await until(() => !server.wanted.at(-1).depth);
});
