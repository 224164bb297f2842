// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { companionsOf } from "../../../services/viewer/page/atlas.js";
import { Session } from "../../../services/viewer/page/session.js";

const kHalf = Math.SQRT1_2;
const anna = { name: "anna", met: true, map: [1, 0, 0, 0, 0, kHalf, kHalf], camera: [1, 2, 0, 0, 0, kHalf, kHalf] };   // turned left
const bert = { name: "bert", met: true, map: [0, 0, 0, 0, 0, 0, 1], camera: [1, 3, 1, 0, 0, 0, 1] };
const carl = { name: "carl", met: false, map: null, camera: null };
const near = (actual, expected) => actual.forEach((value, i) => assert.ok(Math.abs(value - expected[i]) < 1e-9, `${actual}`));

test("others are drawn where they are in the map of the robot", () => {
  const [other, ...rest] = companionsOf([anna, bert, carl], "anna");
  assert.deepEqual([other.name, rest], ["bert", []]);
  near(other.pose, [3, 0, 1, 0, 0, -kHalf, kHalf]);
  near(companionsOf([anna, bert], "bert")[0].pose, anna.camera);
});

test("a robot that has not met has no others, and is none", () => {
  assert.deepEqual(companionsOf([anna, bert, carl], "carl"), []);
  assert.deepEqual(companionsOf([anna, carl], "anna"), []);
  assert.deepEqual(companionsOf([anna, bert], "dora"), []);
});

test("a correction of the robot's own map moves the others in it", () => {
  const session = new Session();
  session.applyText({ type: "robots", robots: [{ index: 0, name: "bert" }] }, 0);
  session.applyText({ type: "atlas", robots: [anna, bert] }, 0);
  near(session.robots.get(0).companions[0].pose, anna.camera);
  session.applyText({ type: "atlas", robots: [anna, { ...bert, map: [0.5, 0, 0, 0, 0, 0, 1] }] }, 0);
  near(session.robots.get(0).companions[0].pose.slice(0, 3), [0.5, 2, 0]);
});

test("the order of the messages does not matter", () => {
  const session = new Session();
  session.applyText({ type: "atlas", robots: [anna, bert] }, 0);
  session.applyText({ type: "robots", robots: [{ index: 0, name: "anna" }] }, 0);
  assert.equal(session.robots.get(0).companions[0].name, "bert");
});
