// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { decode } from "../../../services/viewer/page/decode.js";
import { inOrder, Session } from "../../../services/viewer/page/session.js";
import * as encode from "../../support/viewer_page/encode.mjs";

const decoded = (bytes) => decode(new Uint8Array(bytes).buffer);
const tracking = { type: "tracking", robot: 0, state: "ok", pose: null, inliers: 10, static: 75, removed: 25, latency_ms: 20,
                   stage_ms: { match: 1, total: 5 }, filter_stage_ms: { ego_motion: 2, filter_total: 9 } };

test("messages of a robot that was not announced yet are kept, in any order", () => {
  const session = new Session();
  session.applyBinary(decoded(encode.keyframePoses([{ id: 1, t: [0, 0, 0], q: [0, 0, 0, 1] }], { robot: 1, map: 2 })));
  session.applyText({ type: "robots", robots: [{ index: 1, name: "b" }] }, 0);
  assert.equal(session.robots.get(1).name, "b");
  assert.equal(session.robots.get(1).map(2).posedCount, 1);
});

test("a robot that is no longer in the list goes", () => {
  const session = new Session();
  session.applyText({ type: "robots", robots: [{ index: 0, name: "a" }, { index: 1, name: "b" }] }, 0);
  session.applyText({ type: "robots", robots: [{ index: 1, name: "b" }] }, 0);
  assert.deepEqual([...session.robots.keys()], [1]);
});

test("robots are found by name, whatever index a restarted viewer gives them", () => {
  const session = new Session();
  assert.equal(session.robotNamed("a"), undefined);
  session.applyText({ type: "robots", robots: [{ index: 0, name: "b" }, { index: 1, name: "a" }] }, 0);
  assert.deepEqual(session.byName.map(({ name }) => name), ["a", "b"]);
  assert.equal(session.robotNamed("b").index, 0);
  assert.equal(session.robotNamed("gone").index, 1, "the first one");
  const again = new Session();
  again.applyText({ type: "robots", robots: [{ index: 0, name: "a" }, { index: 1, name: "b" }] }, 0);
  assert.equal(again.robotNamed("b").index, 1);
  assert.equal(again.robots.get(1).mapKey(0), session.robots.get(0).mapKey(0));
});

test("a page that opens late knows how old pose and image are, and says only what it knows", () => {
  const session = new Session(), robot = session.robot(0);
  session.applyText({ type: "hello", server_ms: 700_000 }, 50);
  session.applyText({ type: "map_reset", robot: 0 }, 50);
  assert.deepEqual(robot.events.entries, [], "there was no map before");
  session.applyText({ ...tracking, finished_ms: 100_000, stamp_s: 8 }, 60);
  robot.image = { stamp_s: 6 };
  assert.deepEqual([robot.trackingAt_ms, robot.imageAge_s(60)], [50 - 600_000, 602.01]);
  session.applyText({ ...tracking, finished_ms: 100_000 }, 9000);
  assert.equal(robot.trackingAt_ms, 9000, "whatever the clocks do later");
  session.applyText({ type: "status", robot: 0, services: [{ name: "viewer", state: "gone" }, { name: "slam", state: "gone" }] }, 9000);
  assert.deepEqual(robot.services.map(({ state }) => state), ["running", "gone"], "the viewer itself sent this");
});

test("map_reset forgets the maps and what moves in them, and nothing else", () => {
  const session = new Session();
  session.applyText(tracking, 0);
  session.applyText({ type: "movers", robot: 0, movers: [{}] }, 0);
  session.applyBinary(decoded(encode.keyframePoses([{ id: 1, t: [0, 0, 0], q: [0, 0, 0, 1] }])));
  session.applyText({ type: "map_reset", robot: 0 }, 0);
  const robot = session.robots.get(0);
  assert.deepEqual([robot.count("posedCount"), robot.movers.length, robot.tracking], [0, 0, tracking]);
});

test("histories: removed share in percent, stages without the totals", () => {
  const session = new Session();
  session.applyText(tracking, 1000);
  const { removedShare, stage_ms, latency_ms } = session.robots.get(0).series;
  assert.deepEqual([removedShare.last, latency_ms.last], [25, 20]);
  assert.deepEqual(stage_ms.last, { "filter ego motion": 2, "slam match": 1 });
});

test("stages are listed in the order in which they run, unknown ones last", () => {
  assert.deepEqual(inOrder(["slam new stage", "slam local map", "slam match", "filter wait detections"]),
                   ["filter wait detections", "slam match", "slam local map", "slam new stage"]);
});

test("an overlay belongs to the image of its frame only", () => {
  const session = new Session();
  session.applyBinary(decoded(encode.image(10, 8, 8, Buffer.from([1]))));
  const robot = session.robots.get(0);
  session.applyText({ type: "boxes", robot: 0, stamp_s: 9.95, boxes: [] }, 0);
  assert.ok(robot.overlay("boxes"));
  session.applyText({ type: "boxes", robot: 0, stamp_s: 9.8, boxes: [] }, 0);
  assert.equal(robot.overlay("boxes"), null);
});

test("a message of a newer server changes nothing", () => {
  const session = new Session();
  session.applyText({ type: "weather", robot: 5 }, 0);
  assert.equal(session.robots.size, 0);
});

test("slam says whether z is up in its maps", () => {
  const session = new Session();
  session.applyText({ type: "robots", robots: [{ index: 0, name: "" }] }, 0);
  const robot = session.robots.get(0);
  assert.equal(robot.zUp, false);
  const slam = { name: "slam", state: "running", message: "", metrics: { map_z_up: 1 }, age_ms: 1 };
  session.applyText({ type: "status", robot: 0, services: [slam] }, 0);
  assert.equal(robot.zUp, true);
  session.applyText({ type: "status", robot: 0, services: [{ ...slam, metrics: {} }] }, 0);
  assert.equal(robot.zUp, false);
});
