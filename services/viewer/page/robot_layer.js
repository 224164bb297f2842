// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// One robot in the scene: its maps side by side, its camera, the objects that move.

import * as THREE from "/three/build/three.module.js";
import { MapLayer } from "./map_layer.js";
import { frustumLines } from "./map_lines.js";
import { textSprite } from "./text_sprite.js";

const kCameraDepth_m = 0.22;
const kPictureSize = [1.6, 1.2];   // of the frustum's far side, at depth 1
const kPicture_px = 256;
const kVelocitySeconds = 1;     // an arrow shows the way of so long
const kGap_m = 2;

export class RobotLayer {
  constructor(robot, look) {
    this.robot = robot;
    this.look = look;
    this.name = null;             // sprite
    this.drawnName = "";
    this.group = new THREE.Group();
    this.layers = new Map();      // map id -> MapLayer
    const { positions } = frustumLines([0], kCameraDepth_m);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    this.camera = new THREE.LineSegments(geometry, look.cameraMaterial);
    this.camera.visible = false;
    this.movers = new THREE.Group();
    this.companions = new THREE.Group();
    this.group.add(this.camera, this.movers, this.companions);
  }

  /** True if the picture is another one now. */
  update(now_ms) {
    let changed = this.#turnUp();
    changed = this.#syncMaps() || changed;
    for (const layer of this.layers.values()) changed = layer.update(now_ms) || changed;
    changed = this.#updateCamera() || changed;
    changed = this.#updateCompanions() || changed;
    return this.#updateMovers() || changed;
  }

