// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// One robot of the fake server: its state as messages, whole for a new page and in parts as time continues.

import * as encode from "./encode.mjs";
import { cameraView, kHeight, kWidth } from "./camera_view.mjs";
import { Room } from "./room.mjs";

const kTurn_s = 40;                // one way round the room
const kImageEvery = 3, kStatusEvery = 15, kMoversEvery = 2;   // ticks
const kBlocksPerMessage = 400, kCloudPart = 8192;
const kModes = ["off", "semantic", "geometry", "rtd"];

export class FakeRobot {
  constructor(index, { keyframes = 60, points = 5000, replay = true, robots = 1, truth = true, state = "ok", dense = 20_000 } = {}) {
    this.dense = dense;
    this.index = index;
    this.name = robots > 1 ? `robot_${index + 1}` : "";
    this.room = new Room({ keyframes, points, seed: 7 + index });
    this.at = { robot: index };
    this.replay = replay;
    this.truth = truth;
    this.state = state;
    this.time_s = 0;
    this.seq = 0;
    this.paused = false;
    this.speed = 1;
    this.sendsPoses = true;
  }

  get stamp_s() {
    return this.time_s;
  }

  /** What a page gets when it connects. */
  wholeState() {
    return [...this.map(), this.commands(), this.status(), ...(this.replay ? [this.playback()] : [])];
  }

