// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What the page knows about one map of one robot: keyframes, their points, edges, trajectory, ground truth, dense cloud.
// Pure data; the scene asks for what changed since it last drew. Messages may come in any order and more than once.

export const kPoseValues = 8;   // per slot: t_xyz, scale_m of its points (0: not drawable yet), q_xyzw
export const kFirstSlots = 256; // doubled when full; the scene uses rows of this many slots as a texture

export class MapState {
  constructor(id) {
    this.id = id;
    this.keyframes = new Map();      // id -> {slot, posed, alive, points, others}
    this.poses = new Float32Array(kFirstSlots * kPoseValues);
    this.slots = 0;
    this.loops = new Uint32Array(0);
    this.trajectory = { keyframes: [], positions: [], length: 0 };
    this.values = { states: [], times_s: [], sigmas_m: [], errors_m: [] };   // of its entries, as far as they came
    this.truth = [];
    this.dense = { parts: [] };      // [{start, positions, colors}]; the first points are spread over all
    this.moving = { parts: [] };
    this.plan = null;
    this.changes = new Changes();
    this.posedCount = 0;
    this.pointCount = 0;
    this.pointTotal = 0;
  }

  /** What changed since the last call. */
  takeChanges() {
    const changes = this.changes;
    this.changes = new Changes();
    return changes;
  }

  pose(slot) {
    return this.poses.subarray(slot * kPoseValues, (slot + 1) * kPoseValues);
  }

  /** Slot of a keyframe that has a pose, -1 otherwise. A removed keyframe keeps its slot: trajectories may refer to it. */
  posedSlot(id) {
    const keyframe = this.keyframes.get(id);
    return keyframe?.posed ? keyframe.slot : -1;
  }

  setPoses({ ids, poses }) {
    ids.forEach((id, i) => {
      const keyframe = this.#keyframe(id);
      const pose = this.pose(keyframe.slot);
      pose.set(poses.subarray(7 * i, 7 * i + 3), 0);
      pose.set(poses.subarray(7 * i + 3, 7 * i + 7), 4);
      if (!keyframe.posed || !keyframe.alive) this.#appear(keyframe);
    });
    this.changes.poses = true;
  }

  remove({ ids }) {
    for (const id of ids) {
      const keyframe = this.keyframes.get(id);
      if (!keyframe) continue;
      if (keyframe.posed && keyframe.alive) {
        this.posedCount -= 1;
        this.#count(keyframe, -1);
      }
      keyframe.alive = false;
      keyframe.points = null;
      keyframe.others = [];
      this.#rescale(keyframe);
      this.changes.points.add(id);
    }
    this.changes.poses = this.changes.keyframes = this.changes.edges = true;
  }

  setPoints({ blocks }) {
    for (const block of blocks) {
      const keyframe = this.#keyframe(block.keyframe);
      this.#count(keyframe, -1);
      keyframe.points = block;
      this.#count(keyframe, +1);
      this.#rescale(keyframe);
      this.changes.points.add(block.keyframe);
    }
    this.changes.poses = true;
  }

  setCovisibility({ blocks }) {
    for (const { keyframe, others } of blocks) this.#keyframe(keyframe).others = others;
    this.changes.edges = true;
  }

  setLoops({ pairs }) {
    this.loops = pairs;
    this.changes.edges = true;
  }

  setTrajectory({ start, keyframes, positions }) {
    const own = this.trajectory;
    if (start > own.length) return;  // its beginning was lost; the server sends it again
    for (let i = 0; i < keyframes.length; ++i) {
      own.keyframes[start + i] = keyframes[i];
      for (let k = 0; k < 3; ++k) own.positions[3 * (start + i) + k] = positions[3 * i + k];
    }
    own.length = start === 0 ? keyframes.length : Math.max(own.length, start + keyframes.length);
    this.changes.trajectoryFrom = Math.min(this.changes.trajectoryFrom, start);
  }

  setTrajectoryValues({ start, ...columns }) {
    for (const [name, values] of Object.entries(this.values)) {
      for (let i = 0; i < columns.states.length; ++i) values[start + i] = columns[name][i];
    }
    this.changes.trajectoryFrom = Math.min(this.changes.trajectoryFrom, start);
  }

  setTruth({ start, positions }) {
    if (3 * start > this.truth.length) return;
    if (start === 0) this.truth.length = 0;
    for (let i = 0; i < positions.length; ++i) this.truth[3 * start + i] = positions[i];
    this.changes.truth = true;
  }

  setDense(message) {
    this.dense = withPart(this.dense, message);
    this.changes.dense = true;
  }

  setMoving(message) {
    this.moving = withPart(this.moving, message);
    this.changes.dense = true;
  }

  setPlan(message) {
    this.plan = message;
    this.changes.plan = true;
  }

  /** A slot for a keyframe that is mentioned for the first time, by whatever message. */
  #keyframe(id) {
    let keyframe = this.keyframes.get(id);
    if (!keyframe) {
      keyframe = { id, slot: this.slots++, posed: false, alive: true, points: null, others: [] };
      this.keyframes.set(id, keyframe);
      if (this.slots * kPoseValues > this.poses.length) this.#grow();
    }
    return keyframe;
  }

  #grow() {
    const larger = new Float32Array(2 * this.poses.length);
    larger.set(this.poses);
    this.poses = larger;
  }

  #appear(keyframe) {
    keyframe.posed = keyframe.alive = true;
    this.posedCount += 1;
    this.#count(keyframe, +1);
    this.#rescale(keyframe);
    this.changes.keyframes = this.changes.edges = true;
  }

  #count(keyframe, sign) {
    if (!keyframe.posed || !keyframe.alive || !keyframe.points) return;
    this.pointCount += sign * keyframe.points.n;
    this.pointTotal += sign * Math.max(keyframe.points.total, keyframe.points.n);
  }

  #rescale(keyframe) {
    const drawable = keyframe.posed && keyframe.alive && keyframe.points;
    this.poses[keyframe.slot * kPoseValues + 3] = drawable ? keyframe.points.scale_m : 0;
  }
}

/** A renewed cloud replaces the old one part by part, so that it does not vanish while it comes. */
function withPart({ parts }, { start, total, positions, colors }) {
  const others = parts.filter((part) => part.start !== start && part.start < total);
  return { parts: [...others, { start, positions, colors }] };
}

class Changes {
  poses = false;
  keyframes = false;
  edges = false;
  truth = false;
  dense = false;
  plan = false;
  points = new Set();            // ids of keyframes
  trajectoryFrom = Infinity;     // first entry that differs

  get any() {
    return this.poses || this.keyframes || this.edges || this.truth || this.dense || this.plan || this.points.size > 0 ||
      this.trajectoryFrom < Infinity;
  }
}
