// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { Trails } from "../../../services/viewer/page/movers.js";

/** What is said of an object at 10 Hz; sides(time_s): where it begins and ends along x. */
function said(sides, velocity_mps, seconds = 2) {
  const trails = new Trails(), rests = [];
  for (let i = 0; i <= 10 * seconds; ++i) {
    const [low, high] = sides(i / 10), mover = { id: 1, center: [(low + high) / 2, 0, 2], size: [high - low, 1, 1], velocity: [velocity_mps, 0, 0], rests: false };
    rests.push(trails.add({ stamp_s: i / 10, movers: [mover] })[0].rests);
  }
  return rests;
}

test("an object that goes as fast as it is said to moves, from when its trail is long enough", () => {
  const rests = said((t) => [0.8 * t, 0.8 * t + 0.5], 0.8);
  assert.deepEqual([rests[7], rests[8], rests.at(-1)], [true, false, false]);
});

test("one that comes into view grows on one side and rests", () => {
  assert.ok(said((t) => [0, 0.3 + t], 0.5).every(Boolean));
  assert.ok(said(() => [0, 1], 1).every(Boolean), "one with a velocity that it does not follow, too");
});

test("what is certain to rest rests, and a trail with a gap begins again", () => {
  const trails = new Trails(), at = (stamp_s, rests) => trails.add({ stamp_s, movers: [{ id: 1, center: [stamp_s, 0, 0], size: [1, 1, 1], velocity: [1, 0, 0], rests }] })[0].rests;
  assert.deepEqual([at(0, false), at(1, true), at(1.2, false), at(9, false), at(0, false)], [true, true, false, true, true]);
});
