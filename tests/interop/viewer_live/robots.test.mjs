// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Two robots in one domain, each with a rendered camera, filter and slam, and one viewer: seen by the page in Chromium
// and by a client that reads the protocol itself.

import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { requirePackage } from "../../support/viewer_page/fake_server.mjs";
import { launchBrowser, openPage, screenshot, textOf, waitFor } from "../viewer_page/browser.mjs";
import { Service, startViewer, stopAll } from "./rtd_process.mjs";

const WebSocket = requirePackage("ws");
const kFrames = { anna: 60, bert: 40 };
const kNames = Object.keys(kFrames);
const kFewest = 300;   // landmarks of such a map
let folder, browser, page, client, services = [];

/** What the protocol says of each robot, read with the byte offsets of docs/viewer_protocol.md. */
class Client {
  constructor(address) {
    this.names = [];
    this.robots = new Map();   // index -> {points: keyframe -> total, resets, tracking, commands}
    this.answers = [];
    this.socket = new WebSocket(address, "rtd.viewer.v1");
    this.socket.on("message", (data, binary) => (binary ? this.#points(data) : this.#text(JSON.parse(data))));
  }
  robot(name) {
    return this.#of(this.names.indexOf(name));
  }
  call(name, command) {
    this.socket.send(JSON.stringify({ op: "call", id: 1, robot: this.names.indexOf(name), name: command, argument: "" }));
  }
  #of(index) {
    if (!this.robots.has(index)) this.robots.set(index, { points: new Map(), resets: 0, tracking: null, commands: [] });
    return this.robots.get(index);
  }
  #text(message) {
    if (message.type === "robots") this.names = message.robots.map(({ name }) => name);
    if (message.type === "tracking") this.#of(message.robot).tracking = message;
    if (message.type === "commands") this.#of(message.robot).commands = message.commands.map(({ name }) => name);
    if (message.type === "answer") this.answers.push(message);
    if (message.type === "map_reset") {
      this.#of(message.robot).resets += 1;
      this.#of(message.robot).points.clear();
    }
  }
  #points(data) {
    const robot = this.#of(data[1]), count = data.readUInt32LE(4);
    if (data[0] === 2) for (let i = 0; i < count; ++i) robot.points.delete(data.readUInt32LE(8 + 4 * i));
    if (data[0] !== 3) return;
    for (let i = 0, at = 8; i < count; ++i, at += 12 + 8 * data.readUInt16LE(at + 4))
      robot.points.set(data.readUInt32LE(at), data.readUInt16LE(at + 6));
  }
}

const pointsOf = (robot) => [...robot.points.values()].reduce((sum, total) => sum + total, 0);

async function until(condition, what, seconds = 30) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; await new Promise((wake) => setTimeout(wake, 50)))
    if (condition()) return;
  throw new Error(`${what}: ${JSON.stringify([client.names, [...client.robots]])}`);
}

function startRobot(name) {
  const lockstep = ["--robot", name, "--pace", "lockstep"];
  const source = `synthetic:office?frames=${kFrames[name]}&seed=${1 + kNames.indexOf(name)}`;
  return [new Service("slam", ...lockstep, "--out", join(folder, name)),
          new Service("filter", ...lockstep, "--set", "filter.detector=off"),
          new Service("camera", ...lockstep, "--source", source, "--wait-for", "filter,slam")];
}

before(async () => {
  browser = await launchBrowser();
  folder = mkdtempSync(join(tmpdir(), "rtd_robots_"));
  const viewer = await startViewer();
  client = new Client(viewer.socket);
  page = await openPage(browser, viewer.address);
  services = [viewer, ...kNames.flatMap(startRobot)];
});
after(async () => {
  client?.socket.close();
  await browser?.close();
  await stopAll(services);
  rmSync(folder, { recursive: true });
});

/** The page's state of a robot; robots: those of the page. */
const onPage = (name) => page.evaluate((wanted) => rtdViewer.state().robots.find((robot) => robot.name === wanted), name);
const mapOnPage = async (name) => (await onPage(name)).maps.map(({ id, keyframes, points }) => ({ id, keyframes, points }));

test("the protocol lists both robots, and each has as many points as its slam", async () => {
  await until(() => kNames.every((name) => client.names.includes(name)), "robots");
  assert.deepEqual([...client.names].sort(), kNames, "the viewer itself is no robot");
  for (const name of kNames) {
    const robot = client.robot(name);
    const whole = () => robot.tracking?.seq === kFrames[name] - 1 && pointsOf(robot) === robot.tracking.landmarks;
    await until(() => whole() && robot.tracking.landmarks > kFewest, `the whole map of ${name}`);
    assert.deepEqual(robot.commands.filter((command) => command.startsWith("/slam/")).sort(),
                     ["/slam/ask", "/slam/load_map", "/slam/localize_only", "/slam/reset", "/slam/save_map"]);
  }
  assert.notEqual(pointsOf(client.robot("anna")), pointsOf(client.robot("bert")), "two different maps");
});

test("the page shows them as layers, and the image of the chosen one", async () => {
  for (const name of kNames)
    await waitFor(page, ([wanted, points]) => {
      const robot = rtdViewer.state().robots.find((one) => one.name === wanted);
      return robot?.maps.reduce((sum, map) => sum + map.points, 0) === points;
    }, [name, pointsOf(client.robot(name))]);
  await waitFor(page, () => document.querySelectorAll("#maps input").length === 2);
  const layers = await page.$$eval("#maps label", (labels) => labels.map((label) => label.textContent.split(" (")[0]));
  assert.deepEqual(layers, ["anna, map 0", "bert, map 0"]);
  assert.deepEqual(await page.$$eval("#robot option", (options) => options.map((option) => option.textContent)), kNames);
  const chosen = await page.$eval("#robot", (select) => select.selectedOptions[0].textContent);
  const [shown, hidden] = await Promise.all([onPage(chosen), onPage(kNames.find((name) => name !== chosen))]);
  assert.notEqual(shown.imageStamp_s, null);
  assert.equal(hidden.imageStamp_s, null, "what is not shown is not sent");
  await screenshot(page, "robots");
});

test("resetting the map of one robot leaves the other's alone", async () => {
  const others = await mapOnPage("bert"), points = pointsOf(client.robot("bert"));
  await page.selectOption("#robot", String(client.names.indexOf("anna")));
  await waitFor(page, () => document.querySelector('[data-command="/slam/reset"] button')?.disabled === false);
  await page.click('[data-command="/slam/reset"] button');
  await page.click("#confirm [value=yes]");
  await waitFor(page, () => /good|bad/.test(document.querySelector('[data-command="/slam/reset"] output')?.className));
  assert.match(await textOf(page, '[data-command="/slam/reset"] output'), /reset|deleted|empty|new/i);
  await until(() => pointsOf(client.robot("anna")) === 0, "the map of anna is empty");
  await waitFor(page, () => rtdViewer.counts.keyframes === 0);
  assert.deepEqual([client.robot("bert").resets, pointsOf(client.robot("bert"))], [0, points]);
  assert.deepEqual(await mapOnPage("bert"), others);
  await screenshot(page, "robots_reset");

  client.call("bert", "/slam/reset");
  await until(() => client.answers.length === 1 && pointsOf(client.robot("bert")) === 0, "the map of bert is empty");
  assert.equal(client.answers[0].success, true);
});

test("the page does not complain", () => assert.deepEqual(page.complaints, []));
