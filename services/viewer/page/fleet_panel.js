// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// All robots at a glance, when there are several: a row of figures for each. A click goes to one. Below, who has met in
// the joint map of an atlas.

import { byId, el, setText } from "./dom.js";
import { count, length, ms } from "./format.js";
import { percentile } from "./series.js";
import { situation } from "./waiting.js";

const kFigures = ["State", "Latency", "Inliers", "Removed", "Keyframes", "Error", "Services"];

export class FleetPanel {
  constructor(onRobot) {
    this.onRobot = onRobot;
    this.key = "";
  }

  update(session, selected, connection, now_ms) {
    const robots = session.byName;
    byId("panel-fleet").hidden = document.querySelector("[data-panel=fleet]").hidden = robots.length < 2 && session.atlas.length === 0;
    this.#list(session.atlas);
    byId("fleet").hidden = robots.length < 2;
    if (robots.length < 2) return;
    const key = robots.map(({ index, name }) => `${index} ${name}`).join();
    if (key !== this.key) this.#build(robots);
    this.key = key;
    for (const robot of robots) this.#fill(robot, session, selected, connection, now_ms);
  }

  #build(robots) {
    this.rows = new Map();
    const head = el("tr", {}, el("th", {}, "Robot"), ...kFigures.map((name) => el("th", {}, name)));
    const rows = robots.map((robot) => {
      const button = el("button", { type: "button" }, robot.title), cells = kFigures.map(() => el("td", {}));
      button.addEventListener("click", () => this.onRobot(robot.index));
      const row = el("tr", {}, el("th", {}, button), ...cells);
      this.rows.set(robot.index, { row, cells });
      return row;
    });
    byId("fleet").replaceChildren(head, ...rows);
  }

  #list(robots) {
    const lines = meetings(robots), text = lines.join("\n");
    if (text === this.listed) return;
    this.listed = text;
    byId("joint-map").replaceChildren(...lines.map((line) => el("li", {}, line)));
  }

  #fill(robot, session, selected, connection, now_ms) {
    const { row, cells } = this.rows.get(robot.index), report = situation({ connection, hello: session.hello, robot, now_ms });
    figures(robot, report.title).forEach((text, i) => setText(cells[i], text));
    row.dataset.level = report.level;
    row.classList.toggle("selected", robot.index === selected);
  }
}

/** Who of the robots of an atlas is in its map: a line for each. */
export function meetings(robots) {
  return robots.map(({ name, met }) => `${name || "robot"}: ${met ? "met" : "not met"}`);
}

/** One text for each of the figures. title: of its state. */
export function figures(robot, title) {
  const { tracking, history, services, truthError, series } = robot, running = services.filter(({ state }) => !["finished", "failed", "gone"].includes(state));
  const seen = tracking ? tracking.static + tracking.removed : 0;
  return [title, ms(percentile(series.latency_ms.values, 0.5)), count(tracking?.inliers), seen > 0 ? `${Math.round(100 * tracking.removed / seen)} %` : "–",
          count(tracking?.keyframes), truthError ? length(truthError.ate_m) : "–", `${running.length} of ${services.length}`];
}
