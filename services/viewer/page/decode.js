// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Binary messages of the protocol `rtd.viewer.v1`, little endian. Pure functions: bytes in, plain objects out.
// Arrays of the result are views into the message where its layout allows it. A message that is too short throws.

export const kPointBytes = 8;    // i16 x, y, z, u8 static probability, u8 reserved
const kHeaderBytes = 8;
const kMaskRunBytes = 2;
const kDensePointBytes = 9;

/** Reads a message front to back and says what is missing when it ends early. */
class Reader {
  constructor(buffer) {
    this.buffer = buffer;
    this.view = new DataView(buffer);
    this.offset = 0;
  }
  take(bytes) {
    const at = this.offset;
    if (bytes > this.buffer.byteLength - at) {
      throw new RangeError(`the message ends at byte ${this.buffer.byteLength}, but ${at + bytes} bytes are needed`);
    }
    this.offset += bytes;
    return at;
  }
  u8() { return this.view.getUint8(this.take(1)); }
  u16() { return this.view.getUint16(this.take(2), true); }
  u32() { return this.view.getUint32(this.take(4), true); }
  f32() { return this.view.getFloat32(this.take(4), true); }
  f64() { return this.view.getFloat64(this.take(8), true); }
  bytes(count) { return new Uint8Array(this.buffer, this.take(count), count); }
  u32s(count) { return new Uint32Array(this.buffer.slice(this.take(4 * count), this.offset)); }
  f32s(count) { return new Float32Array(this.buffer.slice(this.take(4 * count), this.offset)); }
}

/** poses: 7 values per keyframe, t and q_xyzw of T_world_camera. */
function keyframePoses(reader, count) {
  const start = reader.take(32 * count);
  const ids = new Uint32Array(count), poses = new Float32Array(7 * count);
  for (let i = 0; i < count; ++i) {
    const at = start + 32 * i;
    ids[i] = reader.view.getUint32(at, true);
    for (let k = 0; k < 7; ++k) poses[7 * i + k] = reader.view.getFloat32(at + 4 + 4 * k, true);
  }
  return { ids, poses };
}

/** data: the raw records of kPointBytes each; positions are in the keyframe's camera frame, in units of scale_m. */
function points(reader, count) {
  const blocks = [];
  for (let i = 0; i < count; ++i) {
    const keyframe = reader.u32(), n = reader.u16(), total = reader.u16(), scale_m = reader.f32();
    blocks.push({ keyframe, n, total, scale_m, data: reader.bytes(n * kPointBytes) });
  }
  return { blocks };
}

function covisibility(reader, count) {
  const blocks = [];
  for (let i = 0; i < count; ++i) {
    const keyframe = reader.u32(), n = reader.u16();
    reader.u16();
    blocks.push({ keyframe, others: reader.u32s(n) });
  }
  return { blocks };
}

/** positions: 3 values per entry, in the frame of its keyframe, m. */
function trajectory(reader, count) {
  const start = reader.u32(), from = reader.take(16 * count);
  const keyframes = new Uint32Array(count), positions = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const at = from + 16 * i;
    keyframes[i] = reader.view.getUint32(at, true);
    for (let k = 0; k < 3; ++k) positions[3 * i + k] = reader.view.getFloat32(at + 4 + 4 * k, true);
  }
  return { start, keyframes, positions };
}

function image(reader, count) {
  return { stamp_s: reader.f64(), width: reader.u32(), height: reader.u32(), jpeg: reader.bytes(count) };
}

/** A message with its JPEG as something that can be drawn. */
export const toBitmap = ({ jpeg }) => createImageBitmap(new Blob([jpeg], { type: "image/jpeg" }));

/** us, vs: px of the raw image. */
function features(reader, count) {
  const stamp_s = reader.f64(), width = reader.u16(), height = reader.u16();
  const from = reader.take(6 * count);
  const us = new Float32Array(count), vs = new Float32Array(count), removed = new Uint8Array(count);
  for (let i = 0; i < count; ++i) {
    const at = from + 6 * i;
    us[i] = reader.view.getUint16(at, true) / 16;
    vs[i] = reader.view.getUint16(at + 2, true) / 16;
    removed[i] = reader.view.getUint8(at + 4) & 1;
  }
  return { stamp_s, width, height, us, vs, removed };
}

