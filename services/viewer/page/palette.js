// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Colours of the scene and of the plots. Kept and removed features look the same in both themes, as in our reports.

export const kKept = "#22c55e";
export const kRemoved = "#ef4444";
/** Landmarks that contradict a pose: by the motion that they follow, the last of those that follow none. */
export const kContradicting = ["#e879f9", "#22d3ee", "#fde047", "#fb923c"];

const kDark = {
  background: "#0d1117", grid: "#1e2630", points: "#9fb3c8", keyframe: "#4f9cf9", covisibility: "#35608f",
  loop: "#f2b84b", trajectory: "#e6edf3", truth: "#b48ef7", moving: "#ff6b6b", camera: "#3fd07f", cameraLost: "#ff6b6b",
  ramp: ["#3b4cc0", "#2a9d9c", "#63c77c", "#e3d04f", "#f58a3c"],
};
const kLight = {
  background: "#f7f9fb", grid: "#dfe5ec", points: "#4a5b6e", keyframe: "#1f6fd1", covisibility: "#9cbce0",
  loop: "#c27c00", trajectory: "#1a2029", truth: "#7c4dcc", moving: "#d42c33", camera: "#0c8f4d", cameraLost: "#d42c33",
  ramp: ["#35409e", "#17807f", "#2f8f47", "#a88a00", "#c95a12"],
};

export const scenePalette = (theme) => (theme === "light" ? kLight : kDark);

/** Distinct in both themes and for colour-blind readers as far as twelve can be. */
export const kSeriesColors = ["#4f9cf9", "#f2994a", "#27ae60", "#eb5fa0", "#9b6df2", "#2bb7c4", "#c9a227", "#e2574c",
                              "#7a8ca3", "#58a55c", "#b5651d", "#5b6ee1"];
