// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { addressToLook, aroundTarget, fileOf, hashOf, inMap, parseHash, sceneOf } from "../../../services/viewer/page/share.js";
import { MapState } from "../../../services/viewer/page/world.js";

const kAll = { dense: true, moving: true, points: true, trajectory: true, truth: true };

function mapWith(dense) {
  const map = new MapState(0);
  const positions = Float32Array.from({ length: 3 * dense }, (_, i) => (i % 3 === 0 ? i / 3000 : 1)), colors = new Uint8Array(3 * dense).fill(7);
  if (dense > 0) map.setDense({ start: 0, total: dense, positions, colors });
  map.setPoses({ ids: [4], poses: Float32Array.of(0, 0, 2, 0, 0, 0, 1) });
  map.setPoints({ blocks: [{ keyframe: 4, n: 1, total: 1, scale_m: 0.5, data: Uint8Array.of(2, 0, 0, 0, 254, 255, 255, 0) }] });
  map.setTrajectory({ start: 0, keyframes: Uint32Array.of(4, 9), positions: Float32Array.of(1, 0, 0, 5, 5, 5) });
  return map;
}

function pointsOf({ origin, scale, points }) {
  const bytes = Uint8Array.from(atob(points), (letter) => letter.charCodeAt(0)), steps = new Int16Array(bytes.buffer);
  return Array.from({ length: steps.length / 3 }, (_, i) => [0, 1, 2].map((axis) => Number((origin[axis] + scale * steps[3 * i + axis]).toFixed(2))));
}

test("a link to look has no token that allows more", () => {
  const page = "http://robot:8765/?token=s3cret&x=1";
  assert.equal(addressToLook(page, ""), "http://robot:8765/?x=1", "none is needed to look");
  assert.equal(addressToLook(page, "picture"), "http://robot:8765/?token=picture&x=1");
  assert.equal(addressToLook(page, undefined), page, "this page only looks itself");
});

test("a link brings back layers, view, robot and time", () => {
  const view = { mode: "free", eye: [1, 2.5, -3], target: [0, 0, 0.125] };
  const parsed = parseHash(`#${hashOf({ layers: { dense: true, edges: false, grid: true }, view, robot: "anna & bert", at_s: 12.345 })}`);
  assert.deepEqual(parsed, { layers: ["dense", "grid"], robot: "anna & bert", at_s: 12.35, view });
});

test("a link with nonsense asks for nothing", () => {
  assert.deepEqual(parseHash(""), { layers: undefined, robot: undefined, at_s: undefined, view: undefined });
  assert.equal(parseHash("#eye=1,2&target=a,b,c").view, undefined);
});

test("landmarks and path lie where their keyframe is; what is hidden is left out", () => {
  const { layers } = sceneOf(mapWith(2), { title: "", zUp: false, layers: { ...kAll, dense: false } });
  assert.deepEqual(layers.map(({ name, line }) => [name, line]), [["Landmarks", false], ["Path of the camera", true]]);
  assert.deepEqual(pointsOf(layers[0]), [[1, 0, 1]], "0.5 m * (2, 0, -2) from the keyframe at z = 2");
  assert.deepEqual(pointsOf(layers[1]), [[1, 0, 2]], "the entry of an unknown keyframe has no place");
});

test("a large cloud is thinned evenly to the room there is", () => {
  const scene = sceneOf(mapWith(50_000), { title: "", zUp: false, layers: kAll, room: 200_000 });
  const size = JSON.stringify(scene).length, points = pointsOf(scene.layers[0]);
  assert.ok(size < 200_000 && size > 150_000, String(size));
  assert.deepEqual([points[0][0], points.at(-1)[0] > 49.9], [0, true]);
});

test("the file is the page with the scene in it, and a name cannot end its script", () => {
  const template = readFileSync(new URL("../../../common/map_page/map_page.html", import.meta.url), "utf8");
  const file = fileOf(template, { title: "</script>$&", layers: [] });
  assert.ok(!file.includes("@SCENE@"));
  const [, text] = file.match(/id="scene">(.*?)<\/script>/s);
  assert.equal(JSON.parse(text).title, "</script>$&");
});

test("the view of the file is that of the page", () => {
  assert.deepEqual(inMap([1, 2, 3], false), [1, -2, -3]);
  assert.deepEqual(inMap([1, 2, 3], true), [1, -3, 2]);
  const { distance, tilt, turn } = aroundTarget([0, -1, -1], [0, 0, 0], false);   // behind and above, y is down
  assert.deepEqual([distance, tilt, turn].map((value) => Number(value.toFixed(4))), [1.4142, 0.7854, 0]);
  assert.ok(Math.abs(aroundTarget([-1, 0, 0], [0, 0, 0], true).turn) < 1e-9, "behind a robot that looks along x");
});
