// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Memory of the points that are drawn: chunks, one draw call each, in which every keyframe owns a block.
// A block that is replaced stays where it is if it fits, so little has to be sent to the graphics card again.

export const kChunkPoints = 8192;
const kUnused = -1;             // slot of a vertex that is not drawn
const kGranularity = 32;        // points; blocks of similar size can follow each other in the same place

class Chunk {
  constructor(capacity) {
    this.capacity = capacity;
    this.records = new Int16Array(4 * capacity);   // x, y, z, static probability + 256 * reserved: as in the message
    this.bytes = new Uint8Array(this.records.buffer);
    this.slots = new Float32Array(capacity).fill(kUnused);
    this.used = 0;
    this.clean();
  }
  touch(from, to) {
    this.dirtyFrom = Math.min(this.dirtyFrom, from);
    this.dirtyTo = Math.max(this.dirtyTo, to);
  }
  clean() {
    this.dirtyFrom = this.capacity;
    this.dirtyTo = 0;
  }
}

export class PointPool {
  constructor() {
    this.clear();
  }

  clear() {
    this.chunks = [];
    this.blocks = new Map();   // keyframe -> {chunk, start, capacity, n}
    this.free = new Map();     // capacity -> [{chunk, start}]
    this.live = 0;
  }

  /** Replaces the points of a keyframe; data: records as in the message. */
  set(keyframe, slot, n, data) {
    const capacity = kGranularity * Math.ceil(n / kGranularity);
    let block = this.blocks.get(keyframe);
    if (block && block.capacity !== capacity) {
      this.delete(keyframe);
      block = undefined;
    }
    if (n === 0) return;
    if (!block) {
      block = { ...this.#allocate(capacity), capacity, n: 0 };
      this.blocks.set(keyframe, block);
    }
    this.live += n - block.n;
    block.n = n;
    const { chunk, start } = block;
    chunk.bytes.set(data, 8 * start);
    chunk.slots.fill(slot, start, start + n);
    chunk.slots.fill(kUnused, start + n, start + capacity);
    chunk.touch(start, start + capacity);
  }

  delete(keyframe) {
    const block = this.blocks.get(keyframe);
    if (!block) return;
    this.blocks.delete(keyframe);
    this.live -= block.n;
    const { chunk, start, capacity } = block;
    chunk.slots.fill(kUnused, start, start + capacity);
    chunk.touch(start, start + capacity);
    if (!this.free.has(capacity)) this.free.set(capacity, []);
    this.free.get(capacity).push({ chunk, start });
  }

  /** Whether most of what the graphics card goes through is unused: then it pays to fill a new pool. */
  get wasteful() {
    return this.#used() > 2 * this.live + 4 * kChunkPoints;
  }

  #used() {
    return this.chunks.reduce((sum, chunk) => sum + chunk.used, 0);
  }

  #allocate(capacity) {
    const again = this.free.get(capacity)?.pop();
    if (again) return again;
    let chunk = this.chunks.find((candidate) => candidate.used + capacity <= candidate.capacity);
    if (!chunk) {
      chunk = new Chunk(Math.max(kChunkPoints, capacity));
      this.chunks.push(chunk);
    }
    const start = chunk.used;
    chunk.used += capacity;
    return { chunk, start };
  }
}

const orders = new Map();

/** The numbers 0 .. capacity - 1 in a random order: its first n draw an even sample of a chunk. */
export function drawOrder(capacity) {
  if (!orders.has(capacity)) {
    const order = Uint32Array.from({ length: capacity }, (_, i) => i);
    for (let i = capacity - 1; i > 0; --i) {
      const other = Math.floor(Math.random() * (i + 1));
      [order[i], order[other]] = [order[other], order[i]];
    }
    orders.set(capacity, order);
  }
  return orders.get(capacity);
}
