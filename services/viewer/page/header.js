// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The line at the top and the notice on the map: where things stand.

import { byId, el, setAttribute, setText } from "./dom.js";
import { count, length, ms } from "./format.js";

const kGoodAge_ms = 100, kBadAge_ms = 500;

export class Header {
  constructor(onRobot) {
    byId("robot").addEventListener("change", ({ target }) => onRobot(Number(target.value)));
    this.list = "";
  }

  /** report: from situation(); pose_ms: age of the newest pose on the screen; live: poses come. */
  update({ report, session, robot, pose_ms, live }) {
    setAttribute(byId("state"), "data-level", report.level);
    setText(byId("state-text"), report.title);
    this.#notice(report, robot);
    this.#robots(session, robot);
    setText(byId("age"), live ? ms(pose_ms) : "–");
    setAttribute(byId("age"), "data-level", report.level === "wait" || !(pose_ms > kGoodAge_ms) ? "ok" : pose_ms > kBadAge_ms ? "bad" : "warn");
    setText(byId("keyframes"), count(robot?.tracking?.keyframes ?? robot?.count("posedCount")));
    setText(byId("landmarks"), count(robot?.tracking?.landmarks ?? robot?.count("pointTotal")));
    setText(byId("inliers"), count(robot?.tracking?.inliers));
    const error = robot?.truthError;
    byId("truth-fact").hidden = !error;
    if (error) setText(byId("truth"), length(error.ate_m));
    const title = `${report.title} – RTD-SLAM`;
    if (document.title !== title) document.title = title;
  }

  /** In the middle while there is nothing to see, above the map afterwards; none while all is well. */
  #notice({ level, title, detail, quiet }, robot) {
    const notice = byId("notice"), empty = !robot || robot.count("posedCount") === 0;
    notice.hidden = (level === "ok" || quiet) && !empty;
    setAttribute(notice, "data-level", level);
    setAttribute(notice, "class", empty ? "notice card" : "notice banner");
    setText(byId("notice-title"), level === "ok" ? "Waiting for the map" : title);
    setText(byId("notice-detail"), level === "ok" ? "Poses arrive; the first keyframe has not come yet." : detail);
  }

  #robots(session, robot) {
    const select = byId("robot"), robots = session.byName;
    const list = JSON.stringify(robots.map(({ index, name }) => [index, name]));
    if (list !== this.list) {
      this.list = list;
      select.replaceChildren(...robots.map(({ index, title }) => el("option", { value: index }, title)));
      byId("robot-label").hidden = robots.length < 2 && (robots[0]?.name ?? "") === "";
    }
    if (robot && select.value !== String(robot.index)) select.value = robot.index;
  }
}
