// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The dialog that passes on what is shown: a link, or a file.

import { byId, setText } from "./dom.js";
import { addressToLook, aroundTarget, fileOf, hashOf, inMap, sceneOf } from "./share.js";

export class ShareDialog {
  constructor(app) {
    this.app = app;
    byId("share-open").addEventListener("click", () => this.open());
    byId("share-control").addEventListener("change", () => this.#showLink());
    byId("share-copy").addEventListener("click", () => this.#copy());
    byId("share-save").addEventListener("click", () => this.#save());
  }

  open() {
    byId("share-control").checked = false;
    byId("share-control").parentElement.hidden = !this.app.session.hello?.control;
    this.#showLink();
    byId("share").showModal();
  }

  #showLink() {
    byId("share-link").value = this.link();
    setText(byId("share-answer"), "");
  }

  /** The page's address with what is shown; it allows no commands unless that is wanted. */
  link() {
    const { scene, settings, robot } = this.app;
    const view = scene?.view() ?? { mode: "follow", eye: [0, 0, 0], target: [0, 0, 0] };
    const hash = hashOf({ layers: settings.layers, view, robot: robot?.name, at_s: robot?.playback?.position_s });
    const address = byId("share-control").checked ? location.href : addressToLook(location.href, this.app.session.hello?.look_token);
    return `${address.replace(/#.*/, "")}#${hash}`;
  }

  async #copy() {
    const field = byId("share-link");
    field.select();
    try {
      await navigator.clipboard.writeText(field.value);
      setText(byId("share-answer"), "The link is in the clipboard.");
    } catch {
      setText(byId("share-answer"), "This browser does not let the page copy: the link is selected, press Ctrl+C.");
    }
  }

  async #save() {
    const template = await (await fetch("map_page.html")).text(), file = fileOf(template, this.scene());
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([file], { type: "text/html" }));
    link.download = `map-${new Date().toISOString().slice(0, 19).replaceAll(":", "-")}.html`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
    setText(byId("share-answer"), `${link.download}: ${(file.length / 1e6).toFixed(1)} MB, opens in any browser without a network.`);
  }

  /** Of the robot and map that the view follows. */
  scene() {
    const { robot, settings, scene } = this.app, { zUp, tracking, truthError } = robot, map = robot.map(tracking?.map ?? 0);
    const seen = scene?.view(), shift = scene?.originOf(robot.index, map.id) ?? [0, 0, 0];
    const place = (point) => inMap(point.map((value, axis) => value - shift[axis]), zUp);
    const facts = [["Keyframes", String(map.posedCount)], ["Landmarks", String(map.pointTotal)]];
    if (truthError) facts.push(["ATE", `${(100 * truthError.ate_m).toFixed(1)} cm`]);
    return sceneOf(map, { title: robot.title, zUp, layers: settings.layers, facts,
                          view: seen ? aroundTarget(place(seen.eye), place(seen.target), zUp) : undefined });
  }
}
