// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What the map shows: kinds of things, colours of the points, robots and their maps.

import { byId, el, setText } from "./dom.js";
import { count } from "./format.js";
import { kPathColorings, pathLegend } from "./path_colors.js";
import { scenePalette } from "./palette.js";
import { kLayers } from "./settings.js";

const kColorings = ["height", "static probability", "one colour"];
const kColors = { keyframes: "keyframe", edges: "covisibility", trajectory: "trajectory", movers: "moving", truth: "truth" };

export class LayersPanel {
  /** onChange: a setting of the scene is another one now. */
  constructor(settings, onChange) {
    this.settings = settings;
    this.onChange = onChange;
    byId("layers").append(...Object.entries(kLayers).map(([name, title]) => this.#kind(name, title)));
    const select = byId("coloring");
    select.append(...kColorings.map((name) => el("option", { value: name }, name)));
    select.value = settings.coloring;
    select.addEventListener("change", () => this.#color(select.value));
    const path = byId("path-coloring");
    path.append(...kPathColorings.map((name) => el("option", { value: name }, name)));
    path.value = settings.pathColoring;
    path.addEventListener("change", () => {
      settings.pathColoring = path.value;
      this.#changed();
    });
    this.shown = "";
    this.applyTheme();
  }

  /** The colours that things have on the map. */
  applyTheme() {
    const palette = scenePalette(this.settings.theme);
    for (const [layer, color] of Object.entries(kColors)) {
      byId(`layer-${layer}`).parentElement.querySelector(".mark").style.background = palette[color];
    }
  }

  nextColoring() {
    const at = kColorings.indexOf(this.settings.coloring);
    this.#color(kColorings[(at + 1) % kColorings.length]);
  }

  /** The list of robots and maps, if there is more than one map in all. */
  update(session, robot) {
    const map = robot?.maps.get(robot.tracking?.map ?? 0);
    setText(byId("path-legend"), map ? pathLegend(map, this.settings.pathColoring) : "");
    const rows = session.byName.flatMap((robot) => [...robot.maps.values()].map((map) => ({ robot, map })));
    byId("maps-row").hidden = rows.length < 2;
    const key = JSON.stringify(rows.map(({ robot, map }) => [robot.index, robot.name, map.id, map.posedCount]));
    if (key === this.shown || rows.length < 2) return;
    this.shown = key;
    const hadFocus = document.activeElement?.dataset?.map;
    byId("maps").replaceChildren(...rows.map(({ robot, map }) => this.#map(robot, map)));
    if (hadFocus) byId("maps").querySelector(`[data-map="${hadFocus}"]`)?.focus();
  }

  #color(name) {
    byId("coloring").value = this.settings.coloring = name;
    this.#changed();
  }

  #kind(name, title) {
    const label = this.#check(title, this.settings.layers[name], (checked) => { this.settings.layers[name] = checked; }, `layer-${name}`);
    if (kColors[name]) label.append(el("i", { class: "mark" }));
    return label;
  }

  #map(robot, map) {
    const key = robot.mapKey(map.id), { hiddenMaps } = this.settings;
    const label = this.#check(`${robot.title}, map ${map.id} (${count(map.posedCount)} keyframes)`, !hiddenMaps.has(key),
                              (checked) => (checked ? hiddenMaps.delete(key) : hiddenMaps.add(key)), `map-${key}`);
    label.firstChild.dataset.map = key;
    return label;
  }

  #check(title, checked, set, id) {
    const box = el("input", { type: "checkbox", id });
    box.checked = checked;
    box.addEventListener("change", () => {
      set(box.checked);
      this.#changed();
    });
    return el("label", { class: "check" }, box, title);
  }

  #changed() {
    this.settings.save();
    this.onChange();
  }
}
