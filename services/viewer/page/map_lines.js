// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Lines of a map as arrays for the graphics card: vertices are positions in the frame of the keyframe in their slot.

const kFewFrustums = 1500;      // up to here every keyframe is drawn as a full frustum, beyond as a simple sign
const kMaxFrustums = 4000;     // beyond, every n-th keyframe is drawn
const kMaxEdges = 15_000;      // beyond, every n-th edge is drawn
const kMaxSteps = 60_000;      // of a trajectory; beyond, every n-th entry is drawn

const kCorners = [[-0.8, -0.6, 1], [0.8, -0.6, 1], [0.8, 0.6, 1], [-0.8, 0.6, 1]];
const kFull = [..."0123"].flatMap((i) => [[0, 0, 0], kCorners[i], kCorners[i], kCorners[(Number(i) + 1) % 4]]);
const kSimple = [[0, 0, 0], kCorners[0], kCorners[0], kCorners[1], kCorners[1], [0, 0, 0]];

/** Slots of keyframes that are so far from each other that they do not hide the map: the first of each cell of a grid. */
export function slotsApart(map, apart_m) {
  const taken = new Set(), slots = [];
  for (const keyframe of map.keyframes.values()) {
    if (!keyframe.posed) continue;
    const cell = [...map.pose(keyframe.slot).subarray(0, 3)].map((value) => Math.floor(value / apart_m)).join();
    if (!taken.has(cell)) slots.push(keyframe.slot);
    taken.add(cell);
  }
  return slots;
}

/** A small camera for every slot, or for every n-th of very many. */
export function frustumLines(all, depth_m) {
  const stride = Math.ceil(all.length / kMaxFrustums) || 1, slots = all.filter((_, i) => i % stride === 0);
  const corners = slots.length <= kFewFrustums ? kFull : kSimple;
  const positions = new Float32Array(3 * corners.length * slots.length);
  const owners = new Float32Array(corners.length * slots.length);
  slots.forEach((slot, i) => {
    corners.forEach((corner, k) => {
      const vertex = i * corners.length + k;
      owners[vertex] = slot;
      for (let axis = 0; axis < 3; ++axis) positions[3 * vertex + axis] = depth_m * corner[axis];
    });
  });
  return { positions, slots: owners };
}

/** Pairs of slots of the keyframes that edges connect; an edge that both ends name is drawn once. */
export function edgeSlots(map) {
  const covisibility = [], loops = [];
  for (const keyframe of map.keyframes.values()) {
    if (!keyframe.posed) continue;
    for (const id of keyframe.others) {
      const other = map.keyframes.get(id);
      if (!other?.posed) continue;
      if (keyframe.id < id || !other.others.includes(keyframe.id)) covisibility.push(keyframe.slot, other.slot);
    }
  }
  for (let i = 0; i + 1 < map.loops.length; i += 2) {
    const a = map.posedSlot(map.loops[i]), b = map.posedSlot(map.loops[i + 1]);
    if (a >= 0 && b >= 0) loops.push(a, b);
  }
  return { covisibility: thin(covisibility), loops: Float32Array.from(loops) };
}

function thin(pairs) {
  const stride = Math.ceil(pairs.length / 2 / kMaxEdges);
  return Float32Array.from(stride > 1 ? pairs.filter((_, i) => (i >> 1) % stride === 0) : pairs);
}

/** Segments between the entries whose keyframes have poses; gaps: some have none yet. colorOf(entry): r, g, b in 0..1. */
export function trajectoryVertices(map, colorOf = () => [1, 1, 1]) {
  const { keyframes, positions, length } = map.trajectory;
  const stride = Math.max(1, Math.ceil(length / kMaxSteps)), most = 2 * Math.ceil(length / stride);   // vertices
  const out = { positions: new Float32Array(3 * most), slots: new Float32Array(most), colors: new Float32Array(3 * most), gaps: false };
  let vertices = 0, before = -1;
  const add = (entry) => {
    out.slots[vertices] = map.posedSlot(keyframes[entry]);
    for (let k = 0; k < 3; ++k) out.positions[3 * vertices + k] = positions[3 * entry + k];
    out.colors.set(colorOf(entry), 3 * vertices);
    vertices += 1;
  };
  for (let entry = 0; entry < length; entry += stride) {
    if (map.posedSlot(keyframes[entry]) < 0) {
      out.gaps = true;
      continue;
    }
    if (before >= 0) {
      add(before);
      add(entry);
    }
    before = entry;
  }
  return { positions: out.positions.slice(0, 3 * vertices), slots: out.slots.slice(0, vertices),
           colors: out.colors.slice(0, 3 * vertices), gaps: out.gaps };
}