  map() {
    const { keyframes } = this.room, messages = [encode.keyframePoses(keyframes, this.at)];
    for (let i = 0; i < keyframes.length; i += kBlocksPerMessage) {
      const part = keyframes.slice(i, i + kBlocksPerMessage);
      messages.push(encode.points(part.map(({ id, points }) => ({ keyframe: id, scale_m: this.room.scale_m, points })), this.at));
      messages.push(encode.covisibility(part.map(({ id }) => ({ keyframe: id, others: this.room.covisible(id) })), this.at));
    }
    messages.push(encode.trajectory(0, keyframes.map(({ id }) => ({ keyframe: id, p: [0, 0, 0] })), this.at));
    messages.push(encode.trajectoryValues(0, keyframes.map((_, i) => [i % 9 === 0 ? 6 : 1, i, 0.002 * (i % 20), this.truth ? 0.001 * i : NaN]), this.at));
    messages.push(...this.#clouds());
    messages.push(encode.loopEdges(this.room.closed ? this.#loops() : [], this.at));
    if (this.truth) messages.push(...this.#truth());
    return messages;
  }

  /** The messages of one tick; with a speed, and none while paused but the status. */
  tick(ticks, dt_s) {
    const messages = [];
    if (!this.paused) this.time_s += dt_s * this.speed;
    if (!this.paused && this.sendsPoses) messages.push(this.tracking());
    if (!this.paused && ticks % kMoversEvery === 0) messages.push(this.movers());
    if (!this.paused && ticks % kImageEvery === 0) messages.push(...this.view());
    if (ticks % kStatusEvery === 0) messages.push(this.status(), ...(this.replay ? [this.playback()] : []));
    return messages;
  }

  tracking() {
    const { t, q } = this.room.pose((this.time_s / kTurn_s) % 1), wave = Math.sin(0.9 * this.time_s);
    this.seq += 1;
    return {
      type: "tracking", robot: this.index, seq: this.seq, stamp_s: this.stamp_s, state: this.state,
      pose: this.state === "ok" ? [...t, ...q] : null, map: 0, maps: 1, inliers: Math.round(180 + 60 * wave), static: 700,
      removed: Math.round(190 + 90 * wave), keyframes: this.room.keyframes.length, landmarks: this.room.pointCount,
      latency_ms: 24 + 6 * wave + (this.seq % 37 === 0 ? 19 : 0), finished_ms: Date.now() - 3,
      stage_ms: { match: 3.2 + wave, local_map: 4.1 + 0.6 * wave, pose: 1.4, keyframe: this.seq % 20 === 0 ? 5 : 0.3, mapping: 2.2, total: 12 },
      filter_stage_ms: { wait_detections: 2 + 1.5 * wave, extract: 6.1, masks: 1.1, ego_motion: 1.7, depth_check: 0.9, fuse: 0.4, total: 12.2 },
    };
  }

  movers() {
    return { type: "movers", robot: this.index, stamp_s: this.stamp_s, movers: [this.room.person(this.time_s)] };
  }

  view() {
    const { jpeg, depth, box, features, mask, people } = cameraView(this.time_s), { stamp_s, at } = this;
    return [
      encode.image(stamp_s, kWidth, kHeight, jpeg, at), encode.features(stamp_s, kWidth, kHeight, features, at),
      encode.depth(stamp_s, kWidth / 2, kHeight / 2, depth, at), encode.dynamicMask(stamp_s, mask.width, mask.height, mask.values, at),
      encode.personMasks(stamp_s, mask.width, mask.height, people, at),
      { type: "boxes", robot: this.index, stamp_s, boxes: [box] },
    ];
  }

  status() {
    const service = (name, state, metrics, message = "", host = "robot") => ({
      name, pid: 100, state, message, age_ms: 90, metrics: { [`host_name.${host}`]: 1, host_id: host.length, ...metrics },
    });
    const clocks = { "clock.slam.received_ms": 3, "clock.slam.offset_ms": 1.8, "clock.slam.round_trip_ms": 0.6 };
    return { type: "status", robot: this.index, services: [
      service("camera", "running", { frames: this.seq }, "openni2: 640x480, 30 Hz"),
      service("detector", "running", { frames: Math.floor(this.seq / 3), frames_dropped: 2, rate_hz: 29.7,
                                       latency_p50_ms: 18.2, latency_p99_ms: 31.4, ...clocks }, "yolo11s, TensorRT, batch 4", "gpu-box"),
      service("filter", "running", { frames: this.seq, frames_dropped: 0, features_removed: 210 }),
      service("slam", "running", { frames: this.seq, frames_tracked: this.seq, frames_dropped: 0, loops_closed: this.room.closed ? 1 : 0,
                                   keyframes: this.room.keyframes.length, slam_ms: 12.4 }),
      service("dense", "degraded", { frames: Math.floor(this.seq / 5), frames_without_image: 4 }, "too slow: images are discarded early"),
      service("link", "running", { bytes: 1e6 + 900 * this.seq, lost: 0, "out:rtd/tracking": this.seq, "out:rtd/frame/jpeg": this.seq, "in:rtd/detections": this.seq }),
    ] };
  }

  commands() {
    const names = { "/slam/reset": "none", "/slam/save_map": "text", "/slam/load_map": "text", "/slam/localize_only": "bool", "/slam/ask": "text",
                    "/filter/set_mode": "text", "/recorder/start": "text", "/recorder/stop": "none",
                    ...(this.replay ? { "/replay/pause": "bool", "/replay/step": "none", "/replay/seek": "text", "/replay/speed": "text" } : {}) };
    return { type: "commands", robot: this.index, commands: Object.entries(names).map(([name, argument]) => ({ name, argument })) };
  }

  playback() {
    return { type: "playback", robot: this.index, state: this.paused ? "paused" : "playing", position_s: this.time_s % kTurn_s,
             length_s: kTurn_s, speed: this.speed };
  }

  /** Only poses and loop edges: what a closed loop costs. */
  closeLoop() {
    this.room.closeLoop();
    return [encode.keyframePoses(this.room.keyframes, this.at), encode.loopEdges(this.#loops(), this.at)];
  }

  /** {answer: {success, message}, messages: what all pages get} */
  call(name, argument) {
    const done = (message, messages = []) => ({ answer: { success: true, message }, messages });
    switch (name) {
      case "/slam/reset":
        this.room = new Room({ keyframes: 0, points: 0 });
        return done("the map is empty", [{ type: "map_reset", robot: this.index }]);
      case "/slam/save_map":
        return done(`map saved to ${argument || "/tmp/map.rtdmap"}: ${this.room.keyframes.length} keyframes`);
      case "/slam/load_map":
        return { answer: { success: false, message: `no such file: ${argument}` }, messages: [] };
      case "/filter/set_mode":
        return { answer: { success: kModes.includes(argument), message: `mode ${argument}` }, messages: [] };
      case "/slam/ask":
        return done(JSON.stringify(argument === "doubt" ? this.#doubt() : this.#facts(argument)));
      case "/replay/pause": this.paused = argument === "true"; break;
      case "/replay/step": this.time_s += 0.033; return done("one frame", [this.tracking(), ...this.view(), this.playback()]);
      case "/replay/seek": this.time_s = Number(argument); break;
      case "/replay/speed": this.speed = Number(argument); break;
    }
    return done(name.startsWith("/replay") ? `at ${this.time_s.toFixed(1)} s` : `${name} ${argument}`.trim(),
                name.startsWith("/replay") ? [this.playback()] : []);
  }

  /** A box of landmarks that moved 12 cm to the right, and some that were taken for others. */
  #doubt() {
    const moved = Array.from({ length: 30 }, (_, i) => [420 + 12 * (i % 6), 250 + 14 * Math.floor(i / 6), 385 + 12 * (i % 6), 250 + 14 * Math.floor(i / 6), 0]);
    const others = Array.from({ length: 8 }, (_, i) => [60 + 50 * i, 120, 75 + 50 * i, 100 + 5 * i, -1]);
    return { stamp_s: this.stamp_s, agree: 41, disagree: 38, landmarks: [...moved, ...others],
             motions: [{ landmarks: 30, center_m: [0.5, 0, 2], moved_m: [0.12, 0, 0] }] };
  }

  #facts(question) {
    const camera = { fx: 0.81, fy: 1.08, cx: 0.5, cy: 0.5 }, seen_s = Array.from({ length: 60 }, (_, i) => Math.max(0, this.stamp_s - i)).reverse();
    return question.startsWith("keyframe") ? { id: 1, features: 1000, landmarks: 300, connected: 12, sigma_m: 0.012, sigma_deg: 0.2, seen_s: [0.5], camera }
                                           : { id: 812, observations: 60, found: 130, visible: 160, sigma_m: 0.0042, seen_s, camera };
  }

  /** What the room looks like, people in it, and its floor. */
  #clouds() {
    const { room, at, dense } = this, scale_m = 0.001, messages = [], origin = [0, 0, 0.62 * room.half_m];
    for (let start = 0; start < dense; start += kCloudPart) {
      const part = Array.from({ length: Math.min(kCloudPart, dense - start) }, () => room.coloredPoint());
      messages.push(encode.densePoints(start, dense, origin, scale_m, part, at));
    }
    if (dense === 0) return messages;
    const { center, size } = room.person(2), body = () => center.map((value, axis) => value + (room.random() - 0.5) * size[axis]);
    messages.push(encode.movingPoints(0, 500, center, scale_m, Array.from({ length: 500 }, () => [...body(), 200, 180, 160]), at));
    const cells = Array.from({ length: 40 * 40 }, (_, i) => (i % 40 < 2 ? 100 : i % 40 > 36 ? 255 : 0));
    messages.push(encode.floorPlan(0.1, 40, 40, [-2, 1.3, 0], [Math.SQRT1_2, 0, 0, Math.SQRT1_2], cells, at));
    return messages;
  }

  #loops() {
    const last = this.room.keyframes.length - 1;
    return [[last, 0], [last - 1, 1]];
  }

  #truth() {
    const way = new Room({ keyframes: this.room.keyframes.length, points: 0, loopError_m: 0 });
    return [encode.groundTruth(0, way.keyframes.map(({ t }) => t), this.at),
            { type: "truth_error", robot: this.index, ate_m: 0.0123, frames: 300 }];
  }
}
