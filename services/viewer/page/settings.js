// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What the user chose, kept in the browser: theme, text size, layers, open panels.

const kKey = "rtd.viewer";

export const kLayers = {
  dense: "Room", moving: "What moved", plan: "Floor plan", points: "Landmarks", keyframes: "Keyframes", edges: "Edges",
  trajectory: "Trajectory", movers: "Moving objects", truth: "Ground truth", grid: "Grid",
};

const kDefaults = {
  themeChoice: "auto", large: false, coloring: "height", pathColoring: "one colour",
  layers: { dense: true, moving: false, plan: false, points: true, keyframes: true, edges: false, trajectory: true, movers: true,
            truth: true, grid: true },
  overlays: { features: true, boxes: true, people: true, mask: true, depth: false },
  closedPanels: [], tab: "image",
};

export class Settings {
  constructor() {
    const kept = load();
    Object.assign(this, kDefaults, kept);
    this.layers = { ...kDefaults.layers, ...kept.layers };
    this.overlays = { ...kDefaults.overlays, ...kept.overlays };
    this.hiddenMaps = new Set();   // keys of maps; not kept: the next session has other robots
    this.prefersLight = matchMedia("(prefers-color-scheme: light)");
  }

  get theme() {
    return this.themeChoice === "auto" ? (this.prefersLight.matches ? "light" : "dark") : this.themeChoice;
  }

  save() {
    const { themeChoice, large, coloring, pathColoring, layers, overlays, closedPanels, tab } = this;
    try {
      localStorage.setItem(kKey, JSON.stringify({ themeChoice, large, coloring, pathColoring, layers, overlays, closedPanels, tab }));
    } catch {
      // Private windows keep nothing; the choice then lasts as long as the page.
    }
  }
}

function load() {
  try {
    return JSON.parse(localStorage.getItem(kKey)) ?? {};
  } catch {
    return {};
  }
}
