// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The panel of plots: latency, times of the stages, inliers, share of features that the filter removed.

import { byId, el, setAttribute, setText } from "./dom.js";
import { drawLine, drawStack } from "./chart.js";
import { count, ms } from "./format.js";
import { kSeriesColors } from "./palette.js";
import { percentile } from "./series.js";
import { inOrder } from "./session.js";

const kP50 = "#27ae60", kP99 = "#e2574c";
const kStays_s = 5;             // after the last pose the plots stand still
const kLeastShare_ms = 0.05;    // a stage that never takes so long is not worth a colour

export class Plots {
  constructor() {
    this.parts = {};
    for (const [name, title] of [["latency", "Latency"], ["stages", "Stages"], ["inliers", "Inliers"],
                                 ["removed", "Removed features"]]) {
      const numbers = el("span", { class: "numbers" }), canvas = el("canvas", { class: "chart", role: "img" });
      const legend = el("ul", { class: "legend" });
      this.parts[name] = { title, numbers, canvas, legend };
      byId("plots").append(el("div", { class: "plot" }, el("div", { class: "plot-head" }, el("h3", {}, title), numbers), canvas,
                              ...(name === "stages" ? [legend] : [])));
    }
    this.names = "";
  }

  /** now_s: browser's clock of the histories. */
  update(robot, screen_s) {
    byId("plots-none").hidden = Boolean(robot?.tracking);
    byId("plots").hidden = !robot?.tracking;
    if (!robot?.tracking) return;
    const { latency_ms, inliers, removedShare } = robot.series;
    const now_s = Math.min(screen_s, robot.trackingAt_ms / 1000 + kStays_s);
    const p50 = percentile(latency_ms.values, 0.5), p99 = percentile(latency_ms.values, 0.99);
    this.#write("latency", `p50 ${ms(p50)} · p99 ${ms(p99)}`);
    drawLine(this.parts.latency.canvas, latency_ms, now_s, { marks: [{ value: p50, color: kP50 }, { value: p99, color: kP99 }] });
    this.#write("inliers", count(inliers.last));
    drawLine(this.parts.inliers.canvas, inliers, now_s);
    this.#write("removed", `${removedShare.last.toFixed(0)} %`);
    drawLine(this.parts.removed.canvas, removedShare, now_s, { highest: 100 });
    this.#updateStages(robot.series.stage_ms, now_s);
  }

  #updateStages(history, now_s) {
    const means = new Map();
    for (const parts of history.values) {
      for (const [name, value] of Object.entries(parts)) means.set(name, (means.get(name) ?? 0) + value / history.values.length);
    }
    const names = inOrder(means.keys()).filter((name) => means.get(name) >= kLeastShare_ms);
    this.#writeLegend(names, means);
    this.#write("stages", `mean ${ms(names.reduce((sum, name) => sum + means.get(name), 0))}`);
    drawStack(this.parts.stages.canvas, history, names, now_s);
  }

  #writeLegend(names, means) {
    const { legend } = this.parts.stages;
    if (names.join() !== this.names) {
      this.names = names.join();
      this.entries = names.map((name, i) => {
        const mark = el("i", { class: "mark" });
        mark.style.background = kSeriesColors[i % kSeriesColors.length];
        return el("li", {}, mark, el("span", { title: name }, name.slice(name.indexOf(" ") + 1)), el("b"));
      });
      const service = (name) => name.slice(0, name.indexOf(" "));
      legend.replaceChildren(...this.entries.flatMap((entry, i) =>
        (i > 0 && service(names[i]) === service(names[i - 1]) ? [entry] : [el("li", { class: "service-name" }, service(names[i])), entry])));
    }
    names.forEach((name, i) => setText(this.entries[i].lastChild, ms(means.get(name))));
  }

  #write(name, text) {
    const { title, numbers, canvas } = this.parts[name];
    setText(numbers, text);
    setAttribute(canvas, "aria-label", `${title}, last minute: ${text}`);
  }
}
