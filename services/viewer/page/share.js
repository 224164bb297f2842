// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What is shown, to pass on: as a link, and as one HTML file with everything inside. Pure functions.

import { landmark, transform } from "./geometry.js";

const kMostBytes = 5_000_000, kTexts = 20_000;   // of a file; room for its numbers and names
const kSteps = 32767;
const kColors = { points: "#4f9cf9", trajectory: "#3fd07f", truth: "#b48ef7", moving: "#9fb3c8" };

/** For the address of the page, after "#". view: {mode, eye, target}; at_s: of a replay, or undefined. */
export function hashOf({ layers, view, robot, at_s }) {
  const numbers = (values) => values.map((value) => Number(value.toFixed(3))).join(",");
  const fields = { layers: Object.keys(layers).filter((name) => layers[name]).join(","), mode: view.mode,
                   eye: numbers(view.eye), target: numbers(view.target) };
  if (robot) fields.robot = robot;
  if (at_s !== undefined) fields.at = String(Number(at_s.toFixed(2)));
  return new URLSearchParams(fields).toString();
}

/** The address of a page without the token that allows commands. look_token: which the viewer has for those who only
    look, "": they need none; undefined: this page only looks itself. */
export function addressToLook(href, look_token) {
  const address = new URL(href);
  if (look_token === "") address.searchParams.delete("token");
  else if (look_token) address.searchParams.set("token", look_token);
  return address.href;
}

/** What a link asks for; parts that are missing or no use are undefined. */
export function parseHash(hash) {
  const fields = new URLSearchParams(hash.replace(/^#/, ""));
  const numbers = (name) => {
    const values = (fields.get(name) ?? "").split(",").map(Number);
    return values.length === 3 && values.every(Number.isFinite) ? values : undefined;
  };
  const at_s = fields.has("at") ? Number(fields.get("at")) : NaN, eye = numbers("eye"), target = numbers("target");
  return { layers: fields.get("layers")?.split(","), robot: fields.get("robot") ?? undefined, at_s: Number.isFinite(at_s) ? at_s : undefined,
           view: eye && target ? { mode: fields.get("mode") ?? "free", eye, target } : undefined };
}

/** Coordinates of a point of the scene in the map's frame. The scene's y is up; see robot_layer.js. */
export const inMap = ([x, y, z], zUp) => (zUp ? [x, -z, y] : [x, -y, -z]);

/** As the page of the file wants it: from where around what. eye, target: in the map's frame. */
export function aroundTarget(eye, target, zUp) {
  const way = eye.map((value, axis) => value - target[axis]), distance = Math.hypot(...way) || 1, [x, y, z] = way.map((value) => value / distance);
  return zUp ? { target, distance, tilt: Math.asin(z), turn: Math.atan2(-y, -x) }
             : { target, distance, tilt: Math.asin(-y), turn: Math.atan2(x, -z) };
}

/** The scene of the file: what of a map is shown. layers: switches by name. */
export function sceneOf(map, { title, zUp, layers, view, facts = [], room = kMostBytes }) {
  const clouds = [["dense", "Room", partsOf(map.dense)], ["moving", "What moved", { ...partsOf(map.moving), colors: null }],
                  ["points", "Landmarks", { positions: landmarksOf(map), colors: null }]]
    .filter(([name, , { positions }]) => layers[name] && positions.length > 0);
  const bytes = clouds.reduce((sum, [, , { positions, colors }]) => sum + positions.length / 3 * (colors ? 12 : 8), 0);
  const share = Math.min(1, (room - kTexts) / Math.max(1, bytes));
  const packed = clouds.map(([name, text, { positions, colors }]) => layerOf(name, text, positions, colors, share));
  const lines = [["trajectory", "Path of the camera", trajectoryOf(map)], ["truth", "Ground truth", map.truth]]
    .filter(([name, , positions]) => layers[name] && positions.length > 0)
    .map(([name, text, positions]) => ({ ...layerOf(name, text, positions, null, 1), line: true }));
  return { title, z_up: zUp, facts, view, layers: [...packed, ...lines] };
}

/** template: the page without its scene. */
export const fileOf = (template, scene) =>
  template.replace("@SCENE@", () => JSON.stringify(scene).replaceAll("<", "\\u003c"));

function partsOf({ parts }) {
  const ordered = [...parts].sort((a, b) => a.start - b.start);
  return { positions: ordered.flatMap(({ positions }) => [...positions]), colors: ordered.flatMap(({ colors }) => [...colors]) };
}

function landmarksOf(map) {
  const out = [];
  for (const keyframe of map.keyframes.values()) {
    if (!keyframe.posed || !keyframe.points) continue;
    for (let i = 0; i < keyframe.points.n; ++i) landmark(map, keyframe, i, out, out.length);
  }
  return out;
}

function trajectoryOf(map) {
  const { keyframes, positions, length } = map.trajectory, out = [];
  for (let entry = 0; entry < length; ++entry) {
    const slot = map.posedSlot(keyframes[entry]);
    if (slot < 0) continue;
    const pose = map.pose(slot);
    transform(pose, pose.subarray(4), positions.subarray(3 * entry, 3 * entry + 3), out, out.length);
  }
  return out;
}

/** The share of the points, evenly, in 16-bit steps about the middle of their box. */
function layerOf(name, text, positions, colors, share) {
  const all = positions.length / 3, count = Math.floor(share * all), places = Array.from({ length: count }, (_, i) => Math.floor(i * all / count));
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const place of places) {
    for (let axis = 0; axis < 3; ++axis) {
      low[axis] = Math.min(low[axis], positions[3 * place + axis]);
      high[axis] = Math.max(high[axis], positions[3 * place + axis]);
    }
  }
  const origin = low.map((value, axis) => (value + high[axis]) / 2 || 0);
  const scale = Math.max(1e-4, ...high.map((value, axis) => (value - low[axis]) / 2 || 0)) / kSteps;
  const steps = new Int16Array(3 * count), own = colors ? new Uint8Array(3 * count) : null;
  places.forEach((place, i) => {
    for (let axis = 0; axis < 3; ++axis) {
      steps[3 * i + axis] = Math.round((positions[3 * place + axis] - origin[axis]) / scale);
      if (own) own[3 * i + axis] = colors[3 * place + axis];
    }
  });
  const layer = { name: text, shown: true, line: false, origin, scale, color: kColors[name] ?? "#ffffff", points: base64(new Uint8Array(steps.buffer)) };
  return own ? { ...layer, colors: base64(own) } : layer;
}

function base64(bytes) {
  const kPart = 0x8000, parts = [];
  for (let at = 0; at < bytes.length; at += kPart) parts.push(String.fromCharCode(...bytes.subarray(at, at + kPart)));
  return btoa(parts.join(""));
}
