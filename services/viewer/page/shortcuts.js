// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The keyboard: one letter, one action. Listed in the help dialog from the same table.

import { byId, el } from "./dom.js";

const kTyping = "input[type=text], select, textarea, dialog[open] *";

/** actions: name -> function; see kKeys. */
export function bindShortcuts(actions) {
  byId("keys").append(...kKeys.map(([keys, , text]) =>
    el("div", {}, el("dt", {}, ...keys.map((key) => el("kbd", {}, kNames[key] ?? key.toUpperCase()))), el("dd", {}, text))));
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.matches(kTyping)) return;
    const onMap = event.target.closest?.("#map canvas"), onWidget = event.target.matches("button, input, summary");
    const found = kKeys.find(([keys]) => keys.includes(event.key));
    if (!found || (kOnlyOnMap.includes(found[1]) && !onMap) || (event.key === " " && onWidget)) return;
    event.preventDefault();
    actions[found[1]](event.key);
  });
}

const kOnlyOnMap = ["move"];
const kNames = { " ": "space", ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓" };
const kKeys = [
  [["1"], "follow", "View from behind the camera (follow)"],
  [["2"], "above", "View from above"],
  [["3"], "free", "Free view"],
  [["f"], "fit", "Show everything"],
  [["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"], "move", "Move the view (when the map has the focus)"],
  [["+", "-"], "zoom", "Zoom"],
  [["c"], "coloring", "Next colouring of the points"],
  [[" "], "pause", "Pause or continue a replay"],
  [["."], "step", "One frame of a paused replay"],
  [["s"], "save", "Save the map"],
  [["r"], "reset", "Reset the map (asks first)"],
  [["n"], "robot", "Next robot"],
  [["h"], "share", "Share what is shown: a link, a file"],
  [["l"], "large", "Large text, for a projector"],
  [["t"], "theme", "Theme: as the system, light, dark"],
  [["?"], "help", "This list"],
];
