// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { decode } from "../../../services/viewer/page/decode.js";
import { mapBounds, transform } from "../../../services/viewer/page/geometry.js";
import { edgeSlots, frustumLines, slotsApart, trajectoryVertices } from "../../../services/viewer/page/map_lines.js";
import { kFirstSlots, MapState } from "../../../services/viewer/page/world.js";
import * as encode from "../../support/viewer_page/encode.mjs";

const decoded = (bytes) => decode(new Uint8Array(bytes).buffer);
const kIdentity = [0, 0, 0, 1];
const posesOf = (...ids) => decoded(encode.keyframePoses(ids.map((id) => ({ id, t: [id, 0, 0], q: kIdentity }))));
const pointsOf = (keyframe, n, total = n) =>
  decoded(encode.points([{ keyframe, total, scale_m: 0.01, points: Array.from({ length: n }, (_, i) => [i, 0, 1, 255]) }]));

function mapWith(...ids) {
  const map = new MapState(0);
  map.setPoses(posesOf(...ids));
  return map;
}

test("points that come before their pose are counted and drawn once it is there", () => {
  const map = new MapState(0);
  map.setPoints(pointsOf(4, 10));
  assert.equal(map.pointCount, 0);
  assert.equal(map.poses[3], 0, "not drawable");
  map.setPoses(posesOf(4));
  assert.deepEqual([map.pointCount, map.posedCount], [10, 1]);
  assert.ok(Math.abs(map.poses[3] - 0.01) < 1e-6, "drawable at the scale of its points");
});

test("the same message twice changes no count", () => {
  const map = mapWith(1, 2);
  for (let i = 0; i < 2; ++i) {
    map.setPoses(posesOf(1, 2));
    map.setPoints(pointsOf(1, 7, 9));
  }
  assert.deepEqual([map.posedCount, map.pointCount, map.pointTotal], [2, 7, 9]);
});

test("a keyframe that moves keeps its points and only poses are new", () => {
  const map = mapWith(1);
  map.setPoints(pointsOf(1, 7));
  map.takeChanges();
  map.setPoses(decoded(encode.keyframePoses([{ id: 1, t: [5, 6, 7], q: kIdentity }])));
  const changes = map.takeChanges();
  assert.deepEqual([changes.poses, changes.points.size, changes.keyframes, changes.edges], [true, 0, false, false]);
  assert.deepEqual([...map.pose(0).subarray(0, 3)], [5, 6, 7]);
});

test("a removed keyframe takes its points and edges along, and may come back", () => {
  const map = mapWith(1, 2);
  map.setPoints(pointsOf(1, 7));
  map.setCovisibility(decoded(encode.covisibility([{ keyframe: 2, others: [1] }])));
  map.remove({ ids: [1, 99] });
  assert.deepEqual([map.posedCount, map.pointCount, edgeSlots(map).covisibility.length], [1, 0, 0]);
  map.remove({ ids: [1] });
  assert.equal(map.posedCount, 1);
  map.setPoses(posesOf(1));
  assert.equal(map.posedCount, 2);
});

test("of removed keyframes only the places stay, to which the trajectory refers", () => {
  const map = mapWith(1, 2);
  map.setTrajectory(decoded(encode.trajectory(0, [{ keyframe: 1, p: [0, 0, 0] }, { keyframe: 2, p: [0, 0, 1] }])));
  map.remove({ ids: [1] });
  assert.deepEqual([map.keyframes.size, map.posedSlot(1), trajectoryVertices(map).slots.length], [1, 0, 2]);
  map.setPoints(pointsOf(1, 7));   // too late: not drawn, and the trajectory stays
  assert.deepEqual([map.pointCount, map.poses[3], map.posedSlot(1)], [0, 0, 0]);
  map.setPoses(posesOf(1));
  assert.deepEqual([map.pointCount, map.posedSlot(1), map.slots], [7, 0, 2]);
});

test("more keyframes than slots: all poses are kept", () => {
  const ids = Array.from({ length: 3 * kFirstSlots }, (_, i) => i), map = mapWith(...ids);
  assert.equal(map.pose(map.posedSlot(700))[0], 700);
  assert.equal(map.poses.length % kFirstSlots, 0, "whole rows of the texture");
});

test("an edge that both ends name is drawn once, one with an unknown end not at all", () => {
  const map = mapWith(1, 2);
  map.setCovisibility(decoded(encode.covisibility([{ keyframe: 1, others: [2, 50] }, { keyframe: 2, others: [1] }])));
  map.setLoops({ pairs: Uint32Array.of(1, 2, 1, 51) });
  const { covisibility, loops } = edgeSlots(map);
  assert.deepEqual([[...covisibility].sort(), [...loops]], [[0, 1], [0, 1]]);
});

