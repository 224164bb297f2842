// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// A label in the scene that always faces the viewer.

import * as THREE from "/three/build/three.module.js";

const kHeight_px = 48;
const kHeight_m = 0.14;
const kKept = 40;
const textures = new Map();   // text and colour -> {texture, width_px}; movers keep their labels for long

export function textSprite(text, color, scale) {
  const { texture, width_px } = textureOf(text, color.getStyle());
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: texture, depthTest: false }));
  sprite.scale.set(scale.value * kHeight_m * width_px / kHeight_px, scale.value * kHeight_m, 1);
  return sprite;
}

function textureOf(text, style) {
  const key = text + style;
  if (!textures.has(key)) {
    if (textures.size >= kKept) forgetOldest();
    textures.set(key, draw(text, style));
  }
  return textures.get(key);
}

function forgetOldest() {
  const [key, { texture }] = textures.entries().next().value;
  texture.dispose();
  textures.delete(key);
}

function draw(text, style) {
  const canvas = document.createElement("canvas"), font = `600 ${0.7 * kHeight_px}px system-ui, sans-serif`;
  let context = canvas.getContext("2d");
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 8;
  canvas.height = kHeight_px;
  context = canvas.getContext("2d");
  context.font = font;
  context.textBaseline = "middle";
  context.fillStyle = style;
  context.fillText(text, 4, kHeight_px / 2);
  const texture = new THREE.CanvasTexture(canvas);
  texture.minFilter = THREE.LinearFilter;
  return { texture, width_px: canvas.width };
}