  /** On the screen y points up; in the world down, or for a robot with a base z points up. */
  #turnUp() {
    const turn = this.robot.zUp ? -Math.PI / 2 : Math.PI;
    if (this.group.rotation.x === turn) return false;
    this.group.rotation.x = turn;
    return true;
  }

  /**
   * Maps of a robot have their own world frames: side by side, the current one first, its frame at `at_m` or, with
   * beside, its left edge there. Returns where the next robot may begin.
   */
  arrange(at_m, beside, hiddenMaps) {
    const ids = this.#mapIds();
    this.group.position.x = at_m - (beside ? this.layers.get(ids[0])?.bounds?.min[0] ?? 0 : 0);
    let right_m = 0;
    ids.forEach((id, i) => {
      const { group, bounds } = this.layers.get(id);
      group.visible = !hiddenMaps.has(this.robot.mapKey(id));
      group.position.x = i === 0 || !bounds ? 0 : right_m + kGap_m - bounds.min[0];
      if (bounds && (i === 0 || group.visible)) right_m = group.position.x + bounds.max[0];
    });
    return this.group.position.x + right_m;
  }

  /** The robot's name above its current map, if that is shown. */
  showName(shown) {
    const map = this.layers.get(this.#mapIds()[0]), there = shown && Boolean(map?.bounds && map.group.visible);
    const { cameraMaterial: { color }, textScale, unitsPerPixel } = this.look;
    const key = there ? [this.robot.title, color.getStyle(), textScale, unitsPerPixel].join() : "";
    if (key !== this.drawnName) {
      this.group.remove(this.name);
      this.name = there ? textSprite(this.robot.title, color, this.look) : null;
      if (there) this.group.add(this.name);
      this.drawnName = key;
    }
    if (!there) return;
    this.#putAbove(this.name, map.bounds);
  }

  /** The other robots in its map. */
  showCompanions(shown) {
    this.companions.visible = shown;
  }

  /** A label at the upper far edge of a box: above it both from behind and from above. */
  #putAbove(label, { min, max }) {
    const x = (min[0] + max[0]) / 2;
    if (this.robot.zUp) label.position.set(x, max[1], max[2]);
    else label.position.set(x, min[1], max[2]);
  }

  /** Texts in the scene, see spreadLabels(). */
  labels() {
    return [this.name, ...this.movers.children, ...(this.companions.visible ? this.companions.children : [])].filter((object) => object?.isSprite);
  }

  /** T_scene_camera of the newest pose, or null. */
  cameraMatrix() {
    if (!this.camera.visible) return null;
    this.camera.updateWorldMatrix(true, false);
    return this.camera.matrixWorld;
  }

  /** The camera as it was at a moment of the history; null: as it is. */
  showMoment(moment) {
    this.moment = moment;
  }

  /** The camera's image, in its frustum. */
  setImage(bitmap) {
    if (!this.picture) {
      const material = new THREE.MeshBasicMaterial({ map: new THREE.CanvasTexture(document.createElement("canvas")), side: THREE.DoubleSide });
      this.picture = new THREE.Mesh(new THREE.PlaneBufferGeometry(...kPictureSize.map((size) => size * kCameraDepth_m)), material);
      this.picture.position.z = kCameraDepth_m;
      this.picture.rotation.x = Math.PI;   // the image's y is down
      this.camera.add(this.picture);
    }
    const { map } = this.picture.material, { image: canvas } = map;
    canvas.width = kPicture_px;
    canvas.height = Math.round(kPicture_px * bitmap.height / bitmap.width);
    canvas.getContext("2d").drawImage(bitmap, 0, 0, canvas.width, canvas.height);
    map.needsUpdate = true;
  }

  show(visible) {
    this.visible = visible;
    this.drawnMovers = this.drawnCompanions = null;   // colours and sizes may be others
    for (const layer of this.layers.values()) layer.show(visible);
    this.movers.visible = visible.movers;
  }

  dispose() {
    for (const layer of this.layers.values()) layer.dispose();
    this.camera.geometry.dispose();
  }

  /** The current one first. */
  #mapIds() {
    const current = this.robot.tracking?.map ?? 0;
    return [...this.layers.keys()].sort((a, b) => (b === current) - (a === current) || a - b);
  }

  #syncMaps() {
    let changed = false;
    for (const [id, layer] of this.layers) {
      if (this.robot.maps.get(id) === layer.map) continue;
      this.group.remove(layer.group);
      layer.dispose();
      this.layers.delete(id);
      changed = true;
    }
    for (const [id, map] of this.robot.maps) {
      if (this.layers.has(id)) continue;
      const layer = new MapLayer(map, this.look);
      if (this.visible) layer.show(this.visible);
      this.layers.set(id, layer);
      this.group.add(layer.group);
      changed = true;
    }
    return changed;
  }

  #updateCamera() {
    const tracking = this.moment ?? this.robot.tracking;
    if (tracking === this.drawnTracking) return false;
    this.drawnTracking = tracking;
    if (!tracking) return true;
    this.camera.material = tracking.state === "ok" ? this.look.cameraMaterial : this.look.lostMaterial;
    if (!tracking.pose) return true;   // it stays where it was last
    const [x, y, z, qx, qy, qz, qw] = tracking.pose;
    const map = this.layers.get(tracking.map);
    this.camera.position.set(x, y, z).add(map?.group.position ?? new THREE.Vector3());
    this.camera.quaternion.set(qx, qy, qz, qw);
    this.camera.visible = true;
    return true;
  }

  /** Other robots in the map that this one is in now: as its own camera, each with its name. */
  #updateCompanions() {
    const map = this.layers.get(this.robot.tracking?.map ?? 0);
    this.companions.position.copy(map?.group.position ?? new THREE.Vector3());
    if (this.robot.companions === this.drawnCompanions) return false;
    this.drawnCompanions = this.robot.companions;
    this.companions.remove(...this.companions.children);
    for (const { name, pose: [x, y, z, ...rotation] } of this.robot.companions) {
      const marker = new THREE.LineSegments(this.camera.geometry, this.look.truthMaterial);
      marker.position.set(x, y, z);
      marker.quaternion.set(...rotation);
      const sprite = textSprite(name || "robot", this.look.truthMaterial.color, this.look);
      sprite.position.copy(marker.position);
      this.companions.add(marker, sprite);
    }
    return true;
  }

  #updateMovers() {
    if (this.robot.movers === this.drawnMovers) return false;
    this.drawnMovers = this.robot.movers;
    for (const object of this.movers.children) {
      if (object.isLineSegments) object.geometry.dispose();   // the others share theirs
    }
    this.movers.remove(...this.movers.children);
    for (const mover of this.robot.movers) this.movers.add(...this.#draw(mover));
    return true;
  }

  #draw({ center, size, velocity, label, rests }) {
    const at = new THREE.Vector3(...center), way = new THREE.Vector3(...velocity).multiplyScalar(kVelocitySeconds);
    const box = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(...size)), this.look.moverMaterial);
    box.position.copy(at);
    const speed = rests ? "" : ` ${(way.length() / kVelocitySeconds).toFixed(1)} m/s`;
    const sprite = textSprite(`${label || "object"}${speed}`, this.look.moverMaterial.color, this.look);
    const half = size.map((length) => length / 2);
    this.#putAbove(sprite, { min: center.map((middle, i) => middle - half[i]), max: center.map((middle, i) => middle + half[i]) });
    const parts = [box, sprite];
    if (!rests && way.length() > 0.02) {
      parts.push(new THREE.ArrowHelper(way.clone().normalize(), at, way.length(), this.look.moverMaterial.color.getHex(),
                                       Math.min(0.15, 0.4 * way.length()), 0.08));
    }
    return parts;
  }
}
