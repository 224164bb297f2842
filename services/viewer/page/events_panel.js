// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The time line of what happened. A click goes there: in a replay to its time, in a live run to where the camera was.

import { byId, el } from "./dom.js";
import { clockTime } from "./format.js";

export class EventsPanel {
  /** onGo(event): the user chose one. */
  constructor(onGo) {
    this.onGo = onGo;
    this.shown = "";
    byId("events-filter").addEventListener("change", () => this.#draw());
  }

  update(robot) {
    this.robot = robot;
    this.#draw();
  }

  #draw() {
    const kind = byId("events-filter").value, all = this.robot?.events.entries ?? [];
    const entries = all.filter((entry) => kind === "all" || entry.kind === kind || (kind === "trouble" && entry.level !== "ok"));
    const last = entries.at(-1), key = [this.robot?.index, kind, entries.length, last?.text, last?.stamp_s].join();
    if (key === this.shown) return;
    this.shown = key;
    byId("events-none").hidden = entries.length > 0;
    const begin_s = all.find(({ stamp_s }) => stamp_s !== undefined)?.stamp_s ?? 0;
    byId("events").replaceChildren(...entries.toReversed().map((entry) => this.#row(entry, begin_s)));
  }

  #row(entry, begin_s) {
    const time = entry.stamp_s === undefined ? "" : clockTime(entry.stamp_s - begin_s);
    const button = el("button", { type: "button", class: "event", "data-level": entry.level }, el("i", { class: "dot" }), el("b", {}, time), entry.text);
    button.addEventListener("click", () => this.onGo(entry));
    return el("li", {}, button);
  }
}
