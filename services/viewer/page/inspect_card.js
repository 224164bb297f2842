// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// A click on the map asks what is there; with Shift, how far it is from what was asked before.

import { byId, el, setText } from "./dom.js";
import { length } from "./format.js";
import { showMoment } from "./history_bar.js";
import { apart_m, describe, nearest, things } from "./inspect.js";
import { answerRows, questionAbout } from "./questions.js";

const kStill_px = 4;   // a pointer that moves further turns the view
const kImages = 3;

/** seen: [{moment, x, y}]; x, y: where to put a ring, as shares of the image. */
function showImages(seen) {
  byId("inspect-images").replaceChildren(...seen.map(({ moment, x, y }) => {
    const figure = el("figure", {});
    showMoment(figure, moment);
    if (x !== undefined) figure.querySelector(".shot").append(el("i", { class: "ring", style: `left: ${100 * x}%; top: ${100 * y}%` }));
    return figure;
  }));
}

export class InspectCard {
  constructor(app) {
    this.app = app;
    byId("inspect-close").addEventListener("click", () => this.close());
  }

  /** scene: its canvas takes the clicks. */
  bind(scene) {
    this.scene = scene;
    const { canvas } = scene;
    canvas.addEventListener("pointerdown", ({ clientX, clientY }) => { this.down = [clientX, clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      const moved = this.down && Math.hypot(event.clientX - this.down[0], event.clientY - this.down[1]);
      if (event.button === 0 && moved < kStill_px) this.ask(event.offsetX, event.offsetY, event.shiftKey);
    });
  }

  /** x, y: px in the map. measure: from what was asked before. */
  ask(x, y, measure) {
    const { robot, settings } = this.app, map = robot?.maps.get(robot.tracking?.map ?? 0);
    if (!map) return;
    const project = this.scene.projector(robot.index, map.id);
    const found = nearest(things(map, robot.movers, settings.layers), { x, y }, project);
    if (!found) {
      if (!measure) this.close();
      return;
    }
    const from = measure ? this.asked : null;
    this.asked = found;
    this.scene.mark(robot.index, map.id, from ? [from.point, found.point] : [found.point]);
    this.#show(found, from, robot, map);
  }

  close() {
    byId("inspect").hidden = true;
    this.asked = null;
    this.scene?.mark();
  }

  #show(found, from, robot, map) {
    const { title, rows } = describe(found, robot.tracking);
    if (from) rows.unshift([`From ${describe(from, null).title}`, length(apart_m(from.point, found.point))]);
    byId("inspect").hidden = false;
    setText(byId("inspect-title"), title);
    byId("inspect-rows").replaceChildren(...rows.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
    const moments = robot.history.towards(found.point, map.id, kImages);
    showImages(moments.map((moment) => ({ moment })));
    setText(byId("inspect-note"), moments.length > 0 ? "Images of the last minutes that look towards it" : "Shift and a click on another thing measures between both.");
    this.#askMore(found, robot, map);
  }

  /** What slam knows of it, when the answer comes. */
  async #askMore(found, robot, map) {
    const question = questionAbout(found), answer = question && await this.app.questions.ask(robot, question);
    if (!answer || this.asked !== found) return;
    byId("inspect-rows").append(...answerRows(answer, robot.tracking?.stamp_s).flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
    const landmark = found.kind === "landmark", taken = landmark ? undefined : robot.history.near(answer.seen_s[0], map.id);
    const seen = landmark ? robot.history.showing(answer.seen_s, found.point, map.id, answer.camera, kImages) : taken ? [{ moment: taken }] : [];
    if (seen.length === 0) return;
    showImages(seen);
    setText(byId("inspect-note"), landmark ? "Images of the last minutes in which it was seen" : "Image of when it was taken");
  }
}
