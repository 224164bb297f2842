// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What lies under the pointer, and what is known of it. Pure functions.

import { landmark } from "./geometry.js";
import { length } from "./format.js";

const kReach_px = { keyframe: 14, mover: 22, landmark: 9 };
const kByName = ["mover", "keyframe", "landmark"];   // of what is as near, the first

/** Everything of a map that can be asked: {kind, id, point}, point in the map's frame. shown: switches of the layers. */
export function* things(map, movers, shown) {
  if (shown.movers) for (const mover of movers) yield { kind: "mover", id: mover.id, point: mover.center, mover };
  for (const keyframe of map.keyframes.values()) {
    if (!keyframe.posed) continue;
    const pose = map.pose(keyframe.slot);
    if (shown.keyframes) yield { kind: "keyframe", id: keyframe.id, point: [...pose.subarray(0, 3)], keyframe };
    if (shown.points && keyframe.points) yield* landmarks(map, keyframe);
  }
}

function* landmarks(map, keyframe) {
  for (let i = 0; i < keyframe.points.n; ++i) {
    const point = [];
    landmark(map, keyframe, i, point, 0);
    yield { kind: "landmark", id: `${keyframe.id}/${i}`, index: i, point, keyframe, certainty: keyframe.points.data[8 * i + 6] / 255 };
  }
}

/** The thing nearest to the pointer within reach, or null. project(point): {x, y (px), depth}, or null behind the view. */
export function nearest(candidates, pointer, project) {
  let best = null;
  for (const thing of candidates) {
    const seen = project(thing.point);
    if (!seen) continue;
    const apart_px = Math.hypot(seen.x - pointer.x, seen.y - pointer.y) / kReach_px[thing.kind];
    const order = [Math.floor(3 * apart_px), kByName.indexOf(thing.kind), seen.depth];
    if (apart_px <= 1 && (!best || before(order, best.order))) best = { thing, order };
  }
  return best?.thing ?? null;
}

function before(a, b) {
  const i = a.findIndex((value, place) => value !== b[place]);
  return i >= 0 && a[i] < b[i];
}

const place = (point) => point.map((value) => value.toFixed(2)).join(", ");

/** Title and rows of a card. tracking: the newest pose of the robot, or null. */
export function describe({ kind, id, point, keyframe, certainty, mover }, tracking) {
  const rows = [["Position", `${place(point)} m`]];
  if (tracking?.pose) rows.push(["From the camera", length(Math.hypot(...point.map((value, axis) => value - tracking.pose[axis])))]);
  if (kind === "landmark") {
    rows.push(["Of keyframe", String(keyframe.id)], ["Static", `${Math.round(100 * certainty)} %`]);
    return { title: `Landmark ${id}`, rows };
  }
  if (kind === "keyframe") {
    rows.push(["Landmarks", String(keyframe.points?.total ?? 0)]);
    return { title: `Keyframe ${id}`, rows };
  }
  const speed_mps = Math.hypot(...mover.velocity);
  rows.push(["Size", `${place(mover.size)} m`], ["Speed", mover.rests ? "within its uncertainty" : `${speed_mps.toFixed(2)} m/s`],
            ["Static", `${Math.round(100 * mover.static_probability)} %`]);
  return { title: `${mover.label || "Object of no class"} ${id}`, rows };
}

/** How far two points are apart. */
export const apart_m = (a, b) => Math.hypot(...a.map((value, axis) => value - b[axis]));
