// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

import assert from "node:assert/strict";
import { test } from "node:test";
import { Calls } from "../../../services/viewer/page/calls.js";
import { ClockOffset } from "../../../services/viewer/page/clock.js";
import { currentArgument, describe, isIdle, panelCommands } from "../../../services/viewer/page/commands.js";
import { liveAddress, retryDelay_ms } from "../../../services/viewer/page/connection.js";
import { Detail } from "../../../services/viewer/page/detail.js";
import { DrawPace, isLoopback } from "../../../services/viewer/page/draw_pace.js";
import { axisMark, clockTime, length, ms, rate } from "../../../services/viewer/page/format.js";
import { stackLevels } from "../../../services/viewer/page/geometry.js";
import { PoseAge } from "../../../services/viewer/page/pose_age.js";
import { niceCeiling, percentile, Series } from "../../../services/viewer/page/series.js";
import { byHost, detectorLine, linkTopics, summarize } from "../../../services/viewer/page/services.js";

test("percentiles", () => {
  const values = Array.from({ length: 100 }, (_, i) => i + 1);
  assert.deepEqual([0, 0.5, 0.99, 1].map((p) => percentile(values, p)), [1, 50, 99, 100]);
  assert.ok(Number.isNaN(percentile([], 0.5)));
});

test("a series forgets what is old, and begins again when time goes back", () => {
  const series = new Series(10);
  for (let t = 0; t <= 30; ++t) series.push(t, t);
  assert.deepEqual([series.values[0], series.last], [20, 30]);
  series.push(5, 1);
  assert.deepEqual(series.values, [1]);
});

test("axes end at round numbers", () => {
  assert.deepEqual([0, 0.3, 1, 21, 50, 51, 730].map(niceCeiling), [1, 0.5, 1, 50, 50, 100, 1000]);
});

test("marks of an axis are short", () => {
  assert.deepEqual([0, 0.25, 250, 5000, 10_000, 200_000].map(axisMark), ["0", "0.25", "250", "5000", "10k", "200k"]);
});

test("labels that would cover each other are stacked", () => {
  const label = (x, y) => ({ x, y, width: 4, height: 1 });
  assert.deepEqual(stackLevels([label(0, 0), label(3, 0.5), label(6, 0), label(1, 0)]), [0, 1, 0, 3]);
  assert.deepEqual(stackLevels([label(0, 0), label(0, 1)]), [0, 0], "they may touch");
});

test("the clock offset is that of the fastest ping, and 0 within what a ping can resolve", () => {
  const clock = new ClockOffset();
  assert.equal(clock.offset_ms, 0);
  clock.add(1000, 6500, 1400);
  clock.add(2000, 7005, 2010);
  assert.equal(clock.offset_ms, 5000);
  const same = new ClockOffset();
  same.add(1000, 1001, 1004);
  assert.equal(same.offset_ms, 0);
});

test("the age of a pose is measured in the server's clock", () => {
  const age = new PoseAge();
  for (const late of [10, 20, 30]) age.add(5000, 1000 + late, 4000);
  assert.equal(age.p50_ms, 20);
  assert.equal(age.shown_ms(1025, 4000), 20);
  assert.equal(age.shown_ms(4000, 4000), 3000, "nothing came for three seconds");
});

test("the address: scheme, host and token of the page", () => {
  assert.equal(liveAddress({ protocol: "http:", host: "a:8765", search: "" }), "ws://a:8765/live");
  assert.equal(liveAddress({ protocol: "https:", host: "a", search: "?token=x%26y&z=1" }), "wss://a/live?token=x%26y");
});

test("attempts come fast at first and never stop", () => {
  assert.deepEqual([0, 1, 2, 3, 4, 60].map(retryDelay_ms), [500, 1000, 2000, 4000, 5000, 5000]);
});

test("numbers read well", () => {
  assert.deepEqual([ms(3.14), ms(31.4), ms(2736), ms(65_000), ms(NaN)], ["3.1 ms", "31 ms", "2.7 s", "65 s", "–"]);
  assert.deepEqual([length(0.0123), length(2.5)], ["1.2 cm", "2.50 m"]);
  assert.deepEqual([clockTime(65.25), clockTime(3)], ["1:05.3", "0:03.0"]);
  assert.deepEqual([rate(310), rate(1500)], ["310 kB/s", "1.5 MB/s"]);
});

