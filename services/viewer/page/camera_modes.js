// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Where the scene is seen from: behind the robot's camera (follow), from above, or as the user likes (free).
// In follow and above the user may still turn, pan and zoom; then the view keeps what the user chose.

import * as THREE from "/three/build/three.module.js";
import { OrbitControls } from "/three/examples/jsm/controls/OrbitControls.js";

export const kModes = ["follow", "above", "free"];
const kBehind_m = 2.4;
const kOver_m = 1.3;
const kAhead_m = 2.4;
const kSmoothing_s = 0.25;      // time constant of the camera's way
const kSettled_m = 0.002;
const kMargin = 1.25;           // of the view around what must fit

const kTilt = 1e-4;             // straight down has no direction that could be up

/** How much of the way is gone after dt_s seconds. */
const settledShare = (dt_s) => 1 - Math.exp(-dt_s / kSmoothing_s);

export class CameraModes {
  /** onChange: called when the user moves the view. */
  constructor(camera, element, onChange) {
    this.camera = camera;
    this.controls = new OrbitControls(camera, element);
    this.controls.enableKeys = false;   // it would take the arrow keys of the whole page
    this.controls.screenSpacePanning = true;
    this.controls.maxDistance = 1000;
    this.controls.addEventListener("start", () => { this.automatic = false; });
    this.controls.addEventListener("change", onChange);
    element.addEventListener("wheel", () => { this.automatic = this.automatic && this.mode === "follow"; }, { passive: true });
    camera.position.set(-1.5, 2, 4);
    this.setMode("follow");
  }

  setMode(mode) {
    this.mode = mode;
    this.automatic = mode !== "free";
    this.last = null;
    const turns = mode !== "above";
    this.controls.enableRotate = turns;
    this.controls.mouseButtons.LEFT = turns ? THREE.MOUSE.ROTATE : THREE.MOUSE.PAN;
    this.controls.touches.ONE = turns ? THREE.TOUCH.ROTATE : THREE.TOUCH.PAN;
  }

  /** One step of dt_s seconds. cameraMatrix: T_scene_camera or null; bounds: THREE.Box3. True while the view moves. */
  update(dt_s, cameraMatrix, bounds) {
    if (this.mode === "follow" && cameraMatrix) return this.#follow(dt_s, cameraMatrix);
    if (this.mode === "above" && this.automatic && !bounds.isEmpty()) return this.#above(dt_s, bounds);
    if (this.mode === "follow" && this.automatic && !bounds.isEmpty()) return this.#approach(dt_s, ...this.#overview(bounds));
    return false;
  }

  /** Shows everything, from the present direction. */
  fit(bounds) {
    if (bounds.isEmpty()) return;
    this.automatic = false;
    const [eye, target] = this.#overview(bounds);
    this.#place(eye, target);
  }

  /** From a place at another, as the user would. */
  look(eye, target) {
    this.automatic = false;
    this.#place(new THREE.Vector3(...eye), new THREE.Vector3(...target));
  }

  /** By keyboard: right and up as shares of the view, factor of the distance. */
  nudge(right, up, factor) {
    this.automatic = false;
    const { camera, controls } = this, offset = camera.position.clone().sub(controls.target);
    const step = offset.length() * 0.1;
    const shift = new THREE.Vector3(right * step, up * step, 0).applyQuaternion(camera.quaternion);
    controls.target.add(shift);
    this.#place(controls.target.clone().add(offset.multiplyScalar(factor)), controls.target);
  }

  #follow(dt_s, matrix) {
    const at = new THREE.Vector3().setFromMatrixPosition(matrix);
    if (!this.automatic) return this.#carry(at);
    this.last = at;
    const ahead = new THREE.Vector3().setFromMatrixColumn(matrix, 2).setY(0);
    if (ahead.length() > 0.2) this.ahead = ahead.normalize();   // a camera that looks straight down has no heading
    const heading = this.ahead ?? new THREE.Vector3(0, 0, -1);
    const distance = this.distance ?? 1;
    const eye = at.clone().addScaledVector(heading, -kBehind_m * distance).add(new THREE.Vector3(0, kOver_m * distance, 0));
    return this.#approach(dt_s, eye, at.clone().addScaledVector(heading, kAhead_m));
  }

  /** Moves along with the robot and leaves direction and distance to the user. */
  #carry(at) {
    const shift = at.clone().sub(this.last ?? at);
    this.last = at;
    if (shift.length() === 0) return false;
    this.#place(this.camera.position.clone().add(shift), this.controls.target.clone().add(shift));
    return true;
  }

  #above(dt_s, bounds) {
    const center = bounds.getCenter(new THREE.Vector3()), size = bounds.getSize(new THREE.Vector3());
    const half = Math.tan(THREE.Math.degToRad(this.camera.fov / 2));
    const height = Math.max(1, kMargin / 2 * Math.max(size.z / half, size.x / (half * this.camera.aspect)) + size.y / 2);
    const target = this.controls.target.clone(), now = this.camera.position.y - target.y;
    if (target.distanceTo(center) + Math.abs(height - now) < kSettled_m) return false;
    const share = settledShare(dt_s);
    target.lerp(center, share);
    const over = Math.max(1, now + share * (height - now));
    this.#place(target.clone().add(new THREE.Vector3(0, over, kTilt * over)), target);   // forward is up on the screen
    return true;
  }

  #overview(bounds) {
    const center = bounds.getCenter(new THREE.Vector3()), radius = bounds.getSize(new THREE.Vector3()).length() / 2;
    const half = Math.tan(THREE.Math.degToRad(this.camera.fov / 2)) * Math.min(1, this.camera.aspect);
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    return [center.clone().addScaledVector(direction, Math.max(1, radius / half)), center];
  }

  #approach(dt_s, eye, target) {
    const share = settledShare(dt_s);
    const left = eye.distanceTo(this.camera.position) + target.distanceTo(this.controls.target);
    if (left < kSettled_m) return false;
    this.#place(this.camera.position.clone().lerp(eye, share), this.controls.target.clone().lerp(target, share));
    return true;
  }

  #place(eye, target) {
    this.camera.position.copy(eye);
    this.controls.target.copy(target);
    this.controls.update();
  }
}
