// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Scrubs back through a live run, and compares two of its moments.

import { byId, el, setText } from "./dom.js";
import { length } from "./format.js";
import { difference } from "./history.js";

const kShortest_s = 3;   // before it there is nothing to scrub

export class HistoryBar {
  /** onMoment(moment): show this one; null: what is now. */
  constructor(onMoment) {
    this.onMoment = onMoment;
    this.slider = byId("history-seek");
    this.slider.addEventListener("input", () => this.#seek());
    byId("history-live").addEventListener("click", () => this.live());
    byId("history-pin").addEventListener("click", () => this.#pin());
    byId("compare-close").addEventListener("click", () => this.#unpin());
  }

  /** live: poses come. */
  update(robot, live) {
    if (robot !== this.robot) this.live();
    Object.assign(this, { robot, isLive: live });
    const { history, playback } = robot ?? {}, shown = Boolean(history) && !playback && history.length_s >= kShortest_s;
    byId("history").hidden = !shown;
    if (!shown) return;
    if (this.moment && !history.moments.includes(this.moment)) this.live();
    this.slider.min = -history.length_s;
    if (!this.moment) this.slider.value = 0;
    byId("history-live").disabled = !this.moment;
    const ago_s = this.moment ? history.moments.at(-1).stamp_s - this.moment.stamp_s : 0;
    if (this.moment) this.slider.value = -ago_s;
    setText(byId("history-time"), this.moment ? `${ago_s.toFixed(1)} s ago, ${this.moment.state}` : live ? "live" : "last pose");
    setText(byId("history-live"), live ? "Live" : "Last");
    if (this.pinned) this.#compare();
  }

  live() {
    if (!this.moment) return;
    this.moment = null;
    this.onMoment(null);
    this.update(this.robot, this.isLive);
  }

  #seek() {
    const { history } = this.robot;
    this.moment = Number(this.slider.value) > -0.25 ? null : history.before(-Number(this.slider.value));
    this.onMoment(this.moment);
    this.update(this.robot, this.isLive);
  }

  #pin() {
    this.pinned = this.moment ?? this.robot.history.moments.at(-1);
    this.#compare();
  }

  #unpin() {
    this.pinned = null;
    byId("compare").hidden = true;
  }

  #compare() {
    const now = this.moment ?? this.robot.history.moments.at(-1), moved = difference(this.pinned, now);
    byId("compare").hidden = false;
    for (const [id, moment] of [["compare-a", this.pinned], ["compare-b", now]]) showMoment(byId(id), moment);
    const time_s = Math.abs(now.stamp_s - this.pinned.stamp_s).toFixed(1);
    setText(byId("compare-text"), moved ? `${time_s} s apart: moved ${length(moved.way_m)}, turned ${moved.turn_deg.toFixed(1)}°`
                                        : `${time_s} s apart, without poses in one map`);
  }
}

/** An image with what tracking said then. */
export function showMoment(figure, moment) {
  if (figure.moment === moment) return;
  figure.moment = moment;
  URL.revokeObjectURL(figure.source);
  figure.source = moment.image ? URL.createObjectURL(new Blob([moment.image.jpeg], { type: "image/jpeg" })) : "";
  const text = `${moment.state}, ${moment.inliers} inliers, ${moment.removed} removed`;
  figure.replaceChildren(...(moment.image ? [el("div", { class: "shot" }, el("img", { src: figure.source, alt: text }))] : []), el("figcaption", {}, text));
}
