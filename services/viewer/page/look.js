// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Colours and sizes that everything in the scene shares: a change of theme or text size changes them here, once.

import * as THREE from "/three/build/three.module.js";
import { scenePalette } from "./palette.js";

export const kColorings = { height: 0, "static probability": 1, "one colour": 2 };

export class Look {
  constructor() {
    const color = () => ({ value: new THREE.Color() });
    this.points = { size: { value: 2 }, coloring: { value: 0 }, plainColor: color(), movingColor: color(),
                    ramp: { value: Array.from({ length: 5 }, () => new THREE.Color()) } };
    this.keyframe = color();
    this.covisibility = color();
    this.loop = color();
    this.trajectory = color();
    this.markMaterial = new THREE.LineBasicMaterial({ color: "#ffffff", depthTest: false });
    this.markPointMaterial = new THREE.PointsMaterial({ color: "#ffffff", size: 12, sizeAttenuation: false, depthTest: false });
    this.pathColored = { value: false };
    this.pathColoring = "one colour";
    this.share = 1;   // of the points, see detail.js
    this.textScale = 1;
    this.unitsPerPixel = 0.003;   // of a sprite that is as large at any distance
    this.background = new THREE.Color();
    this.grid = new THREE.Color();
    this.truthMaterial = new THREE.LineBasicMaterial();
    this.cameraMaterial = new THREE.LineBasicMaterial();
    this.lostMaterial = new THREE.LineBasicMaterial();
    this.moverMaterial = new THREE.LineBasicMaterial();
    this.denseMaterial = new THREE.PointsMaterial({ size: 2, sizeAttenuation: false, vertexColors: THREE.VertexColors });
    this.movingMaterial = new THREE.PointsMaterial({ size: 2, sizeAttenuation: false, transparent: true, opacity: 0.35 });
  }

  /** settings: {theme: light | dark, large, coloring, pathColoring}. view: {pixelRatio, height_px, fov_deg} of the canvas. */
  apply({ theme, large, coloring, pathColoring }, { pixelRatio, height_px, fov_deg }) {
    const palette = scenePalette(theme);
    this.background.set(palette.background);
    this.grid.set(palette.grid);
    this.points.plainColor.value.set(palette.points);
    this.points.movingColor.value.set(palette.moving);
    this.points.ramp.value.forEach((color, i) => color.set(palette.ramp[i]));
    for (const name of ["keyframe", "covisibility", "loop", "trajectory"]) this[name].value.set(palette[name]);
    this.truthMaterial.color.set(palette.truth);
    this.cameraMaterial.color.set(palette.camera);
    this.lostMaterial.color.set(palette.cameraLost);
    this.moverMaterial.color.set(palette.moving);
    for (const material of [this.markMaterial, this.markPointMaterial]) material.color.set(palette.trajectory);
    this.points.coloring.value = kColorings[coloring] ?? 0;
    this.pathColoring = pathColoring;
    this.pathColored.value = pathColoring !== "one colour";
    this.points.size.value = (large ? 3.5 : 2) * pixelRatio;
    this.denseMaterial.size = this.movingMaterial.size = this.points.size.value;
    this.movingMaterial.color.set(palette.points);
    this.textScale = large ? 1.3 : 1;
    this.unitsPerPixel = 2 * Math.tan(fov_deg * Math.PI / 360) / Math.max(1, height_px);
  }
}
