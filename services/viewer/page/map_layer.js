// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// One map of one robot in the scene: points, keyframes, edges, trajectory, ground truth, dense cloud.

import * as THREE from "/three/build/three.module.js";
import { lineMaterial, pointMaterial, PoseTexture } from "./anchored.js";
import { keyframeExtent_m, mapBounds } from "./geometry.js";
import { drawOrder, PointPool } from "./point_pool.js";
import { pathColor } from "./path_colors.js";
import { planMesh } from "./plan_mesh.js";
import { edgeSlots, frustumLines, slotsApart, trajectoryVertices } from "./map_lines.js";

const kFrustumDepth_m = 0.09;
const kFullSizeExtent_m = 4;      // of the keyframes; in smaller maps they are drawn smaller
const kLeastFrustumScale = 0.3;
const kApart = 0.03;              // drawn keyframes, of the extent of all
const kLeastApart_m = 0.02;
const kEdgesEvery_ms = 500;
const kTrajectoryEvery_ms = 200;
const kBoundsEvery_ms = 1000;

export class MapLayer {
  /** look: what all layers share, see scene.js. */
  constructor(map, look) {
    this.map = map;
    this.look = look;
    this.group = new THREE.Group();
    this.bounds = null;
    this.frustumScale = { value: kLeastFrustumScale };
    this.heightRange = { value: new THREE.Vector2(-1, 1) };
    this.poses = new PoseTexture(map);
    this.pool = new PointPool();
    this.chunks = [];
    this.pointMaterial = pointMaterial(this.poses, look.points, this.heightRange);
    this.frustums = this.#anchored(THREE.LineSegments, "keyframes", lineMaterial(this.poses, look.keyframe, { scale: this.frustumScale }));
    this.covisibility = this.#anchored(THREE.LineSegments, "edges", lineMaterial(this.poses, look.covisibility, { opacity: 0.5 }));
    this.loops = this.#anchored(THREE.LineSegments, "edges", lineMaterial(this.poses, look.loop));
    this.trajectory = this.#anchored(THREE.LineSegments, "trajectory", lineMaterial(this.poses, look.trajectory, { colored: look.pathColored }));
    this.truth = this.#add(new THREE.Line(new THREE.BufferGeometry(), look.truthMaterial), "truth");
    this.dense = this.#add(new THREE.Group(), "dense");
    this.moving = this.#add(new THREE.Group(), "moving");
    this.plan = this.#add(new THREE.Group(), "plan");
    this.clouds = new Map();   // part of a cloud -> what draws it
    this.shown = { points: [], keyframes: [this.frustums], edges: [this.covisibility, this.loops],
                   trajectory: [this.trajectory], truth: [this.truth], dense: [this.dense],
                   moving: [this.moving], plan: [this.plan] };
    this.pending = { edges: true, trajectory: true, bounds: true };
    this.times_ms = { edges: -Infinity, trajectory: -Infinity, bounds: -Infinity };
  }

  /** Takes over what changed in the map. True if the picture is another one now. */
  update(now_ms) {
    const changes = this.map.takeChanges();
    if (changes.poses) this.poses.update();
    if (changes.points.size > 0) this.#updatePoints(changes.points);
    if (changes.keyframes) this.#updateFrustums();
    if (changes.truth) this.truth.geometry.setAttribute("position", new THREE.Float32BufferAttribute(this.map.truth, 3));
    if (changes.dense) this.#updateClouds();
    if (changes.plan) this.#updatePlan();
    this.pending.edges = this.pending.edges || changes.edges;
    this.pending.trajectory = this.pending.trajectory || changes.trajectoryFrom < Infinity ||
      (this.trajectoryGaps && changes.keyframes);
    this.pending.bounds = this.pending.bounds || changes.poses || changes.points.size > 0;
    const rebuilt = this.#now("edges", kEdgesEvery_ms, now_ms, () => this.#updateEdges()) |
      this.#now("trajectory", kTrajectoryEvery_ms, now_ms, () => this.#updateTrajectory()) |
      this.#now("bounds", kBoundsEvery_ms, now_ms, () => this.#updateBounds());
    return changes.any || rebuilt !== 0;
  }

  /** Points of the layers that are shown. */
  get pointCount() {
    const of = ({ parts }) => parts.reduce((sum, { positions }) => sum + positions.length / 3, 0);
    const { points = true, dense, moving } = this.visible ?? {};
    return (points ? this.map.pointCount : 0) + (dense ? of(this.map.dense) : 0) + (moving ? of(this.map.moving) : 0);
  }

  /** Whether something was put off that a later update() will do. */
  get waiting() {
    return Object.values(this.pending).some(Boolean);
  }

  /** visible: {points: true, ...} */
  show(visible) {
    this.visible = visible;
    this.pending.trajectory = true;   // its colouring may be another one
    for (const [name, objects] of Object.entries(this.shown)) {
      for (const object of objects) object.visible = visible[name];
    }
  }

  dispose() {
    this.group.traverse((object) => object.geometry?.dispose());
    this.poses.dispose();
    this.pointMaterial.dispose();
  }

