// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Colours of the path by what is known of its poses.

import { length } from "./format.js";
import { percentile } from "./series.js";

export const kPathColorings = ["one colour", "state", "error", "uncertainty", "time"];
const kOk = [0.25, 0.82, 0.5], kDoubt = [0.95, 0.7, 0.15], kNone = [0.55, 0.6, 0.66], kWarm = [[0.25, 0.82, 0.5], [0.98, 0.85, 0.2], [0.9, 0.25, 0.2]];
const kStates = { 1: kOk, 5: kDoubt, 6: kDoubt, 7: kDoubt };   // numbers as in rtd/tracking

/** Of a share from 0 (good, early) to 1. */
function ramp(share) {
  const at = 2 * Math.min(1, Math.max(0, share)), i = Math.min(1, Math.floor(at)), part = at - i;
  return kWarm[i].map((value, axis) => value + part * (kWarm[i + 1][axis] - value));
}

/** Values of a colouring and the one that is red: most poses lie below it. */
function scaleOf({ values }, coloring) {
  const known = { error: values.errors_m, uncertainty: values.sigmas_m, time: values.times_s }[coloring];
  const numbers = known?.filter(Number.isFinite) ?? [];
  return { known, most: coloring === "time" ? numbers.at(-1) : percentile(numbers, 0.98) };
}

/** entry -> [r, g, b], 0..1. */
export function pathColor(map, coloring) {
  const { states } = map.values;
  if (coloring === "state") return (entry) => kStates[states[entry]] ?? kNone;
  const { known, most } = scaleOf(map, coloring);
  if (!known) return () => kNone;
  return (entry) => (Number.isFinite(known[entry]) ? ramp(known[entry] / (most || 1)) : kNone);
}

/** One line that says what the colours mean. */
export function pathLegend(map, coloring) {
  if (coloring === "one colour") return "";
  if (coloring === "state") return "green: ok · yellow: doubtful, predicted, frame to frame";
  const { most } = scaleOf(map, coloring);
  if (!Number.isFinite(most)) return coloring === "error" ? "no ground truth yet" : "no poses yet";
  return coloring === "time" ? `green: start · red: after ${most.toFixed(0)} s` : `green: 0 · red: ${length(most)} and more`;
}
