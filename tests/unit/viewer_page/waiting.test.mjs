// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { RobotState } from "../../../services/viewer/page/session.js";
import { hasEnded, situation } from "../../../services/viewer/page/waiting.js";

const open = { state: "open", address: "ws://host/live", retry_s: 0 };
const hello = { protocol: 1, domain: 3, vendor: "fastdds" };
const service = (name, state = "running", message = "") => ({ name, state, message });

function robotWith(services, changes = {}) {
  return Object.assign(new RobotState(0), { services }, changes);
}

const title = (robot, now_ms = 0, connection = open, greeting = hello) => situation({ connection, hello: greeting, robot, now_ms }).title;
const tracked = (state) => ({ tracking: { state }, trackingAt_ms: 0 });

test("not connected: the address, what to start, when it tries again", () => {
  const report = situation({ connection: { state: "closed", address: "ws://host/live", retry_s: 3 }, hello: null, now_ms: 0 });
  assert.equal(report.level, "bad");
  assert.match(report.detail, /ws:\/\/host\/live.*rtd viewer.* 3 s/);
});

test("from the connection to the first pose, each missing part is named", () => {
  assert.equal(title(undefined, 0, { ...open, state: "connecting" }), "Connecting");
  assert.equal(title(undefined, 0, open, null), "Connected");
  assert.match(situation({ connection: open, hello, now_ms: 0 }).detail, /domain 3/);
  const sourceOf = (services) => situation({ connection: open, hello, robot: robotWith(services), now_ms: 0 });
  assert.equal(title(robotWith([service("slam")])), "Waiting for a camera");
  assert.match(sourceOf([service("slam")]).detail, /has reported yet/, "it may be there");
  assert.match(sourceOf([service("camera", "finished"), service("slam")]).detail, /Neither/);
  assert.equal(title(robotWith([service("camera"), service("slam", "gone")])), "Waiting for slam");
  const waiting = robotWith([service("replay"), service("slam", "ready"), service("filter", "starting", "waits for the detector")]);
  assert.match(situation({ connection: open, hello, robot: waiting, now_ms: 0 }).detail, /slam is starting; filter: waits for the detector/);
});

test("a failed service comes before everything else", () => {
  const report = situation({ connection: open, hello, robot: robotWith([service("camera", "failed", "no such file")], tracked("ok")), now_ms: 0 });
  assert.deepEqual([report.level, report.title, report.detail], ["bad", "camera failed", "no such file"]);
});

test("every state of tracking has words", () => {
  for (const state of ["initializing", "ok", "recently lost", "lost", "relocalizing", "predicted", "doubtful", "odometry"]) {
    assert.doesNotMatch(title(robotWith([service("slam")], tracked(state))), /State:/, state);
  }
  assert.equal(title(robotWith([service("slam")], tracked("dreaming"))), "State: dreaming");
});

test("when no pose comes, the reason: paused, ended, slam gone, unknown", () => {
  const live = [service("camera"), service("slam")];
  assert.equal(title(robotWith(live, tracked("ok")), 10_000), "No pose");
  assert.equal(title(robotWith(live, { ...tracked("ok"), playback: { state: "paused", position_s: 1 } }), 10_000), "Paused");
  assert.equal(situation({ connection: open, hello, robot: robotWith(live, { ...tracked("ok"), playback: { state: "paused", position_s: 1 } }),
                           now_ms: 10_000 }).quiet, true);
  assert.equal(title(robotWith(live, { ...tracked("ok"), playback: { state: "ended" } }), 20_000), "The source has ended");
  assert.equal(title(robotWith([service("camera", "finished"), service("slam")], tracked("ok")), 10_000), "Waiting for the last poses");
  assert.equal(title(robotWith([service("camera", "finished"), service("slam")], tracked("ok")), 20_000), "The source has ended");
  assert.equal(title(robotWith([service("camera", "finished"), service("slam", "finished")], tracked("ok")), 4000), "The source has ended");
  assert.equal(title(robotWith([service("camera", "gone"), service("slam")], tracked("ok")), 10_000), "The camera is gone");
  assert.equal(hasEnded(robotWith([service("camera", "gone")])), false, "one that died has not come to its end");
  assert.equal(title(robotWith([service("camera"), service("slam", "gone")], tracked("ok")), 10_000), "slam is gone");
  const sparse = robotWith([service("replay")], { ...tracked("ok"), playback: { state: "playing", position_s: 5 } });
  assert.deepEqual([title(sparse, 4000), situation({ connection: open, hello, robot: sparse, now_ms: 4000 }).level], ["No pose", "wait"],
                   "a recording needs no slam");
});

test("a source of which a part is missing has not simply ended", () => {
  const robot = robotWith([], tracked("ok")), camera = (pid, state) => robot.setServices([{ ...service("camera", state), pid }, { ...service("slam"), pid: 9 }]);
  camera(1, "running");
  camera(1, "gone");
  camera(2, "running");
  camera(2, "finished");
  assert.equal(title(robot, 10_000), "camera died on the way");
  camera(3, "running");
  camera(3, "finished");
  assert.equal(title(robot, 20_000), "The source has ended", "of the next run");
});

test("a server of another protocol is not tried", () => {
  assert.equal(title(undefined, 0, open, { ...hello, protocol: 2 }), "Page and server do not match");
});