  #add(object, name) {
    object.frustumCulled = false;  // its bounds are known only to the shader
    object.name = name;
    this.group.add(object);
    return object;
  }

  #anchored(Kind, name, material) {
    const geometry = new THREE.BufferGeometry();
    geometry.setDrawRange(0, 0);
    return this.#add(new Kind(geometry, material), name);
  }

  /** Some work is too much for every frame when the map is large. */
  #now(name, period_ms, now_ms, work) {
    if (!this.pending[name] || now_ms - this.times_ms[name] < period_ms) return 0;
    this.pending[name] = false;
    this.times_ms[name] = now_ms;
    work();
    return 1;
  }

  #updatePoints(ids) {
    if (this.pool.wasteful) this.#refill();
    else for (const id of ids) this.#setPoints(id);
    for (let i = this.chunks.length; i < this.pool.chunks.length; ++i) this.#addChunk(this.pool.chunks[i]);
    this.pool.chunks.forEach((chunk, i) => this.#upload(chunk, this.chunks[i].geometry));
  }

  #setPoints(id) {
    const keyframe = this.map.keyframes.get(id);
    if (keyframe?.points) this.pool.set(id, keyframe.slot, keyframe.points.n, keyframe.points.data);
    else this.pool.delete(id);
  }

  #refill() {
    for (const object of this.chunks) {
      this.group.remove(object);
      object.geometry.dispose();
    }
    this.chunks = this.shown.points = [];
    this.pool.clear();
    for (const id of this.map.keyframes.keys()) this.#setPoints(id);
  }

  #addChunk(chunk) {
    const geometry = new THREE.BufferGeometry();
    const records = new THREE.InterleavedBuffer(chunk.records, 4);
    geometry.setAttribute("position", new THREE.InterleavedBufferAttribute(records, 3, 0));
    geometry.setAttribute("rated", new THREE.InterleavedBufferAttribute(records, 1, 3));
    geometry.setAttribute("slot", new THREE.BufferAttribute(chunk.slots, 1));
    geometry.setIndex(new THREE.BufferAttribute(drawOrder(chunk.capacity), 1));
    const object = this.#add(new THREE.Points(geometry, this.pointMaterial), "points");
    object.onBeforeRender = () => geometry.setDrawRange(0, Math.ceil(this.look.share * chunk.capacity));
    object.visible = this.visible?.points ?? true;
    this.chunks.push(object);
    this.shown.points = this.chunks;
  }

  #upload(chunk, geometry) {
    if (chunk.dirtyTo <= chunk.dirtyFrom) return;
    for (const [attribute, size] of [[geometry.attributes.position.data, 4], [geometry.attributes.slot, 1]]) {
      // A range that has not been sent yet is still in the attribute.
      const { offset, count } = attribute.updateRange;
      const from = Math.min(size * chunk.dirtyFrom, count > 0 ? offset : Infinity);
      const to = Math.max(size * chunk.dirtyTo, count > 0 ? offset + count : 0);
      attribute.updateRange = { offset: from, count: to - from };
      attribute.needsUpdate = true;
    }
    chunk.clean();
  }

  #updateFrustums() {
    const apart_m = Math.max(kLeastApart_m, kApart * keyframeExtent_m(this.map));
    this.#setLines(this.frustums, frustumLines(slotsApart(this.map, apart_m), kFrustumDepth_m));
  }

  #updateEdges() {
    const { covisibility, loops } = edgeSlots(this.map);
    this.#setLines(this.covisibility, { slots: covisibility });
    this.#setLines(this.loops, { slots: loops });
  }

  #updateTrajectory() {
    const { positions, slots, colors, gaps } = trajectoryVertices(this.map, pathColor(this.map, this.look.pathColoring));
    this.trajectoryGaps = gaps;
    this.#setLines(this.trajectory, { positions, slots });
    this.trajectory.geometry.setAttribute("own", new THREE.BufferAttribute(colors, 3));
  }

  #setLines(object, { positions, slots }) {
    const { geometry } = object;
    geometry.dispose();
    geometry.setAttribute("slot", new THREE.BufferAttribute(slots, 1));
    geometry.setAttribute("position", new THREE.BufferAttribute(positions ?? new Float32Array(3 * slots.length), 3));
    geometry.setDrawRange(0, slots.length);
  }

  #updateClouds() {
    const before = this.clouds;
    this.clouds = new Map();
    this.#updateCloud(this.dense, this.map.dense.parts, this.look.denseMaterial, before);
    this.#updateCloud(this.moving, this.map.moving.parts, this.look.movingMaterial, before);
    for (const object of before.values()) {
      object.parent.remove(object);
      object.geometry.dispose();
    }
  }

  #updateCloud(group, parts, material, before) {
    for (const part of parts) {
      const object = before.get(part) ?? this.#cloudPart(part, material);
      before.delete(part);
      this.clouds.set(part, object);
      group.add(object);
    }
  }

  #cloudPart({ positions, colors }, material) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3, true));
    const object = new THREE.Points(geometry, material), count = positions.length / 3;
    object.onBeforeRender = () => geometry.setDrawRange(0, Math.ceil(this.look.share * count));
    return object;
  }

  #updatePlan() {
    for (const object of this.plan.children) {
      object.geometry.dispose();
      object.material.map.dispose();
      object.material.dispose();
    }
    this.plan.remove(...this.plan.children);
    this.plan.add(planMesh(this.map.plan));
  }

  #updateBounds() {
    this.bounds = mapBounds(this.map);
    this.frustumScale.value = Math.min(1, Math.max(kLeastFrustumScale, keyframeExtent_m(this.map) / kFullSizeExtent_m));
    if (this.bounds) this.heightRange.value.set(this.bounds.min[1], Math.max(this.bounds.max[1], this.bounds.min[1] + 0.1));
  }
}