function maskRuns(reader, count) {
  return { stamp_s: reader.f64(), width: reader.u16(), height: reader.u16(), runs: reader.bytes(count) };
}

/** positions: m, frame map. colors: r, g, b, 0..255. */
function densePoints(reader, count) {
  const start = reader.u32(), total = reader.u32();
  const origin = [reader.f32(), reader.f32(), reader.f32()], scale_m = reader.f32();
  const from = reader.take(kDensePointBytes * count);
  const positions = new Float32Array(3 * count), colors = new Uint8Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const at = from + kDensePointBytes * i;
    for (let k = 0; k < 3; ++k) {
      positions[3 * i + k] = origin[k] + scale_m * reader.view.getInt16(at + 2 * k, true);
      colors[3 * i + k] = reader.view.getUint8(at + 6 + k);
    }
  }
  return { start, total, positions, colors };
}

/** Of entries start..: state (its number), s since the first entry, m, m (NaN: unknown). */
function trajectoryValues(reader, count) {
  const start = reader.u32(), from = reader.take(16 * count), column = (offset) =>
    Float32Array.from({ length: count }, (_, i) => reader.view.getFloat32(from + 16 * i + offset, true));
  const states = Uint8Array.from({ length: count }, (_, i) => reader.view.getUint32(from + 16 * i, true));
  return { start, states, times_s: column(4), sigmas_m: column(8), errors_m: column(12) };
}

/** t, q: of the corner of the first cell; its axes x and y lie in the plan. */
function floorPlan(reader, count) {
  const cell_m = reader.f32(), width = reader.u16(), height = reader.u16();
  return { cell_m, width, height, t: reader.f32s(3), q: reader.f32s(4), runs: reader.bytes(count) };
}

const kBodies = {
  1: ["keyframe_poses", keyframePoses],
  2: ["keyframes_removed", (reader, count) => ({ ids: reader.u32s(count) })],
  3: ["points", points],
  4: ["covisibility", covisibility],
  5: ["loop_edges", (reader, count) => ({ pairs: reader.u32s(2 * count) })],
  6: ["trajectory", trajectory],
  7: ["ground_truth", (reader, count) => ({ start: reader.u32(), positions: reader.f32s(3 * count) })],
  8: ["image", image],
  9: ["features", features],
  11: ["mask", maskRuns],
  12: ["dense", densePoints],
  13: ["people", maskRuns],
  14: ["moving", densePoints],
  15: ["plan", floorPlan],
  16: ["trajectory_values", trajectoryValues],
  17: ["depth", image],
};

/** The message as {type, robot, map, ...}; null for a kind that a newer server may send. */
export function decode(buffer) {
  if (buffer.byteLength < kHeaderBytes) throw new RangeError(`a message of ${buffer.byteLength} bytes has no header`);
  const reader = new Reader(buffer);
  const kind = reader.u8(), robot = reader.u8(), map = reader.u16(), count = reader.u32();
  if (!kBodies[kind]) return null;
  const [type, body] = kBodies[kind];
  return { type, robot, map, count, ...body(reader, count) };
}

/** One value per pixel, row by row. Of the dynamic mask: 255 moves or may move, 128 unknown, 0 static; of people: 0 none,
    n the n-th box. Of a floor plan: 0 free, 100 occupied, 255 unknown. */
export function expandMask({ width, height, runs }) {
  const mask = new Uint8Array(width * height);
  let at = 0;
  for (let i = 0; i + 1 < runs.length; i += kMaskRunBytes) {
    const end = at + runs[i + 1] + 1;
    if (end > mask.length) throw new RangeError(`the mask has more than ${width} x ${height} pixels`);
    mask.fill(runs[i], at, end);
    at = end;
  }
  return mask;
}
