// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Everything the server has sent since the connection was opened. Pure data: messages in, state out; no DOM, no clock.

import { companionsOf } from "./atlas.js";
import { EventLog } from "./event_log.js";
import { History } from "./history.js";
import { MapState } from "./world.js";
import { Series } from "./series.js";

const kOverlaySlack_s = { depth: 0.4, doubt: 0.4 };   // an overlay belongs to an image if their stamps differ by less, usually 0.1
const kCatchUp_ms = 3000;
export const kOfImage = ["image", "features", "people", "mask", "depth"];
const kStageOrder = ["wait_detections", "extract", "masks", "ego_motion", "depth_check", "fuse", "match", "local_map", "pose",
                     "relocalize", "keyframe", "mapping"];   // as they follow each other; others come last
const kMapHandlers = {
  keyframe_poses: "setPoses", keyframes_removed: "remove", points: "setPoints", covisibility: "setCovisibility",
  loop_edges: "setLoops", trajectory: "setTrajectory", ground_truth: "setTruth", dense: "setDense",
  moving: "setMoving", plan: "setPlan", trajectory_values: "setTrajectoryValues",
};

export class RobotState {
  constructor(index) {
    this.index = index;
    this.name = "";
    this.maps = new Map();
    this.tracking = null;
    this.trackingAt_ms = -Infinity;  // browser's clock
    this.services = [];
    this.deaths = new Map();  // how often each service was restarted without having ended
    this.movers = [];
    this.companions = [];   // other robots in its map: {name, pose}
    this.commands = [];
    this.playback = null;
    this.truthError = null;
    this.events = new EventLog();
    this.history = new History();
    this.image = null;
    this.overlays = { boxes: null, features: null, people: null, mask: null, depth: null, doubt: null };
    this.series = { latency_ms: new Series(), inliers: new Series(), removedShare: new Series(), stage_ms: new Series() };
  }

  /** Whether the world of its maps has z up: that of a robot with a base. */
  get zUp() {
    return this.services.find(({ name }) => name === "slam")?.metrics?.map_z_up === 1;
  }

  get title() {
    return this.name === "" ? "robot" : this.name;
  }

  /** Names a map of this robot for what the user chooses. Not by the index: a viewer that was restarted may give others. */
  mapKey(id) {
    return `${this.name}:${id}`;
  }

  map(id) {
    if (!this.maps.has(id)) this.maps.set(id, new MapState(id));
    return this.maps.get(id);
  }

  /** The overlay that belongs to the image: of the same frame, or nearly. */
  overlay(name) {
    const overlay = this.overlays[name];
    const near = overlay && this.image && Math.abs(overlay.stamp_s - this.image.stamp_s) < (kOverlaySlack_s[name] ?? 0.1);
    return near ? overlay : null;
  }

  /** Whether the pose that it has now is doubtful. */
  get doubts() {
    return this.tracking !== null && this.tracking.state !== "ok";
  }

  /** Of the image that is shown, by the poses: an image may have come long after it was taken. */
  imageAge_s(now_ms) {
    if (!this.image || !this.tracking) return 0;
    return (now_ms - this.trackingAt_ms) / 1000 + Math.max(0, this.tracking.stamp_s - this.image.stamp_s);
  }

  count(name) {
    return [...this.maps.values()].reduce((sum, map) => sum + map[name], 0);
  }

  setServices(reported) {
    const services = reported.map((one) => (one.name === "viewer" && one.state === "gone" ? { ...one, state: "running" } : one));   // it sent this
    for (const { name, pid } of services) {
      const before = this.services.find((one) => one.name === name);
      if (before?.state === "finished" && before.pid !== pid) this.deaths.delete(name);   // another run
      else if (before && before.pid !== pid) this.deaths.set(name, (this.deaths.get(name) ?? 0) + 1);
    }
    this.services = services;
    this.events.services(services, this.tracking, this.playback);
  }

  forgetMaps() {
    if (this.count("posedCount") > 0) this.events.map("the map begins again", this.tracking, this.playback);
    this.maps.clear();
    this.movers = [];
  }

