// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The 3D view. It draws when something has changed: a message, the view, the size; otherwise it costs nothing.

import * as THREE from "/three/build/three.module.js";
import { CameraModes } from "./camera_modes.js";
import { Detail } from "./detail.js";
import { DrawPace, isLoopback } from "./draw_pace.js";
import { FrameRate } from "./frame_rate.js";
import { Look } from "./look.js";
import { RobotLayer } from "./robot_layer.js";
import { RobotState } from "./session.js";
import { spreadLabels } from "./text_sprite.js";

const kLargestPixelRatio = 2;
const kLongestStep_s = 0.1;
const kRobotGap_m = 3;
const kPutOff_ms = 250;         // work that was put off is done after so long at the latest
const kRest_ms = 400;
const kOneRefresh_ms = 20;      // of a usual screen, and a little
const kSoftware = /swiftshader|llvmpipe|software/i;

export class Scene {
  /** Throws if the browser has no WebGL. settings: see settings.js; onPoseDrawn(tracking): a pose is on the screen. */
  constructor(container, settings, onPoseDrawn) {
    this.container = container;
    this.settings = settings;
    this.onPoseDrawn = onPoseDrawn;
    this.rate = new FrameRate();
    this.detail = new Detail();
    this.pace = new DrawPace(isLoopback(location.hostname));
    this.robots = new Map();
    this.robotStates = new Map();
    this.look = new Look();
    this.software = drawsInSoftware();
    this.renderer = createRenderer(this.software);
    this.canvas = this.renderer.domElement;
    this.#prepareCanvas();
    this.three = new THREE.Scene();
    this.root = new THREE.Group();
    this.three.add(this.root);
    this.camera = new THREE.PerspectiveCamera(55, 1, 0.02, 3000);
    this.modes = new CameraModes(this.camera, this.canvas, () => this.request());
    this.bounds = new THREE.Box3();
    new ResizeObserver(() => this.#resize()).observe(container);
    this.applySettings();
    this.#warmUp();
  }

  /** Whether everything that is drawn is drawn by the processor that also computes the poses. */
  get frugal() {
    return this.weak && this.pace.sameHost;
  }

  /** Whether it must draw less often. */
  get weak() {
    return this.software || this.pace.slow === true;
  }

  applySettings() {
    this.look.apply(this.settings, { pixelRatio: this.renderer.getPixelRatio(), height_px: this.container.clientHeight,
                                     fov_deg: this.camera.fov });
    this.renderer.setClearColor(this.look.background);
    if (this.grid) this.#drawGrid();
    this.forced = true;
    for (const robot of this.robots.values()) robot.show(this.settings.layers);
    this.request();
  }

  /** states: index -> RobotState; selected: the robot that the view follows. */
  setRobots(states, selected) {
    this.robotStates = states;
    this.selected = selected;
    this.request();
  }

  setMode(mode) {
    this.modes.setMode(mode);
    this.request();
  }

  /** From where it is seen: {mode, eye, target}, scene coordinates. */
  view() {
    const { mode, controls } = this.modes;
    return { mode, eye: this.camera.position.toArray(), target: controls.target.toArray() };
  }

  /** As view() gave it. */
  setView({ eye, target }) {
    this.modes.look(eye, target);
    this.request();
  }

  /** At a place in a map of a robot, from where the view is now. pose: begins with its position. */
  lookAt(robot, map, [x, y, z]) {
    const group = this.robots.get(robot)?.layers.get(map)?.group;
    if (!group) return;
    const target = group.localToWorld(new THREE.Vector3(x, y, z)), { controls } = this.modes;
    const eye = this.camera.position.clone().sub(controls.target).add(target);
    this.setView({ eye: eye.toArray(), target: target.toArray() });
  }

  /** Projects points of a robot's map: to {x, y (px of the canvas), depth}, or null behind the view. */
  projector(robot, map) {
    const group = this.robots.get(robot)?.layers.get(map)?.group, spot = new THREE.Vector3();
    if (!group) return () => null;
    this.camera.updateMatrixWorld();
    group.updateWorldMatrix(true, false);
    const matrix = this.camera.projectionMatrix.clone().multiply(this.camera.matrixWorldInverse.getInverse(this.camera.matrixWorld)).multiply(group.matrixWorld);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    return (point) => {
      spot.set(...point).applyMatrix4(matrix);
      return spot.z > 1 ? null : { x: (spot.x + 1) / 2 * width, y: (1 - spot.y) / 2 * height, depth: spot.z };
    };
  }

  /** A sign at a point of a map, or a line between two; without arguments none. */
  mark(robot, map, points = []) {
    this.marked?.parent.remove(this.marked);
    this.marked?.geometry.dispose();
    this.marked = null;
    const group = this.robots.get(robot)?.layers.get(map)?.group;
    if (group && points.length > 0) {
      const geometry = new THREE.BufferGeometry().setFromPoints(points.map((point) => new THREE.Vector3(...point)));
      this.marked = points.length > 1 ? new THREE.Line(geometry, this.look.markMaterial) : new THREE.Points(geometry, this.look.markPointMaterial);
      this.marked.renderOrder = 2;
      group.add(this.marked);
    }
    this.forced = true;
    this.request();
  }

  /** The camera where it was then; null: where it is. */
  showMoment(robot, moment) {
    this.robots.get(robot)?.showMoment(moment);
    this.forced = true;
    this.request();
  }

  /** bitmap: the newest image of the selected robot's camera. */
  setCameraImage(bitmap) {
    this.robots.get(this.selected)?.setImage(bitmap);
    this.forced = true;
    this.request();
  }

  /** Where the frame of a robot's map lies in the scene. */
  originOf(robot, map) {
    const layer = this.robots.get(robot), group = layer?.layers.get(map)?.group;
    return group ? group.getWorldPosition(new THREE.Vector3()).toArray() : [0, 0, 0];
  }

  fit() {
    this.modes.fit(this.bounds);
    this.request();
  }

  nudge(right, up, factor) {
    this.modes.nudge(right, up, factor);
    this.request();
  }

  /** Draws with the next frame of the screen if something is new. A processor that also draws gets pauses. */
  request() {
    if (this.requested) return;
    this.requested = true;
    const draw = () => {
      this.asked_ms = performance.now();
      requestAnimationFrame((now_ms) => this.#frame(now_ms));
    };
    const pause_ms = this.weak && !this.#measuring() ? (this.drawn_ms ?? 0) + this.pace.period_ms - performance.now() : 0;
    if (pause_ms > 0) setTimeout(draw, pause_ms);
    else draw();
  }

  /** Draws one of everything and removes it: programs are compiled now and not in the middle of a run. */
  #warmUp() {
    const robot = new RobotState(0), map = robot.map(0);
    map.setPoses({ ids: [0, 1], poses: Float32Array.of(0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1) });
    map.setPoints({ blocks: [{ keyframe: 0, n: 1, total: 1, scale_m: 1, data: new Uint8Array(8) }] });
    map.setCovisibility({ blocks: [{ keyframe: 0, others: Uint32Array.of(1) }] });
    map.setTrajectory({ start: 0, keyframes: Uint32Array.of(0, 1), positions: new Float32Array(6) });
    map.setTruth({ start: 0, positions: new Float32Array(6) });
    for (const set of ["setDense", "setMoving"]) map[set]({ start: 0, total: 1, positions: new Float32Array(3), colors: new Uint8Array(3) });
    map.setPlan({ cell_m: 1, width: 1, height: 1, t: [0, 0, 0], q: [0, 0, 0, 1], runs: Uint8Array.of(0, 0) });
    robot.tracking = { state: "ok", pose: [0, 0, 0, 0, 0, 0, 1], map: 0 };
    robot.movers = [{ center: [0, 0, 0], size: [1, 1, 1], velocity: [1, 0, 0], label: "" }];
    const layer = new RobotLayer(robot, this.look);
    layer.show(Object.fromEntries(Object.keys(this.settings.layers).map((name) => [name, true])));
    layer.update(0);
    this.root.add(layer.group);
    this.renderer.render(this.three, this.camera);
    layer.group.visible = false;   // kept: programs live as long as their materials
    this.renderer.clear();
  }

  #measuring() {
    return performance.now() < (this.continuousUntil_ms ?? 0);
  }

