// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What the page asks slam (the command /slam/ask), and its answers in words.

import { offers } from "./commands.js";
import { landmarkInCamera } from "./geometry.js";
import { length } from "./format.js";

export const kAsk = "/slam/ask";
const kPause_ms = 250;                        // between two questions why a pose is doubtful
const kMeasured = ["doubtful", "odometry"];   // states in which a pose is measured and much may contradict it

export class Questions {
  /** calls: Calls */
  constructor(calls) {
    this.calls = calls;
  }

  /** The answer as an object, or null. */
  async ask(robot, question) {
    if (!offers(robot.commands, kAsk)) return null;
    const { success, message } = await this.calls.call(robot.index, kAsk, question);
    try {
      return success ? JSON.parse(message) : null;
    } catch {
      return null;
    }
  }

  /** Asks why the pose is doubtful, while it is; onAnswer(): the robot has another answer. */
  async followDoubt(robot, now_ms, onAnswer) {
    if (this.waits || now_ms - this.asked_ms < kPause_ms || !kMeasured.includes(robot?.tracking?.state)) return;
    this.waits = true;
    this.asked_ms = now_ms;
    const doubt = await this.ask(robot, "doubt");
    this.waits = false;
    if (!doubt) return;
    robot.overlays.doubt = doubt;
    onAnswer();
  }
}

/** The question about a thing of the map; null: of it slam knows no more. */
export function questionAbout({ kind, keyframe, index }) {
  if (kind === "keyframe") return `keyframe ${keyframe.id}`;
  if (kind !== "landmark") return null;
  return `landmark ${keyframe.id} ${landmarkInCamera(keyframe, index).map((value) => value.toFixed(4)).join(" ")}`;
}

/** Rows of a card. stamp_s: of the newest pose. */
export function answerRows({ observations, found, visible, features, connected, sigma_m, sigma_deg, seen_s }, stamp_s) {
  const rows = [], ago = (at_s) => (stamp_s >= at_s ? `${(stamp_s - at_s).toFixed(1)} s ago` : "in an earlier run");
  const keyframes = (count) => `${count} ${count === 1 ? "keyframe" : "keyframes"}`;
  if (observations) rows.push(["Observations", `${keyframes(observations)}; in ${found} of ${visible} frames`]);
  if (features) rows.push(["Features", String(features)], ["Connected to", keyframes(connected)]);
  if (sigma_m > 0) rows.push(["Certain to", `${length(sigma_m)}${sigma_deg > 0 ? `, ${sigma_deg.toFixed(2)}°` : ""} along the worst axis`]);
  if (seen_s.length > 1) rows.push(["First seen", ago(seen_s[0])]);
  return [...rows, [seen_s.length > 1 ? "Last seen" : "Taken", ago(seen_s.at(-1))]];
}

/** In words: which landmarks disagree and what they follow. doubt: an answer. */
export function doubtInWords({ agree, disagree, motions }) {
  if (disagree === 0) return [];
  const said = [`${disagree} landmarks disagree with it, ${agree} agree.`];
  const groups = motions.map(({ landmarks }) => landmarks), ways = motions.map(({ moved_m }) => length(Math.hypot(...moved_m)));
  if (groups.length === 1) said.push(`Of the former, ${groups[0]} moved together, ${ways[0]} since they were mapped.`);
  if (groups.length > 1) said.push(`Of the former, groups of ${listed(groups)} moved ${listed(ways)} since they were mapped.`);
  return said;
}

/** "80, 41 and 32" */
const listed = (items) => [items.slice(0, -1).join(", "), items.at(-1)].join(" and ");
