// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { History, difference } from "../../../services/viewer/page/history.js";
import { apart_m, describe, nearest, things } from "../../../services/viewer/page/inspect.js";
import { answerRows, questionAbout } from "../../../services/viewer/page/questions.js";
import { RobotState } from "../../../services/viewer/page/session.js";
import { MapState } from "../../../services/viewer/page/world.js";

const ahead = (x) => [x, 0, 0, 0, 0, 0, 1];   // looks along z
const tracked = (stamp_s, pose = ahead(0)) => ({ stamp_s, seq: 1, state: "ok", pose, map: 0, inliers: 9, removed: 1, static: 100 });
const image = (stamp_s, bytes) => ({ stamp_s, jpeg: new Uint8Array(bytes) });

test("the history is thinned, of bounded length and bounded memory", () => {
  const history = new History();
  for (let i = 0; i < 40_000; ++i) history.add(tracked(i / 30), image(i / 30, 1000));
  assert.ok(history.moments.length <= 601 && history.moments.length > 500, String(history.moments.length));
  assert.ok(history.length_s <= 300);
  const large = new History();
  for (let i = 0; i < 100; ++i) large.add(tracked(i), image(i, 2e6));
  assert.ok(large.bytes <= 40e6);
  assert.equal(large.moments.at(-1).stamp_s, 99);
});

test("a moment is found by how long ago it was", () => {
  const history = new History();
  for (let i = 0; i <= 10; ++i) history.add(tracked(i), null);
  assert.deepEqual([0, 2.5, 4, 99].map((seconds) => history.before(seconds).stamp_s), [10, 7, 6, 0]);
  history.add(tracked(1), null);
  assert.equal(history.moments.length, 1, "time went back: another run");
});

test("an image of another frame is not kept with a pose", () => {
  const history = new History();
  history.add(tracked(10), image(5, 10));
  assert.equal(history.moments[0].image, null);
});

test("images that look towards a point, the nearest first", () => {
  const history = new History();
  for (const [i, x] of [0, 0.5, 30].entries()) history.add(tracked(i, ahead(x)), image(i, 10));
  assert.deepEqual(history.towards([0.6, 0, 2], 0, 5).map(({ stamp_s }) => stamp_s), [1, 0]);
  assert.deepEqual(history.towards([0, 0, -2], 0, 5), [], "behind the cameras");
});

test("between two moments: way and turn, if both are in one map", () => {
  const turned = [3, 4, 0, 0, 0, Math.SQRT1_2, Math.SQRT1_2];
  assert.deepEqual(Object.values(difference(tracked(0), tracked(1, turned))).map((value) => Math.round(value)), [5, 90]);
  assert.equal(difference(tracked(0), { ...tracked(1), map: 1 }), null);
  assert.equal(difference(tracked(0), { ...tracked(1), pose: null }), null);
});

function mapWithThings() {
  const map = new MapState(0);
  map.setPoses({ ids: [7], poses: Float32Array.of(1, 0, 2, 0, 0, 0, 1) });
  map.setPoints({ blocks: [{ keyframe: 7, n: 1, total: 1, scale_m: 1, data: Uint8Array.of(1, 0, 0, 0, 0, 0, 204, 0) }] });
  return map;
}
const kAll = { movers: true, keyframes: true, points: true };
const flat = ([x, y, z]) => (z < 0 ? null : { x: 100 * x, y: 100 * y, depth: z });

test("a click finds what is nearest on the screen and shown", () => {
  const map = mapWithThings(), mover = { id: 3, center: [5, 5, 1], size: [1, 1, 1], velocity: [0.3, 0.4, 0], label: "person", static_probability: 0.1 };
  const at = (x, y, shown = kAll) => nearest(things(map, [mover], shown), { x, y }, flat)?.kind;
  assert.deepEqual([at(203, 2), at(98, 4), at(510, 505), at(300, 300)], ["landmark", "keyframe", "mover", undefined]);
  assert.equal(at(203, 2, { ...kAll, points: false }), undefined, "hidden");
  const [found] = [nearest(things(map, [mover], kAll), { x: 510, y: 505 }, flat)];
  assert.deepEqual(describe(found, null), { title: "person 3", rows: [["Position", "5.00, 5.00, 1.00 m"], ["Size", "1.00, 1.00, 1.00 m"],
                                                                       ["Speed", "0.50 m/s"], ["Static", "10 %"]] });
});

test("a landmark is described by its keyframe and certainty, and measured from another", () => {
  const [keyframe, landmark] = [...things(mapWithThings(), [], kAll)];
  assert.equal(landmark.id, "7/0");
  const { rows } = describe(landmark, { pose: ahead(2) });
  assert.deepEqual(rows.slice(1), [["From the camera", "2.00 m"], ["Of keyframe", "7"], ["Static", "80 %"]]);
  assert.equal(apart_m(keyframe.point, landmark.point), 1);
});

test("a robot keeps its history while it is live, not in a replay", () => {
  const robot = new RobotState(0);
  robot.setTracking(tracked(1), 0);
  robot.playback = { state: "playing", position_s: 0 };
  robot.setTracking(tracked(2), 0);
  assert.equal(robot.history.moments.length, 1);
});

test("a moment is an image with the pose of its frame, not the newest", () => {
  const history = new History();
  for (let i = 0; i < 20; ++i) history.add(tracked(i / 30, ahead(i)), i < 15 ? null : image(10 / 30, 10));
  assert.deepEqual(history.moments.map(({ pose: [x] }) => x), [0, 10]);
});

test("images that saw a landmark: near the stamps of its keyframes, and where it is in them", () => {
  const history = new History(), camera = { fx: 1, fy: 1, cx: 0.5, cy: 0.5 };
  for (let i = 0; i < 10; ++i) history.add(tracked(i, ahead(0.1 * i)), image(i, 10));
  const seen = history.showing([2, 3, 4, 5, 6, 40], [0.4, 0, 2], 0, camera, 3);
  assert.deepEqual(seen.map(({ moment, x, y }) => [moment.stamp_s, Number(x.toFixed(6)), y]), [[2, 0.6, 0.5], [4, 0.5, 0.5], [6, 0.4, 0.5]]);
  assert.deepEqual(history.showing([2], [0, 0, -2], 0, camera, 3), [], "behind the camera");
  assert.deepEqual([history.near(3.2, 0)?.stamp_s, history.near(3.2, 1), history.near(3.4, 0)], [3, undefined, undefined]);
  assert.deepEqual(history.showing([2], [9, 0, 2], 0, camera, 3), [], "outside the image");
});

test("slam is asked about a landmark by its place, and answers in words", () => {
  const [keyframe, landmark] = [...things(mapWithThings(), [], kAll)];
  assert.deepEqual([questionAbout(keyframe), questionAbout(landmark), questionAbout({ kind: "mover" })], ["keyframe 7", "landmark 7 1.0000 0.0000 0.0000", null]);
  assert.deepEqual(answerRows({ observations: 3, found: 9, visible: 10, sigma_m: 0.0042, seen_s: [1, 2, 4] }, 5),
                   [["Observations", "3 keyframes; in 9 of 10 frames"], ["Certain to", "0.4 cm along the worst axis"], ["First seen", "4.0 s ago"], ["Last seen", "1.0 s ago"]]);
  assert.deepEqual(answerRows({ features: 900, connected: 1, sigma_m: 0.01, sigma_deg: 0.2, seen_s: [100] }, 5),
                   [["Features", "900"], ["Connected to", "1 keyframe"], ["Certain to", "1.0 cm, 0.20° along the worst axis"], ["Taken", "in an earlier run"]]);
});
