// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// A label in the scene that always faces the viewer and is as large on the screen wherever it is.

import * as THREE from "/three/build/three.module.js";
import { stackLevels } from "./geometry.js";

const kHeight_px = 20;           // on the screen
const kDetail = 2;               // pixels of the texture for one of the screen
const kBottom = -0.2;            // a label's lower edge is so many of its heights over its position
const kKept = 40;
const textures = new Map();   // text and colours -> {texture, aspect}; moving objects keep their labels for long

/** color: THREE.Color; look: see look.js. Stands above its position. */
export function textSprite(text, color, look) {
  const { texture, aspect } = textureOf(text, color.getStyle(), look.background.getStyle());
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: texture, depthTest: false, sizeAttenuation: false }));
  const height = kHeight_px * look.textScale * look.unitsPerPixel;
  sprite.scale.set(height * aspect, height, 1);
  sprite.center.set(0.5, kBottom);
  sprite.renderOrder = 1;
  return sprite;
}

/** Texts that would cover each other are set above each other, the nearest lowest. */
export function spreadLabels(sprites, camera) {
  const halfHeight = Math.tan(camera.fov * Math.PI / 360), spot = new THREE.Vector3();   // of the picture, at distance 1
  const seen = sprites.map((sprite) => {
    const { x, y, z } = sprite.getWorldPosition(spot).project(camera);
    return { sprite, z, x: x * camera.aspect * halfHeight, y: y * halfHeight, width: sprite.scale.x, height: sprite.scale.y };
  }).sort((a, b) => a.z - b.z);
  stackLevels(seen).forEach((level, i) => seen[i].sprite.center.set(0.5, kBottom - level));
}

function textureOf(text, style, background) {
  const key = `${text} ${style} ${background}`;
  if (!textures.has(key)) {
    if (textures.size >= kKept) forgetOldest();
    textures.set(key, draw(text, style, background));
  }
  return textures.get(key);
}

function forgetOldest() {
  const [key, { texture }] = textures.entries().next().value;
  texture.dispose();
  textures.delete(key);
}

/** On a plate in the colour of the background: points behind it would make it hard to read. */
function draw(text, style, background) {
  const canvas = document.createElement("canvas"), height = kDetail * kHeight_px, font = `600 ${0.66 * height}px system-ui, sans-serif`;
  let context = canvas.getContext("2d");
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 0.6 * height;
  canvas.height = height;
  context = canvas.getContext("2d");
  context.globalAlpha = 0.78;
  context.fillStyle = background;
  context.fillRect(0, 0, canvas.width, height);
  context.globalAlpha = 1;
  context.font = font;
  context.textBaseline = "middle";
  context.fillStyle = style;
  context.fillText(text, 0.3 * height, 0.53 * height);
  const texture = new THREE.CanvasTexture(canvas);
  texture.minFilter = THREE.LinearFilter;
  return { texture, aspect: canvas.width / height };
}
