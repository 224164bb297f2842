// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { decode, expandMask, kPointBytes } from "../../../services/viewer/page/decode.js";
import * as encode from "../../support/viewer_page/encode.mjs";

/** As a WebSocket hands it over: a buffer of its own. */
const decoded = (bytes) => decode(new Uint8Array(bytes).buffer);
const close = (actual, expected, tolerance = 1e-5) => {
  assert.equal(actual.length, expected.length);
  expected.forEach((value, i) => assert.ok(Math.abs(actual[i] - value) <= tolerance, `${i}: ${actual[i]}, expected ${value}`));
};

test("keyframe poses keep ids, robot, map and all seven values", () => {
  const message = decoded(encode.keyframePoses([{ id: 9, t: [1, 2, 3], q: [0, 0.6, 0, 0.8] }, { id: 10, t: [4, 5, 6], q: [0, 0, 0, 1] }],
                                               { robot: 2, map: 300 }));
  assert.deepEqual([message.type, message.robot, message.map, message.count], ["keyframe_poses", 2, 300, 2]);
  assert.deepEqual([...message.ids], [9, 10]);
  close(message.poses, [1, 2, 3, 0, 0.6, 0, 0.8, 4, 5, 6, 0, 0, 0, 1]);
});

test("blocks of points keep their records, their scale and how many there are in all", () => {
  const { type, blocks } = decoded(encode.points([
    { keyframe: 5, scale_m: 0.5, total: 40, points: [[1, -2, 3.5, 200]] }, { keyframe: 6, scale_m: 1, points: [] }]));
  assert.equal(type, "points");
  assert.deepEqual(blocks.map(({ keyframe, n, total, scale_m }) => [keyframe, n, total, scale_m]), [[5, 1, 40, 0.5], [6, 0, 0, 1]]);
  const view = new DataView(blocks[0].data.buffer, blocks[0].data.byteOffset, kPointBytes);
  assert.deepEqual([0, 2, 4].map((byte) => view.getInt16(byte, true)), [2, -4, 7]);
  assert.equal(view.getUint8(6), 200);
});

test("edges, removed keyframes and loops", () => {
  assert.deepEqual([...decoded(encode.covisibility([{ keyframe: 3, others: [1, 2] }])).blocks[0].others], [1, 2]);
  assert.deepEqual([...decoded(encode.keyframesRemoved([7, 8])).ids], [7, 8]);
  assert.deepEqual([...decoded(encode.loopEdges([[1, 90]])).pairs], [1, 90]);
});

test("trajectory and ground truth keep where they start", () => {
  const way = decoded(encode.trajectory(12, [{ keyframe: 4, p: [0.5, 0, -1] }]));
  assert.deepEqual([way.start, [...way.keyframes], [...way.positions]], [12, [4], [0.5, 0, -1]]);
  const truth = decoded(encode.groundTruth(3, [[1, 2, 3]]));
  assert.deepEqual([truth.start, [...truth.positions]], [3, [1, 2, 3]]);
});

test("image and features", () => {
  const image = decoded(encode.image(12.5, 640, 480, Buffer.from([1, 2, 3])));
  assert.deepEqual([image.stamp_s, image.width, image.height, [...image.jpeg]], [12.5, 640, 480, [1, 2, 3]]);
  const features = decoded(encode.features(12.5, 640, 480, [{ u: 10.25, v: 20, removed: false }, { u: 639, v: 1, removed: true }]));
  close(features.us, [10.25, 639]);
  close(features.vs, [20, 1]);
  assert.deepEqual([...features.removed], [0, 1]);
});

test("a mask comes back pixel by pixel, runs longer than 256 included", () => {
  const pixels = new Uint8Array(40 * 30).fill(0, 0, 700).fill(255, 700, 710).fill(128, 710);
  const mask = decoded(encode.dynamicMask(1, 40, 30, pixels));
  assert.deepEqual(expandMask(mask), pixels);
});

test("person masks are runs of labels", () => {
  const labels = Uint8Array.from({ length: 160 * 3 }, (_, i) => (i % 160 < 20 ? 2 : 0));
  const people = decoded(encode.personMasks(1, 160, 3, labels));
  assert.equal(people.type, "people");
  assert.deepEqual(expandMask(people), labels);
});

test("a mask with more pixels than its size is refused", () => {
  const mask = decoded(encode.dynamicMask(1, 10, 10, new Uint8Array(200)));
  assert.throws(() => expandMask(mask), /more than 10 x 10/);
});

test("dense points are in metres of the map", () => {
  const dense = decoded(encode.densePoints(0, 5, [10, 0, -10], 0.01, [[10.5, 0.25, -9, 1, 2, 3]]));
  close(dense.positions, [10.5, 0.25, -9], 0.006);
  assert.deepEqual([...dense.colors], [1, 2, 3]);
});

test("a message of an unknown kind is skipped", () => {
  assert.equal(decode(new Uint8Array([200, 0, 0, 0, 1, 0, 0, 0]).buffer), null);
});

test("every message that is cut off is refused with a reason, at whatever byte", () => {
  const whole = [
    encode.keyframePoses([{ id: 1, t: [0, 0, 0], q: [0, 0, 0, 1] }]), encode.keyframesRemoved([1]),
    encode.points([{ keyframe: 1, scale_m: 1, points: [[1, 1, 1, 1]] }]), encode.covisibility([{ keyframe: 1, others: [2] }]),
    encode.loopEdges([[1, 2]]), encode.trajectory(0, [{ keyframe: 1, p: [0, 0, 0] }]), encode.groundTruth(0, [[0, 0, 0]]),
    encode.image(0, 8, 8, Buffer.from([1])), encode.features(0, 8, 8, [{ u: 1, v: 1 }]),
    encode.dynamicMask(0, 8, 8, new Uint8Array(64)), encode.densePoints(0, 1, [0, 0, 0], 1, [[0, 0, 0, 0, 0, 0]])];
  for (const bytes of whole) {
    for (let length = 0; length < bytes.length; ++length) {
      assert.throws(() => decoded(bytes.subarray(0, length)), RangeError, `kind ${bytes[0]}, ${length} of ${bytes.length} bytes`);
    }
  }
});

test("a count that the message cannot hold allocates nothing and is refused", () => {
  for (const kind of [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12]) {
    const bytes = new Uint8Array(64);
    bytes.set([kind, 0, 0, 0, 255, 255, 255, 255]);
    assert.throws(() => decode(bytes.buffer), RangeError, `kind ${kind}`);
  }
});
