// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The floor plan as a picture that lies on the floor.

import * as THREE from "/three/build/three.module.js";
import { expandMask } from "./decode.js";

const kColors = { 0: [120, 170, 220, 90], 100: [230, 90, 70, 200], 255: [0, 0, 0, 0] };

/** plan: a message of decode(). */
export function planMesh(plan) {
  const { cell_m, width, height, t, q } = plan, pixels = new Uint8Array(4 * width * height);
  expandMask(plan).forEach((cell, i) => pixels.set(kColors[cell] ?? kColors[100], 4 * i));
  const texture = new THREE.DataTexture(pixels, width, height, THREE.RGBAFormat);
  texture.needsUpdate = true;
  const material = new THREE.MeshBasicMaterial({ map: texture, transparent: true, side: THREE.DoubleSide, depthWrite: false });
  const geometry = new THREE.PlaneBufferGeometry(cell_m * width, cell_m * height);
  geometry.translate(cell_m * width / 2, cell_m * height / 2, 0);
  const mesh = new THREE.Mesh(geometry, material);
  mesh.position.set(...t);
  mesh.quaternion.set(...q);
  return mesh;
}