test("commands that destroy something are asked about, unknown ones keep their names", () => {
  const commands = panelCommands([{ name: "/x/jump", argument: "bool" }, { name: "/replay/pause", argument: "bool" },
                                  { name: "/slam/reset", argument: "none" }, { name: "/slam/load_map", argument: "text" }]);
  assert.deepEqual(commands.map(({ name }) => name), ["/slam/reset", "/slam/load_map", "/x/jump"]);
  assert.ok(commands[0].confirm && commands[1].confirm && !commands[2].confirm);
  assert.deepEqual([describe({ name: "/x/jump", argument: "bool" }).kind, describe({ name: "/x/y", argument: "none" }).kind], ["switch", "button"]);
});

test("modes that hold now come from the heartbeats", () => {
  const services = [{ name: "filter", metrics: { frames: 2, "mode.geometry": 1 } }, { name: "slam", metrics: { localize_only: 1 } }];
  assert.deepEqual(["/filter/set_mode", "/slam/localize_only", "/slam/reset"].map((name) => currentArgument(name, services)),
                   ["geometry", "true", undefined]);
  assert.equal(currentArgument("/slam/localize_only", []), undefined);
});

test("a recording cannot be begun twice, nor one be ended that does not run", () => {
  const idle = (recording) => ["/recorder/start", "/recorder/stop", "/slam/reset"].map((name) =>
    isIdle(name, [{ name: "record", metrics: { recording } }]));
  assert.deepEqual([idle(1), idle(0), idle(undefined)], [[true, false, false], [false, true, false], [false, false, false]]);
  assert.equal(isIdle("/recorder/stop", []), false);
});

test("where drawing makes poses late, the page draws less often, and more often again once they are in time", () => {
  const run = (pace, n, latency_ms) => { for (let i = 0; i < n; ++i) pace.pose({ seq: ++run.seq, stamp_s: run.seq / 30, latency_ms }); };
  run.seq = 0;
  const pace = new DrawPace(true), far = new DrawPace(false), slow = new DrawPace(true);
  assert.ok(pace.period_ms > 100, "slowly at first");
  run(pace, 1200, 30);
  assert.equal(pace.period_ms, 33);
  run(pace, 1, 50);
  assert.ok(pace.period_ms > 40, "later than usual, and than a frame takes");
  run(pace, 10, 90);
  assert.ok(pace.period_ms > 200);
  run(pace, 60, 90);
  assert.equal(pace.period_ms, 1000);
  run(pace, 2500, 30);
  assert.equal(pace.period_ms, 33);
  run(slow, 1200, 45);
  assert.equal(slow.period_ms, 33, "what is usual here is in time, up to 1.6 frames");
  run(far, 60, 90);
  assert.equal(far.period_ms, 33);
  assert.deepEqual(["localhost", "127.0.0.1", "[::1]", "robot", "127.example.org"].map(isLoopback), [true, true, true, false, false]);
});

test("a computer that draws slowly draws less often, and the page says so", () => {
  const pace = new DrawPace(false), draw = (took_ms, n) => Array.from({ length: n }, () => pace.drawn(took_ms)).filter(Boolean).length;
  assert.equal(draw(160, 14) + draw(20, 1) + draw(160, 14), 0, "not always");
  assert.equal(pace.reason(false), "");
  assert.equal(draw(160, 20), 1, "once");
  assert.equal(pace.period_ms, 200);
  assert.equal(pace.reason(false), "This computer draws slowly: at most 5 pictures per second");
  assert.equal(new DrawPace(true).reason(true), "Drawn without a graphics card: at most 4 pictures per second");
  assert.equal(new DrawPace(false).reason(true), "", "it is fast enough");
});

