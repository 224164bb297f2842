// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { reasons } from "../../../services/viewer/page/doubt.js";
import { EventLog } from "../../../services/viewer/page/event_log.js";
import { pathColor, pathLegend } from "../../../services/viewer/page/path_colors.js";
import { MapState } from "../../../services/viewer/page/world.js";

const robot = (tracking, metrics = {}, movers = []) => ({ tracking: { static: 300, inliers: 200, ...tracking }, movers,
                                                         services: [{ name: "slam", metrics }] });

test("a doubtful pose is explained with its numbers, one that is ok is not", () => {
  assert.deepEqual(reasons(robot({ state: "ok" }, { agreement: 0.3 })), []);
  const said = reasons(robot({ state: "doubtful" }, { agreement: 0.31, view_removed: 0.62, position_sigma_m: 0.13, since_ok_s: 2.4 },
                             [{ label: "person" }, { label: "person" }, { label: "" }, { label: "truck", rests: true }]));
  assert.deepEqual(said, ["Only 31 % of the recognised landmarks agree with it; 42 % are needed.", "62 % of the view moves and was removed.",
                          "Moving now: 2 x person, an object of no class.",
                          "Its position is certain to 13.0 cm along the worst axis.", "Last ok 2 s ago."]);
});

test("what disagrees is said while the answer is fresh", () => {
  const doubt = { stamp_s: 9.8, agree: 41, disagree: 38, motions: [{ landmarks: 30, moved_m: [0.12, 0, 0] }] };
  const said = (stamp_s) => reasons({ ...robot({ state: "doubtful", stamp_s }), overlays: { doubt } }).join();
  assert.match(said(10), /38 landmarks disagree with it, 41 agree\.,Of the former, 30 moved together, 12.0 cm since they were mapped\./);
  doubt.motions.push({ landmarks: 9, moved_m: [0, 0, 0.05] });
  assert.match(said(10), /Of the former, groups of 30 and 9 moved 12.0 cm and 5.0 cm since they were mapped\./);
  assert.doesNotMatch(said(20), /disagree/);
});

test("a lost pose: too little in view, or a view that the map does not know", () => {
  assert.match(reasons(robot({ state: "lost", static: 12, inliers: 0 })).join(), /Only 12 static features/);
  assert.match(reasons(robot({ state: "odometry", inliers: 4 })).join(), /300 static features are in view, 4 match the map/);
});

test("events are changes, with when and where; the oldest go", () => {
  const log = new EventLog(), pose = [1, 2, 3, 0, 0, 0, 1];
  for (const [i, state] of ["ok", "ok", "doubtful", "ok"].entries()) log.tracking({ state, stamp_s: i, pose, map: 0 }, { position_s: 10 + i });
  log.services([{ name: "filter", state: "running", message: "" }], null);
  log.services([{ name: "filter", state: "gone", message: "no heartbeat" }], { stamp_s: 4 });
  assert.deepEqual(log.entries.map(({ kind, level, text, position_s }) => [kind, level, text, position_s]),
                   [["tracking", "ok", "tracking: ok", 10], ["tracking", "warn", "tracking: doubtful", 12], ["tracking", "ok", "tracking: ok", 13],
                    ["service", "ok", "filter: running", undefined], ["service", "bad", "filter: gone, no heartbeat", undefined]]);
  for (let i = 0; i < 400; ++i) log.map(`event ${i}`, null);
  assert.deepEqual([log.entries.length, log.entries.at(-1).text], [300, "event 399"]);
});

test("the path is coloured by state, error, uncertainty or time, and a legend says how", () => {
  const map = new MapState(0);
  map.setTrajectoryValues({ start: 0, states: Uint8Array.of(1, 6, 3), times_s: Float32Array.of(0, 5, 10), sigmas_m: Float32Array.of(0.001, 0.01, 0.1),
                            errors_m: Float32Array.of(0, 0.5, NaN) });
  const state = pathColor(map, "state");
  assert.equal(new Set([0, 1, 2].map((entry) => state(entry).join())).size, 3);
  const error = pathColor(map, "error");
  assert.ok(error(1)[0] > error(0)[0] && error(1)[1] < error(0)[1], "from green to red");
  assert.deepEqual(error(2), state(2), "unknown");
  assert.match(pathLegend(map, "time"), /after 10 s/);
  assert.match(pathLegend(map, "error"), /50.0 cm/);
  assert.equal(pathLegend(new MapState(0), "error"), "no ground truth yet");
});
