// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Geometry of a map without a graphics library: p_a = T_a_b * p_b with a pose as t_xyz and q_xyzw.

/** q * v, written to out at index `at`. */
export function transform(t, q, v, out, at) {
  const [x, y, z, w] = q;
  const cx = y * v[2] - z * v[1] + w * v[0], cy = z * v[0] - x * v[2] + w * v[1], cz = x * v[1] - y * v[0] + w * v[2];
  out[at] = t[0] + v[0] + 2 * (y * cz - z * cy);
  out[at + 1] = t[1] + v[1] + 2 * (z * cx - x * cz);
  out[at + 2] = t[2] + v[2] + 2 * (x * cy - y * cx);
}

/** A landmark of a keyframe, its place-th, in the frame of the keyframe's camera. */
export function landmarkInCamera({ points: { data, scale_m } }, place) {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  return [0, 2, 4].map((byte) => scale_m * view.getInt16(8 * place + byte, true));
}

/** Writes a landmark of a keyframe, its place-th, in the map's frame to out at index `at`. */
export function landmark(map, keyframe, place, out, at) {
  const pose = map.pose(keyframe.slot);
  transform(pose, pose.subarray(4), landmarkInCamera(keyframe, place), out, at);
}

/** Where a camera with this pose sees a point: {x, y} as shares of its image, or null outside. camera: {fx, fy, cx, cy},
    as such shares, too. */
export function pictured(pose, point, { fx, fy, cx, cy }) {
  const [x, y, z, qx, qy, qz, qw] = pose, seen = [];
  transform([0, 0, 0], [-qx, -qy, -qz, qw], [point[0] - x, point[1] - y, point[2] - z], seen, 0);
  if (seen[2] < 0.01) return null;
  const at = { x: fx * seen[0] / seen[2] + cx, y: fy * seen[1] / seen[2] + cy };
  return at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1 ? at : null;
}

const kSamples = 3000;
const kOutlierShare = 0.02;

/** About kSamples points of the map in its world frame, evenly over the keyframes; 3 values each. */
export function samplePoints(map) {
  const stride = Math.max(1, Math.floor(map.pointCount / kSamples));
  const out = [];
  let skip = 0;
  for (const keyframe of map.keyframes.values()) {
    if (!keyframe.posed || !keyframe.points) continue;
    const { n } = keyframe.points;
    for (; skip < n; skip += stride) landmark(map, keyframe, skip, out, out.length);
    skip -= n;
  }
  return out;
}

/** {min, max} of the map without its outermost 2 %, or of its keyframes when it has no points; null if it is empty. */
export function mapBounds(map) {
  let positions = samplePoints(map);
  const trim = positions.length > 0 ? kOutlierShare : 0;
  if (positions.length === 0) positions = keyframePositions(map);
  if (positions.length === 0) return null;
  const min = [], max = [];
  for (let axis = 0; axis < 3; ++axis) {
    const values = positions.filter((_, i) => i % 3 === axis).sort((a, b) => a - b);
    const skip = Math.floor(trim * values.length);
    min.push(values[skip]);
    max.push(values[values.length - 1 - skip]);
  }
  return includeKeyframes(map, { min, max });
}

/** Diagonal of the box around all keyframes, m. */
export function keyframeExtent_m(map) {
  const { min, max } = includeKeyframes(map, { min: [Infinity, Infinity, Infinity], max: [-Infinity, -Infinity, -Infinity] });
  return map.posedCount > 0 ? Math.hypot(...max.map((value, axis) => value - min[axis])) : 0;
}

function keyframePositions(map) {
  const positions = [];
  for (const keyframe of map.keyframes.values()) {
    if (keyframe.posed) positions.push(...map.pose(keyframe.slot).subarray(0, 3));
  }
  return positions;
}

function includeKeyframes(map, bounds) {
  keyframePositions(map).forEach((value, i) => {
    bounds.min[i % 3] = Math.min(bounds.min[i % 3], value);
    bounds.max[i % 3] = Math.max(bounds.max[i % 3], value);
  });
  return bounds;
}

/** By how many heights each rectangle {x (middle), y (its lowest), width, height} must move along y to cover none before it. */
export function stackLevels(rectangles) {
  const placed = [];
  const covers = (a, b) => Math.abs(a.x - b.x) < (a.width + b.width) / 2 && a.y < b.y + b.height && b.y < a.y + a.height;
  return rectangles.map((rectangle) => {
    let level = 0;
    const at = () => ({ ...rectangle, y: rectangle.y + level * rectangle.height });
    while (placed.some((other) => covers(at(), other))) level += 1;
    placed.push(at());
    return level;
  });
}