test("slow frames lower the share of points that is drawn, fast ones raise it to all again", () => {
  const detail = new Detail(), draw = (took_ms, n, points = 1e6) => { for (let i = 0; i < n; ++i) detail.frame(took_ms, points); };
  draw(33, 20);
  assert.equal(detail.share, 1);
  draw(150, 5);
  assert.ok(detail.share < 0.7);
  draw(150, 50);
  assert.equal(detail.share, 0.05);
  draw(1e6, 1);
  draw(16, 60);
  assert.equal(detail.share, 1);
});

test("30 frames a second while many points are drawn, ten when only a few could be", () => {
  const settle = (points, us_per_point) => {
    const detail = new Detail();
    let took_ms = 0;
    for (let i = 0; i < 300; ++i) {
      took_ms = Math.max(16, 1e-3 * us_per_point * detail.share * points);
      detail.frame(took_ms, points);
    }
    return { drawn: detail.share * points, took_ms };
  };
  assert.ok(settle(100_000, 0.4).took_ms <= 35 && settle(100_000, 0.4).drawn > 70_000);
  assert.ok(settle(1_000_000, 1).took_ms <= 85 && settle(1_000_000, 1).drawn > 50_000);
  assert.equal(settle(50_000, 1).drawn, 50_000, "50 ms, and nothing is left out");
});

test("on the robot's own computer enough is drawn, and no more", () => {
  const detail = new Detail();
  for (let i = 0; i < 50; ++i) detail.frame(5, 120_000, true);
  assert.equal(detail.share, 0.5);
  detail.frame(5, 40_000, true);
  for (let i = 0; i < 50; ++i) detail.frame(5, 40_000, true);
  assert.equal(detail.share, 1);
});

test("a call is resolved by its own answer; a closed connection answers the rest", async () => {
  const sent = [], calls = new Calls((message) => sent.push(message));
  const first = calls.call(0, "/slam/reset"), second = calls.call(0, "/slam/save_map", "a");
  assert.equal(sent[1].argument, "a");
  calls.answer({ id: sent[1].id, success: true, message: "saved" });
  calls.answer({ id: 999, success: true, message: "no call is open" });
  calls.abandon();
  assert.deepEqual([(await second).message, (await first).success], ["saved", false]);
  assert.equal((await new Calls(() => false).call(0, "/x")).success, false);
});

const detector = { name: "detector", state: "running", message: "yolo11s, TensorRT", metrics: {
  "host_name.gpu-box": 1, host_id: 5, frames_dropped: 2, frames_broken: 1, rate_hz: 29.7, latency_p50_ms: 18, latency_p99_ms: 31,
  "clock.slam.offset_ms": 1.5, "clock.slam.round_trip_ms": 0.5, "topic.rt/x.type_mismatch": 2 } };

test("a heartbeat: host, drops, clocks and troubles out of the metrics", () => {
  const { host, drops, clocks, troubles, metrics } = summarize(detector);
  assert.deepEqual([host, drops, troubles], ["gpu-box", 3, ["topic.rt/x.type_mismatch"]]);
  assert.deepEqual(clocks, [{ peer: "slam", offset_ms: 1.5, round_trip_ms: 0.5 }]);
  assert.ok(!metrics.some(([name]) => name === "host_id"));
});

test("services stand host by host, the robot's own first", () => {
  const on = (host, name, state = "running") => ({ name, state, host });
  const list = [on("box", "detector"), on("robot", "slam"), on("robot", "camera"), on("robot", "filter", "degraded")];
  assert.deepEqual(byHost(list).map(({ name }) => name), ["filter", "camera", "slam", "detector"]);
  const camera = { name: "camera", metrics: { "host_name.gpu-box": 1 } };
  assert.match(detectorLine([detector, camera]), /^on the robot's host · /);
});

test("where objects are detected, and what links pass", () => {
  assert.match(detectorLine([detector]), /on gpu-box · yolo11s, TensorRT · 18 ms p50, 31 ms p99 · 29.7 images\/s/);
  assert.equal(detectorLine([]), "");
  assert.deepEqual(linkTopics([{ name: "link", metrics: { "out:rtd/a": 5, "in:rtd/b": 6, bytes: 1 } }]),
                   [{ direction: "out", topic: "rtd/a", messages: 5 }, { direction: "in", topic: "rtd/b", messages: 6 }]);
});
