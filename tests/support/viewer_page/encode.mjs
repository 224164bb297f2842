// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Writes the binary messages of the protocol `rtd.viewer.v1`, for tests of the page.

/** A message that grows; little endian. */
class Writer {
  constructor(kind, count, { robot = 0, map = 0 } = {}) {
    this.bytes = Buffer.alloc(1024);
    this.length = 0;
    this.u8(kind).u8(robot).u16(map).u32(count);
  }
  #room(size) {
    while (this.length + size > this.bytes.length) this.bytes = Buffer.concat([this.bytes, Buffer.alloc(this.bytes.length)]);
    this.length += size;
    return this.length - size;
  }
  u8(value) { return this.#put("writeUInt8", 1, value); }
  u16(value) { return this.#put("writeUInt16LE", 2, value); }
  i16(value) { return this.#put("writeInt16LE", 2, Math.round(value)); }
  u32(value) { return this.#put("writeUInt32LE", 4, value); }
  f32(...values) { for (const value of values) this.#put("writeFloatLE", 4, value); return this; }
  f64(value) { return this.#put("writeDoubleLE", 8, value); }
  raw(bytes) {
    const at = this.#room(bytes.length);
    this.bytes.set(bytes, at);
    return this;
  }
  #put(write, size, value) {
    const at = this.#room(size);   // may replace this.bytes
    this.bytes[write](value, at);
    return this;
  }
  done() { return this.bytes.subarray(0, this.length); }
}

/** poses: [{id, t, q}] */
export function keyframePoses(poses, at) {
  const out = new Writer(1, poses.length, at);
  for (const { id, t, q } of poses) out.u32(id).f32(...t, ...q);
  return out.done();
}

export function keyframesRemoved(ids, at) {
  const out = new Writer(2, ids.length, at);
  for (const id of ids) out.u32(id);
  return out.done();
}

/** blocks: [{keyframe, total, scale_m, points: [[x, y, z, static_probability 0..255]]}], positions in m. */
export function points(blocks, at) {
  const out = new Writer(3, blocks.length, at);
  for (const { keyframe, total, scale_m, points: list } of blocks) {
    out.u32(keyframe).u16(list.length).u16(total ?? list.length).f32(scale_m);
    for (const [x, y, z, probability] of list) out.i16(x / scale_m).i16(y / scale_m).i16(z / scale_m).u8(probability).u8(0);
  }
  return out.done();
}

/** blocks: [{keyframe, others: [id]}] */
export function covisibility(blocks, at) {
  const out = new Writer(4, blocks.length, at);
  for (const { keyframe, others } of blocks) {
    out.u32(keyframe).u16(others.length).u16(0);
    for (const other of others) out.u32(other);
  }
  return out.done();
}

export function loopEdges(pairs, at) {
  const out = new Writer(5, pairs.length, at);
  for (const [a, b] of pairs) out.u32(a).u32(b);
  return out.done();
}

/** entries: [{keyframe, p}] */
export function trajectory(start, entries, at) {
  const out = new Writer(6, entries.length, at).u32(start);
  for (const { keyframe, p } of entries) out.u32(keyframe).f32(...p);
  return out.done();
}

export function groundTruth(start, positions, at) {
  const out = new Writer(7, positions.length, at).u32(start);
  for (const p of positions) out.f32(...p);
  return out.done();
}

export function image(stamp_s, width, height, jpeg, at) {
  return new Writer(8, jpeg.length, at).f64(stamp_s).u32(width).u32(height).raw(jpeg).done();
}

export function depth(stamp_s, width, height, jpeg, at) {
  return new Writer(17, jpeg.length, at).f64(stamp_s).u32(width).u32(height).raw(jpeg).done();
}

/** list: [{u, v, removed}], px */
export function features(stamp_s, width, height, list, at) {
  const out = new Writer(9, list.length, at).f64(stamp_s).u16(width).u16(height);
  for (const { u, v, removed } of list) out.u16(Math.round(16 * u)).u16(Math.round(16 * v)).u8(removed ? 1 : 0).u8(removed ? 20 : 240);
  return out.done();
}

/** mask: one value per pixel, row by row. */
function maskRuns(kind, stamp_s, width, height, mask, at) {
  const runs = [];
  for (let i = 0, end; i < mask.length; i = end) {
    for (end = i + 1; end < mask.length && mask[end] === mask[i] && end - i < 256; ++end);
    runs.push(mask[i], end - i - 1);
  }
  return new Writer(kind, runs.length, at).f64(stamp_s).u16(width).u16(height).raw(runs).done();
}
export const dynamicMask = (...mask) => maskRuns(11, ...mask);
export const personMasks = (...labels) => maskRuns(13, ...labels);

/** list: [[x, y, z, r, g, b]], m */
export const densePoints = (...cloud) => cloudPoints(12, ...cloud);
export const movingPoints = (...cloud) => cloudPoints(14, ...cloud);

function cloudPoints(kind, start, total, origin, scale_m, list, at) {
  const out = new Writer(kind, list.length, at).u32(start).u32(total).f32(...origin, scale_m);
  for (const [x, y, z, r, g, b] of list) {
    out.i16((x - origin[0]) / scale_m).i16((y - origin[1]) / scale_m).i16((z - origin[2]) / scale_m).u8(r).u8(g).u8(b);
  }
  return out.done();
}

/** cells: 0 free, 100 occupied, 255 unknown, row by row. */
export function floorPlan(cell_m, width, height, t, q, cells, at) {
  const runs = [...cells].flatMap((cell) => [cell, 0]);
  return new Writer(15, runs.length, at).f32(cell_m).u16(width).u16(height).f32(...t, ...q).raw(Uint8Array.from(runs)).done();
}

/** values: [[state, t_s, sigma_m, error_m]] */
export function trajectoryValues(start, values, at) {
  const out = new Writer(16, values.length, at).u32(start);
  for (const [state, ...numbers] of values) out.u32(state).f32(...numbers);
  return out.done();
}