test("a trajectory waits for the poses of its keyframes, and continues at its end", () => {
  const map = mapWith(1);
  map.setTrajectory(decoded(encode.trajectory(0, [{ keyframe: 1, p: [0, 0, 0] }, { keyframe: 1, p: [0, 0, 1] }])));
  map.setTrajectory(decoded(encode.trajectory(2, [{ keyframe: 8, p: [0, 0, 2] }])));
  assert.deepEqual([trajectoryVertices(map).slots.length, trajectoryVertices(map).gaps], [2, true]);
  map.setPoses(posesOf(8));
  const { slots, positions, gaps } = trajectoryVertices(map);
  assert.deepEqual([[...slots], gaps, positions[11]], [[0, 0, 0, 1], false, 2]);
});

test("a part of a trajectory whose beginning is missing is not taken", () => {
  const map = mapWith(1);
  map.setTrajectory(decoded(encode.trajectory(5, [{ keyframe: 1, p: [0, 0, 0] }])));
  assert.equal(map.trajectory.length, 0);
});

test("an hour of poses keeps its numbers, outside of the heap of objects, and what has not come is not known", () => {
  const map = mapWith(1), part = 1000, parts = 108;
  for (let i = 0; i < parts; ++i) {
    map.setTrajectory(decoded(encode.trajectory(part * i, Array.from({ length: part }, (_, k) => ({ keyframe: 1, p: [i, k, 0.5] })))));
  }
  map.setTrajectoryValues(decoded(encode.trajectoryValues(part, [[6, 2.5, 0.01, 0.02]])));
  const { keyframes, positions, length } = map.trajectory, { states, errors_m } = map.values;
  assert.deepEqual([length, keyframes.length, positions.length], [part * parts, part * parts, 3 * part * parts]);
  assert.deepEqual([...positions.slice(0, 3), ...positions.slice(-3)], [0, 0, 0.5, parts - 1, part - 1, 0.5]);
  assert.ok([keyframes, positions, states, errors_m].every(ArrayBuffer.isView));
  assert.deepEqual([states.length, states[0], errors_m[0], states[part]], [part + 1, 0, NaN, 6]);
  assert.ok(trajectoryVertices(map).slots.length <= 2 * 60_000);
});

test("start 0 begins trajectory, ground truth and dense cloud again", () => {
  const map = mapWith(1), entry = { keyframe: 1, p: [0, 0, 0] };
  map.setTrajectory(decoded(encode.trajectory(0, [entry, entry, entry])));
  map.setTrajectory(decoded(encode.trajectory(0, [entry])));
  map.setTruth(decoded(encode.groundTruth(0, [[1, 1, 1], [2, 2, 2]])));
  map.setTruth(decoded(encode.groundTruth(0, [[3, 3, 3]])));
  map.setDense(decoded(encode.densePoints(0, 2, [0, 0, 0], 1, [[0, 0, 0, 0, 0, 0]])));
  map.setDense(decoded(encode.densePoints(1, 2, [0, 0, 0], 1, [[0, 0, 0, 0, 0, 0]])));
  assert.equal(map.dense.parts.length, 2);
  const [, kept] = map.dense.parts;
  map.setDense(decoded(encode.densePoints(0, 2, [0, 0, 0], 1, [[1, 0, 0, 0, 0, 0]])));
  assert.deepEqual([map.dense.parts.length, map.dense.parts.includes(kept)], [2, true], "a renewed cloud comes part by part");
  map.setDense(decoded(encode.densePoints(0, 1, [0, 0, 0], 1, [[0, 0, 0, 0, 0, 0]])));
  assert.deepEqual([map.trajectory.length, [...map.truth], map.dense.parts.length], [1, [3, 3, 3], 1]);
});

test("a quarter turn about y takes forward to the right", () => {
  const out = [];
  transform([10, 0, 0], [0, Math.SQRT1_2, 0, Math.SQRT1_2], [0, 0, 1], out, 0);
  [11, 0, 0].forEach((value, i) => assert.ok(Math.abs(out[i] - value) < 1e-12));
});

test("bounds: without outliers, with all keyframes, none for an empty map", () => {
  const map = mapWith(0, 5);
  map.setPoints(decoded(encode.points([{ keyframe: 0, scale_m: 0.01, points: [...Array(99).fill([1, 2, 3, 0]), [1, 200, 3, 0]] }])));
  const { min, max } = mapBounds(map);
  assert.deepEqual([min[0], max[0]], [0, 5]);
  assert.ok(Math.abs(max[1] - 2) < 1e-5, `${max[1]}`);
  assert.equal(mapBounds(new MapState(0)), null);
});

test("many keyframes are drawn with fewer lines each", () => {
  const lines = (n) => frustumLines(Array.from({ length: n }, (_, i) => i), 0.1).slots.length / n;
  assert.ok(lines(10) > lines(5000));
});

test("keyframes that are close together are drawn once", () => {
  const map = mapWith(0, 1, 2, 3, 4, 5);
  assert.deepEqual([slotsApart(map, 0.5).length, slotsApart(map, 2.5)], [6, [0, 3, 5]]);
  map.remove({ ids: [0] });
  assert.deepEqual(slotsApart(map, 2.5), [1, 3, 5]);
});
