// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Whether an object moves, by its last moments: the middle of one that comes into view moves too, while it rests.

const kLong_s = 1.5, kShort_s = 0.75;
const kLeastShare = 0.5;   // of the way that its velocity promises, which both its sides must have gone

export class Trails {
  constructor() {
    this.trails = new Map();   // id -> [{stamp_s, center, size}]
  }

  /** The objects of a message; rests: also where they were does not show that they move. */
  add({ stamp_s, movers }) {
    const before = this.trails;
    this.trails = new Map();
    return movers.map((mover) => {
      const trail = (before.get(mover.id) ?? []).filter((one) => one.stamp_s < stamp_s && stamp_s - one.stamp_s <= kLong_s);
      this.trails.set(mover.id, [...trail, { stamp_s, ...mover }]);
      return { ...mover, rests: mover.rests || !hasMoved(trail[0], mover, stamp_s) };
    });
  }
}

function hasMoved(then, { center, size, velocity }, stamp_s) {
  const past_s = then ? stamp_s - then.stamp_s : 0;
  if (past_s < kShort_s) return false;
  const ways = [0, 1, 2].map((i) => {
    const [low, high] = [-0.5, 0.5].map((half) => center[i] + half * size[i] - then.center[i] - half * then.size[i]);
    return low * high > 0 ? Math.sign(low) * Math.min(Math.abs(low), Math.abs(high)) : 0;
  });
  const speed_mps = Math.hypot(...velocity), along_m = ways.reduce((sum, way, i) => sum + way * velocity[i], 0) / speed_mps;
  return along_m > kLeastShare * speed_mps * past_s;
}
