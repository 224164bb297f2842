// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Why a pose is not sure, in words with the numbers behind it.

import { length } from "./format.js";
import { doubtInWords } from "./questions.js";

const kEnoughAgreement = 0.42;   // below it a pose is doubtful
const kCrowdedShare = 0.5;
const kFewFeatures = 100;
const kAnswerHolds_s = 1;

const percent = (share) => `${Math.round(100 * share)} %`;

/** Sentences about the newest pose; none while it is ok. metrics: of slam's heartbeat. overlays.doubt: what slam
    answered when it was asked. */
export function reasons({ tracking, services, movers, overlays }) {
  if (!tracking || tracking.state === "ok" || tracking.state === "initializing") return [];
  const metrics = services.find(({ name }) => name === "slam")?.metrics ?? {}, { agreement, view_removed, position_sigma_m, since_ok_s } = metrics;
  const found = [];
  if (tracking.state === "doubtful" && agreement > 0 && agreement < kEnoughAgreement) {
    found.push(`Only ${percent(agreement)} of the recognised landmarks agree with it; ${percent(kEnoughAgreement)} are needed.`);
  }
  const doubt = overlays?.doubt;
  if (doubt && Math.abs(tracking.stamp_s - doubt.stamp_s) < kAnswerHolds_s) found.push(...doubtInWords(doubt));
  if (view_removed >= kCrowdedShare) found.push(`${percent(view_removed)} of the view moves and was removed.`);
  if (tracking.static < kFewFeatures) found.push(`Only ${tracking.static} static features are in view.`);
  else if (tracking.inliers < 30) found.push(`${tracking.static} static features are in view, ${tracking.inliers} match the map.`);
  const moving = movers.filter(({ rests }) => !rests).map(({ label }) => label || "an object of no class");
  if (moving.length > 0) found.push(`Moving now: ${countOf(moving)}.`);
  if (position_sigma_m > 0 && position_sigma_m < 100) found.push(`Its position is certain to ${length(position_sigma_m)} along the worst axis.`);
  if (since_ok_s > 1) found.push(`Last ok ${since_ok_s.toFixed(0)} s ago.`);
  return found;
}

/** "3 x person, truck" */
function countOf(names) {
  const counts = new Map();
  for (const name of names) counts.set(name, (counts.get(name) ?? 0) + 1);
  return [...counts].map(([name, n]) => (n > 1 ? `${n} x ${name}` : name)).join(", ");
}
