// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The last minutes of a live run: poses with their images, thinned, in bounded memory. Pure data.

import { pictured } from "./geometry.js";

const kEvery_s = 0.5;
const kRecent = 30;   // poses among which that of an image is found
const kLongest_s = 300;
const kMostBytes = 40e6;

export class History {
  constructor() {
    this.moments = [];   // {stamp_s, seq, state, pose, map, inliers, removed, static, image}
    this.bytes = 0;
    this.recent = [];
  }

  /** A pose came; image: the newest of the camera, a message of decode(), or null. A moment is the image with its pose. */
  add(newest, image) {
    const last = this.moments.at(-1);
    if (last && newest.stamp_s < last.stamp_s) this.clear();   // another run
    this.recent = [...this.recent.slice(1 - kRecent), newest];
    if (last && newest.stamp_s - last.stamp_s < kEvery_s && newest.stamp_s >= last.stamp_s) return;
    const kept = image && Math.abs(image.stamp_s - newest.stamp_s) < kEvery_s ? image : null;
    const { stamp_s, seq, state, pose, map, inliers, removed, static: still } = kept ? this.#at(kept.stamp_s) : newest;
    if (last && stamp_s <= last.stamp_s && newest.stamp_s >= last.stamp_s) return;
    this.moments.push({ stamp_s, seq, state, pose, map, inliers, removed, static: still, image: kept });
    this.bytes += kept?.jpeg.length ?? 0;
    while (this.moments.length > 1 && (this.bytes > kMostBytes || stamp_s - this.moments[0].stamp_s > kLongest_s)) {
      this.bytes -= this.moments.shift().image?.jpeg.length ?? 0;
    }
  }

  clear() {
    this.moments = [];
    this.bytes = 0;
    this.recent = [];
  }

  #at(stamp_s) {
    const apart = ({ stamp_s: other }) => Math.abs(other - stamp_s);
    return this.recent.reduce((best, one) => (apart(one) < apart(best) ? one : best));
  }

  get length_s() {
    return this.moments.length > 1 ? this.moments.at(-1).stamp_s - this.moments[0].stamp_s : 0;
  }

  /** The moment so many seconds before the newest one, or the oldest. */
  before(seconds) {
    const { moments } = this, wanted_s = (moments.at(-1)?.stamp_s ?? 0) - seconds;
    return moments.findLast(({ stamp_s }) => stamp_s <= wanted_s + 1e-6) ?? moments[0];
  }

  /** The moment of a map that is nearest to a stamp, with an image; undefined: none of that time. */
  near(at_s, map) {
    const apart = ({ stamp_s }) => Math.abs(stamp_s - at_s);
    return this.moments.filter((moment) => moment.image && moment.map === map && apart(moment) < kSameTime_s).sort((a, b) => apart(a) - apart(b))[0];
  }

  /** Up to `most` moments near these stamps whose images show a point, spread over them: {moment, x, y}, where it is in
      the image as shares of it. camera: see pictured(). */
  showing(stamps_s, point, map, camera, most) {
    const found = [];
    for (const moment of this.moments) {
      if (!moment.image || !moment.pose || moment.map !== map) continue;
      const at = pictured(moment.pose, point, camera);
      if (at && stamps_s.some((stamp_s) => Math.abs(stamp_s - moment.stamp_s) < kSameTime_s)) found.push({ moment, ...at });
    }
    const step = Math.max(1, (found.length - 1) / (most - 1));
    return Array.from({ length: Math.min(most, found.length) }, (_, i) => found[Math.round(i * step)]);
  }

  /** Up to `most` moments whose camera looked towards a point of a map, the nearest first. */
  towards(point, map, most) {
    return this.moments.filter((moment) => moment.image && moment.pose && moment.map === map)
      .map((moment) => ({ moment, ...sight(moment.pose, point) })).filter(({ cosine }) => cosine > kSight)
      .sort((a, b) => a.distance - b.distance).slice(0, most).map(({ moment }) => moment);
  }
}

const kSameTime_s = 0.3;

const kSight = Math.cos(25 * Math.PI / 180);   // of the optical axis: well inside the image of a usual camera

/** Of a point from a pose: its distance, and the cosine of its angle to the optical axis. */
function sight([x, y, z, qx, qy, qz, qw], point) {
  const way = [point[0] - x, point[1] - y, point[2] - z], distance = Math.hypot(...way) || 1e-9;
  const axis = [2 * (qx * qz + qw * qy), 2 * (qy * qz - qw * qx), 1 - 2 * (qx * qx + qy * qy)];
  return { distance, cosine: axis.reduce((sum, value, i) => sum + value * way[i], 0) / distance };
}

/** Between two moments in one map: way in m and turn in degrees; null if one has no pose or the maps differ. */
export function difference(a, b) {
  if (!a.pose || !b.pose || a.map !== b.map) return null;
  const way_m = Math.hypot(...[0, 1, 2].map((axis) => a.pose[axis] - b.pose[axis]));
  const dot = Math.abs([3, 4, 5, 6].reduce((sum, i) => sum + a.pose[i] * b.pose[i], 0));
  return { way_m, turn_deg: 2 * Math.acos(Math.min(1, dot)) * 180 / Math.PI };
}
