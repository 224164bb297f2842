// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// A synthetic room that grows with the number of keyframes: a camera walks round a table, one person walks through.
// World frame as slam has it: x right, y down, z forward, the origin in the first camera.

const kFloor_m = 1.3, kCeiling_m = -1.5, kScale_m = 0.001;
const kPersonSize_m = [0.5, 1.7, 0.4];

/** Numbers in [0, 1) that are the same in every run (mulberry32). */
export function randomNumbers(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** v in the frame whose pose has the quaternion q (xyzw), seen from outside: q^-1 * v. */
export function rotateBack([x, y, z, w], v) {
  const [a, b, c] = [-x, -y, -z];
  const t = [2 * (b * v[2] - c * v[1]), 2 * (c * v[0] - a * v[2]), 2 * (a * v[1] - b * v[0])];
  return [v[0] + w * t[0] + b * t[2] - c * t[1], v[1] + w * t[1] + c * t[0] - a * t[2], v[2] + w * t[2] + a * t[1] - b * t[0]];
}

export class Room {
  /** keyframes, points: of the whole map. loopError_m: drift at the end of the way, which closing the loop removes. */
  constructor({ keyframes = 60, points = 5000, loopError_m = 0.6, seed = 7 } = {}) {
    this.random = randomNumbers(seed);
    this.half_m = 3 * Math.max(1, Math.sqrt(keyframes / 150));
    this.loopError_m = loopError_m;
    this.closed = false;
    this.keyframes = Array.from({ length: keyframes }, (_, id) => this.#keyframe(id, id / keyframes));
    this.keyframes.forEach((keyframe, i) => {
      keyframe.points = this.#pointsSeen(keyframe, Math.floor((i + 1) * points / keyframes) - Math.floor(i * points / keyframes));
    });
  }

  get pointCount() {
    return this.keyframes.reduce((sum, { points }) => sum + points.length, 0);
  }

  get scale_m() {
    return kScale_m * Math.max(1, this.half_m / 8);
  }

  /** T_world_camera of a place on the way, 0..1 is one turn; with the drift that the loop closure removes. */
  pose(turn) {
    const angle = 2 * Math.PI * turn, radius = 0.62 * this.half_m * (1 + 0.06 * Math.sin(5 * angle));
    const drift = this.closed ? 0 : this.loopError_m * Math.min(1, turn);
    const t = [radius * Math.sin(angle) + drift, 0.08 * Math.sin(3 * angle), radius * (1 - Math.cos(angle)) + 0.5 * drift];
    const yaw = angle + Math.PI / 2 - 0.9 + (this.closed ? 0 : 0.08 * Math.min(1, turn));
    return { t, q: [0, Math.sin(yaw / 2), 0, Math.cos(yaw / 2)] };
  }

  closeLoop() {
    this.closed = true;
    this.keyframes.forEach((keyframe, i) => Object.assign(keyframe, this.pose(i / this.keyframes.length)));
  }

  /** Neighbours on the way. */
  covisible(id) {
    return [1, 2, 3, 5].map((step) => id - step).filter((other) => other >= 0);
  }

  /** A point of its surfaces with a colour: x, y, z, r, g, b. */
  coloredPoint() {
    const { t } = this.pose(this.random()), [x, y, z] = this.#surfacePoint(t), light = 0.75 + 0.25 * this.random();
    const color = y > kFloor_m - 0.01 ? [150, 110, 75] : Math.hypot(x, z - 0.62 * this.half_m) < 1.5 ? [190, 70, 50] : [205, 200, 185];
    return [x, y, z, ...color.map((value) => Math.round(light * value))];
  }

  person(time_s) {
    const swing = Math.sin(0.5 * time_s), center = [1.6 * swing, kFloor_m - kPersonSize_m[1] / 2, 0.62 * this.half_m + 0.8];
    return { id: 3, label: "person", center, size: kPersonSize_m, velocity: [0.8 * Math.cos(0.5 * time_s), 0, 0], static_probability: 0.03 };
  }

  /** Points on the walls, the floor, the table and its boxes, in the frame of the keyframe; x, y, z, static probability. */
  #pointsSeen({ t, q }, count) {
    return Array.from({ length: count }, () => {
      const p = this.#surfacePoint(t);
      const p_camera = rotateBack(q, p.map((value, axis) => value - t[axis]));
      return [...p_camera, this.random() < 0.04 ? 90 : 200 + Math.floor(55 * this.random())];
    });
  }

  #surfacePoint(near) {
    const { random, half_m } = this, center = 0.62 * half_m, kind = random();
    const spread = () => (random() - 0.5) * Math.min(6, 2 * half_m);
    if (kind < 0.3) return [near[0] + spread(), kFloor_m, near[2] + spread()];
    if (kind < 0.62) return this.#wallPoint(near, center);
    const column = Math.floor(random() * 4), top = 0.45 - 0.25 * (column % 3);
    const at = [(column - 1.5) * 0.55, top + (kFloor_m - 0.35 - top) * random(), center + (random() - 0.5) * 0.8];
    const side = (random() < 0.5 ? -0.25 : 0.25);
    return random() < 0.4 ? [at[0] + (random() - 0.5) * 0.5, top, at[2]] : [at[0] + side, at[1], at[2]];
  }

  /** The wall that is nearest to the camera, with shelves: points gather in rows. */
  #wallPoint(near, center) {
    const { random, half_m } = this, rows = Math.floor(random() * 7) / 7 + 0.03 * random();
    const y = kCeiling_m + (kFloor_m - kCeiling_m) * rows;
    const along = () => (random() - 0.5) * 5;
    const [dx, dz] = [near[0], near[2] - center];
    if (Math.abs(dx) > Math.abs(dz)) return [Math.sign(dx) * half_m, y, near[2] + along()];
    return [near[0] + along(), y, center + Math.sign(dz || 1) * half_m];
  }

  #keyframe(id, turn) {
    return { id, ...this.pose(turn), points: [] };
  }
}