  setTracking(message, now_ms) {
    this.tracking = message;
    this.trackingAt_ms = now_ms;
    this.events.tracking(message, this.playback);
    if (!this.playback) this.history.add(message, this.image);
    const seen = (message.static ?? 0) + (message.removed ?? 0), at_s = now_ms / 1000;
    this.series.latency_ms.push(at_s, message.latency_ms);
    this.series.inliers.push(at_s, message.inliers);
    this.series.removedShare.push(at_s, seen > 0 ? 100 * message.removed / seen : 0);
    this.series.stage_ms.push(at_s, stages(message));
  }
}

/** Titles of stages, as in the history, in the order in which the stages run. */
export function inOrder(titles) {
  const rank = (title) => (kStageOrder.indexOf(title.replace(/^\w+ /, "").replaceAll(" ", "_")) + 99) % 99;
  return [...titles].sort((a, b) => rank(a) - rank(b));
}

/** Times of the filter's and slam's stages, without the totals. */
function stages({ filter_stage_ms = {}, stage_ms = {} }) {
  const parts = {};
  for (const [prefix, times] of [["filter", filter_stage_ms], ["slam", stage_ms]]) {
    for (const [name, ms] of Object.entries(times)) {
      if (!/total$/.test(name)) parts[`${prefix} ${name.replaceAll("_", " ")}`] = ms;
    }
  }
  return parts;
}

export class Session {
  constructor() {
    this.hello = null;
    this.link = null;
    this.robots = new Map();
    this.atlas = [];          // robots of the message `atlas`
    this.announced = false;   // whether the list of robots has come
    this.generation = 0;      // counts the robots and maps that came or went
  }

  robot(index) {
    if (!this.robots.has(index)) {
      this.robots.set(index, new RobotState(index));
      this.generation += 1;
    }
    return this.robots.get(index);
  }

  /** All robots, by their names. */
  get byName() {
    return [...this.robots.values()].sort((a, b) => a.name.localeCompare(b.name) || a.index - b.index);
  }

  /** The robot of that name, else the first one; undefined without robots. */
  robotNamed(name) {
    return this.byName.find((robot) => robot.name === name) ?? this.byName[0];
  }

  /** A text message; answers and pongs are for others. Unknown types are left alone: a newer server may send them. */
  applyText(message, now_ms) {
    const robot = () => this.robot(message.robot ?? 0);
    switch (message.type) {
      case "hello": [this.hello, this.helloAt_ms] = [message, now_ms]; break;
      case "link": this.link = message; break;
      case "robots": this.#setRobots(message.robots); break;
      case "atlas": this.atlas = message.robots; this.#placeCompanions(); break;
      case "map_reset": robot().forgetMaps(); this.generation += 1; break;
      case "tracking": robot().setTracking(message, this.#readyAt_ms(message, now_ms)); break;
      case "status": robot().setServices(message.services); break;
      case "boxes": robot().overlays.boxes = message; break;
      case "movers": robot().movers = message.movers; break;
      case "commands": robot().commands = message.commands; break;
      case "playback": robot().playback = message; break;
      case "truth_error": robot().truthError = message; break;
    }
  }

  /** Browser's clock. Poses from before the page was open come first, all at once. */
  #readyAt_ms({ finished_ms }, now_ms) {
    const since_ms = now_ms - this.helloAt_ms, server_ms = this.hello?.server_ms + since_ms;
    return since_ms < kCatchUp_ms && finished_ms < server_ms ? now_ms - (server_ms - finished_ms) : now_ms;
  }

  /** A message from decode(). */
  applyBinary(message) {
    const robot = this.robot(message.robot);
    if (message.type === "image") {
      robot.image = message;
    } else if (kOfImage.includes(message.type)) {
      robot.overlays[message.type] = message;
    } else {
      if (!robot.maps.has(message.map)) this.generation += 1;
      const map = robot.map(message.map), loops = map.loops.length;
      map[kMapHandlers[message.type]](message);
      if (map.loops.length > loops) robot.events.map("loop closed", robot.tracking, robot.playback);
    }
  }

  #setRobots(robots) {
    this.announced = true;
    for (const { index, name } of robots) this.robot(index).name = name;
    const there = new Set(robots.map((robot) => robot.index));
    for (const index of [...this.robots.keys()]) {
      if (!there.has(index)) this.robots.delete(index);
    }
    this.#placeCompanions();
    this.generation += 1;
  }

  #placeCompanions() {
    for (const robot of this.robots.values()) robot.companions = companionsOf(this.atlas, robot.name);
  }
}
