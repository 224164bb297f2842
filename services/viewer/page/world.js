// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What the page knows about one map of one robot: keyframes, their points, edges, trajectory, ground truth, dense cloud.
// Pure data; the scene asks for what changed since it last drew. Messages may come in any order and more than once.

export const kPoseValues = 8;   // per slot: t_xyz, scale_m of its points (0: not drawable yet), q_xyzw
const kFirstEntries = 256;
export const kFirstSlots = 256; // doubled when full; the scene uses rows of this many slots as a texture

export class MapState {
  #way = { keyframes: new Column(Uint32Array), positions: new Column(Float32Array, 3) };
  #valuesOfWay = { states: new Column(Uint8Array), times_s: new Column(Float32Array), sigmas_m: new Column(Float32Array),
                   errors_m: new Column(Float32Array) };   // of its entries, as far as they came
  #truth = new Column(Float32Array, 3);
  #removed = new Map();   // id -> slot of keyframes that had a pose: the trajectory may refer to them

  constructor(id) {
    this.id = id;
    this.keyframes = new Map();      // id -> {slot, posed, points, others}
    this.poses = new Float32Array(kFirstSlots * kPoseValues);
    this.slots = 0;
    this.loops = new Uint32Array(0);
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

  /** Its entries: the keyframe each belongs to, and its place in the frame of that, m. */
  get trajectory() {
    return { keyframes: this.#way.keyframes.numbers, positions: this.#way.positions.numbers, length: this.#way.keyframes.length };
  }

  /** Of the entries of the trajectory: states, times_s, sigmas_m, errors_m; NaN, and state 0: not known yet. */
  get values() {
    return Object.fromEntries(Object.entries(this.#valuesOfWay).map(([name, column]) => [name, column.numbers]));
  }

  /** Ground truth, three values a pose, m. */
  get truth() {
    return this.#truth.numbers;
  }

  pose(slot) {
    return this.poses.subarray(slot * kPoseValues, (slot + 1) * kPoseValues);
  }

  /** Slot of a keyframe that has a pose, or had one when it was removed; -1 otherwise. */
  posedSlot(id) {
    const keyframe = this.keyframes.get(id);
    return keyframe?.posed ? keyframe.slot : this.#removed.get(id) ?? -1;
  }

  setPoses({ ids, poses }) {
    ids.forEach((id, i) => {
      const keyframe = this.#keyframe(id);
      const pose = this.pose(keyframe.slot);
      pose.set(poses.subarray(7 * i, 7 * i + 3), 0);
      pose.set(poses.subarray(7 * i + 3, 7 * i + 7), 4);
      if (!keyframe.posed) this.#appear(keyframe);
    });
    this.changes.poses = true;
  }

  remove({ ids }) {
    for (const id of ids) {
      const keyframe = this.keyframes.get(id);
      if (!keyframe) continue;
      if (keyframe.posed) {
        this.posedCount -= 1;
        this.#count(keyframe, -1);
        this.#removed.set(id, keyframe.slot);
      }
      keyframe.points = null;
      this.#rescale(keyframe);
      this.keyframes.delete(id);
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
    const own = this.#way;
    if (start > own.keyframes.length) return;  // its beginning was lost; the server sends it again
    own.keyframes.put(start, keyframes);
    own.positions.put(start, positions);
    this.changes.trajectoryFrom = Math.min(this.changes.trajectoryFrom, start);
  }

  setTrajectoryValues({ start, ...columns }) {
    for (const [name, column] of Object.entries(this.#valuesOfWay)) column.put(start, columns[name]);
    this.changes.trajectoryFrom = Math.min(this.changes.trajectoryFrom, start);
  }

  setTruth({ start, positions }) {
    if (start > this.#truth.length) return;
    this.#truth.put(start, positions);
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
      keyframe = { id, slot: this.#removed.get(id) ?? this.slots++, posed: false, points: null, others: [] };
      this.keyframes.set(id, keyframe);
      if (this.slots * kPoseValues > this.poses.length) this.#grow();
    }
    return keyframe;
  }

  #grow() {
    this.poses = enlarged(this.poses, 2 * this.poses.length);
  }

  #appear(keyframe) {
    keyframe.posed = true;
    this.posedCount += 1;
    this.#count(keyframe, +1);
    this.#rescale(keyframe);
    this.changes.keyframes = this.changes.edges = true;
  }

  #count(keyframe, sign) {
    if (!keyframe.posed || !keyframe.points) return;
    this.pointCount += sign * keyframe.points.n;
    this.pointTotal += sign * Math.max(keyframe.points.total, keyframe.points.n);
  }

  #rescale(keyframe) {
    const drawable = keyframe.posed && keyframe.points;
    this.poses[keyframe.slot * kPoseValues + 3] = drawable ? keyframe.points.scale_m : 0;
  }
}

/** A longer typed array that begins with the same numbers. */
function enlarged(numbers, length) {
  const larger = new numbers.constructor(length);
  larger.set(numbers);
  return larger;
}

/** Numbers of entries that only grow in number, `each` of an entry, in one array that doubles: half the memory of an Array. */
class Column {
  #numbers;

  constructor(Type, each = 1) {
    this.#numbers = new Type(kFirstEntries * each);
    this.each = each;
    this.length = 0;   // entries
  }

  /** Entries from `start` on; 0 begins again. What lies between the last one and `start` is not known. */
  put(start, values) {
    const end = start + values.length / this.each;
    if (start === 0) this.length = 0;
    if (end * this.each > this.#numbers.length) this.#grow(end);
    if (start > this.length) this.#numbers.fill(NaN, this.length * this.each, start * this.each);   // 0 of whole numbers
    this.#numbers.set(values, start * this.each);
    this.length = Math.max(this.length, end);
  }

  get numbers() {
    return this.#numbers.subarray(0, this.length * this.each);
  }

  #grow(entries) {
    this.#numbers = enlarged(this.numbers, 2 * entries * this.each);
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
