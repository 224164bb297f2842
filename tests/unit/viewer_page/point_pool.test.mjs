// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { drawOrder, kChunkPoints, PointPool } from "../../../services/viewer/page/point_pool.js";

const records = (n, value = 1) => new Uint8Array(8 * n).fill(value);
const drawn = (pool) => pool.chunks.reduce((sum, { slots }) => sum + slots.filter((slot) => slot >= 0).length, 0);

test("every point that was set is drawn, with the slot of its keyframe", () => {
  const pool = new PointPool();
  pool.set(7, 3, 50, records(50));
  pool.set(8, 4, 10, records(10));
  assert.equal(drawn(pool), 60);
  assert.equal(pool.chunks[0].slots[49], 3);
  assert.equal(pool.live, 60);
});

test("a block that is replaced by one of similar size stays where it is", () => {
  const pool = new PointPool();
  pool.set(7, 0, 50, records(50));
  pool.set(8, 1, 50, records(50));
  const { used } = pool.chunks[0];
  pool.chunks[0].clean();
  pool.set(7, 0, 40, records(40, 2));
  assert.deepEqual([pool.chunks[0].used, drawn(pool), pool.chunks[0].bytes[0]], [used, 90, 2]);
  assert.ok(pool.chunks[0].dirtyTo <= 64, "only its own block is sent again");
});

test("the place of a deleted block is used again", () => {
  const pool = new PointPool();
  pool.set(1, 0, 30, records(30));
  pool.delete(1);
  assert.equal(drawn(pool), 0);
  pool.set(2, 1, 25, records(25));
  assert.equal(pool.chunks[0].used, 32);
});

test("a block never lies in two chunks", () => {
  const pool = new PointPool();
  pool.set(1, 0, kChunkPoints - 10, records(kChunkPoints - 10));
  pool.set(2, 1, 100, records(100));
  assert.equal(pool.chunks.length, 2);
  assert.equal(drawn(pool), kChunkPoints + 90);
});

test("a block that is larger than a chunk gets one of its own", () => {
  const pool = new PointPool();
  pool.set(1, 0, 65535, records(65535));
  pool.set(2, 1, 100, records(100));
  assert.deepEqual([drawn(pool), pool.chunks.length], [65635, 2]);
});

test("the order of drawing has every point once, and no part of it prefers a part of the chunk", () => {
  const order = drawOrder(1000);
  assert.equal(new Set(order).size, 1000);
  const first = order.subarray(0, 300).filter((i) => i < 500).length;
  assert.ok(first > 100 && first < 200, `${first} of 300 in the first half`);
});

test("a keyframe without points takes no place", () => {
  const pool = new PointPool();
  pool.set(1, 0, 40, records(40));
  pool.set(1, 0, 0, records(0));
  assert.deepEqual([drawn(pool), pool.live, pool.blocks.size], [0, 0, 0]);
});

test("a pool that is mostly unused says so", () => {
  const pool = new PointPool();
  for (let id = 0; id < 3000; ++id) pool.set(id, id, 32, records(32));
  assert.equal(pool.wasteful, false);
  for (let id = 0; id < 3000; ++id) pool.delete(id);
  assert.equal(pool.wasteful, true);
});