  get framesPerSecond() {
    return this.rate.perSecond(performance.now());
  }

  /** Draws without a pause for so long; frames per second. */
  measure(seconds) {
    this.continuousUntil_ms = performance.now() + 1000 * seconds;
    this.measured = 0;
    this.request();
    return new Promise((resolve) => setTimeout(() => resolve(this.measured / seconds), 1000 * seconds));
  }

  #prepareCanvas() {
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "application");
    this.canvas.setAttribute("aria-label", "3D map. Arrow keys move the view, plus and minus zoom, F shows everything.");
    this.canvas.addEventListener("webglcontextrestored", () => this.applySettings());
    this.canvas.style.visibility = "hidden";   // black until something is drawn
    this.container.prepend(this.canvas);
  }

  #frame(now_ms) {
    this.requested = false;
    const dt_s = Math.min(kLongestStep_s, (now_ms - (this.drawn_ms ?? now_ms)) / 1000 || 1 / 60);
    const continuous = this.#measuring();
    let changed = this.#updateRobots(now_ms) || this.forced || continuous;
    const followed = this.robots.get(this.selected);
    const moving = this.modes.update(dt_s, followed?.cameraMatrix() ?? null, this.bounds);
    changed = changed || moving || this.#viewMoved();
    if (changed) this.#draw(now_ms, followed);
    if (moving || continuous) this.request();
    else this.#resumeLater();
  }

  /** How long the last drawing took, as far as the screen shows: while the driver is behind, all the time since then, but
      for a pause that was made on purpose. */
  #lastTook_ms(now_ms) {
    const waited_ms = now_ms - this.asked_ms, drawn_ms = this.drawn_ms ?? -Infinity;
    const behind = waited_ms > kOneRefresh_ms && this.asked_ms - drawn_ms < 2 * kOneRefresh_ms;
    return behind ? now_ms - drawn_ms : Math.max(0, waited_ms);
  }

  #pointCount() {
    return [...this.robots.values()].flatMap((robot) => [...robot.layers.values()]).reduce((sum, layer) => sum + layer.pointCount, 0);
  }

  #draw(now_ms, followed) {
    const took_ms = this.#lastTook_ms(now_ms);
    if (this.pace.drawn(took_ms)) this.#resize();
    this.detail.frame(took_ms, this.#pointCount(), this.frugal);
    this.look.share = this.resting ? 1 : this.detail.share;
    this.forced = this.resting = false;
    this.drawn_ms = now_ms;
    spreadLabels([...this.robots.values()].flatMap((robot) => robot.labels()), this.camera);
    this.renderer.render(this.three, this.camera);
    this.canvas.style.visibility = "";
    this.rate.count(performance.now());
    this.measured += 1;
    const tracking = followed?.drawnTracking;
    if (tracking && tracking !== this.reported) this.onPoseDrawn(tracking);
    this.reported = tracking;
  }

  /** What was put off, and at rest the points that were left out. */
  #resumeLater() {
    const waiting = [...this.robots.values()].some((robot) => [...robot.layers.values()].some((layer) => layer.waiting));
    clearTimeout(this.timer);
    if (waiting) this.timer = setTimeout(() => this.request(), kPutOff_ms);
    clearTimeout(this.restTimer);
    if (this.look.share < 1) this.restTimer = setTimeout(() => this.#rest(), kRest_ms);
  }

  #rest() {
    this.resting = this.forced = true;
    this.request();
  }

  #viewMoved() {
    const view = this.camera.position.toArray().concat(this.camera.quaternion.toArray()).join();
    const moved = view !== this.drawnFrom;
    this.drawnFrom = view;
    return moved;
  }

  #updateRobots(now_ms) {
    let changed = this.#syncRobots();
    for (const robot of this.robots.values()) changed = robot.update(now_ms) || changed;
    if (changed) this.#arrange();
    return changed;
  }

  #syncRobots() {
    let changed = false;
    for (const [index, layer] of this.robots) {
      if (this.robotStates.get(index) === layer.robot) continue;
      this.root.remove(layer.group);
      layer.dispose();
      this.robots.delete(index);
      changed = true;
    }
    for (const [index, state] of this.robotStates) {
      if (this.robots.has(index)) continue;
      const layer = new RobotLayer(state, this.look);
      layer.show(this.settings.layers);
      this.robots.set(index, layer);
      this.root.add(layer.group);
      changed = true;
    }
    return changed;
  }

  /** Robots share no frame: side by side, the selected one first. */
  #arrange() {
    const order = [...this.robots.values()].sort((a, b) => (b.robot.index === this.selected) - (a.robot.index === this.selected));
    let at_m = 0;
    this.bounds.makeEmpty();
    for (const robot of order) {
      at_m = robot.arrange(at_m, robot !== order[0], this.settings.hiddenMaps) + kRobotGap_m;
      robot.showName(order.length > 1);
      robot.showCompanions(robot === order[0]);
      this.#include(robot);
    }
    this.#drawGrid();
  }

  #include(robot) {
    for (const { bounds, group } of robot.layers.values()) {
      if (!bounds || !group.visible) continue;
      const x = robot.group.position.x + group.position.x;
      for (const corner of [bounds.min, bounds.max]) {
        const point = new THREE.Vector3(...corner).applyEuler(robot.group.rotation);
        this.bounds.expandByPoint(point.setX(point.x + x));
      }
    }
  }

  #drawGrid() {
    const floor = this.bounds.isEmpty() ? -1.2 : this.bounds.min.y;
    const cell_m = this.bounds.isEmpty() || this.bounds.getSize(new THREE.Vector3()).length() < 40 ? 1 : 10;
    const key = `${cell_m} ${this.look.grid.getHex()}`;
    if (this.gridKey !== key) {
      this.three.remove(this.grid);
      this.grid?.geometry.dispose();
      this.grid = new THREE.GridHelper(40 * cell_m, 40, this.look.grid, this.look.grid);
      this.three.add(this.grid);
      this.gridKey = key;
    }
    this.grid.position.y = Math.round(floor * 10) / 10;
    this.grid.visible = this.settings.layers.grid;
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.container;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(this.weak ? 1 : kLargestPixelRatio, window.devicePixelRatio));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.applySettings();
  }
}

/** WebGL 2 if there is one; without a graphics card no smoothing of edges, which would take most of the time. */
function createRenderer(software) {
  const canvas = document.createElement("canvas");
  const attributes = { alpha: false, antialias: !software, powerPreference: "high-performance" };
  const context = canvas.getContext("webgl2", attributes) ?? canvas.getContext("webgl", attributes);
  if (!context) throw new Error("the browser offers no WebGL");
  const renderer = new THREE.WebGLRenderer({ canvas, context });
  if (!renderer.capabilities.isWebGL2 && !context.getExtension("OES_texture_float")) {
    throw new Error("the graphics driver has no floating-point textures");
  }
  return renderer;
}

function drawsInSoftware() {
  const context = document.createElement("canvas").getContext("webgl");
  const info = context?.getExtension("WEBGL_debug_renderer_info");
  const name = context?.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER) ?? "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return kSoftware.test(name);
}
