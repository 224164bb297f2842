// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The image of the synthetic camera, with the overlays that the filter would send. Cheap and recognisable, not rendered.

import { flatJpeg } from "./jpeg.mjs";
import { randomNumbers } from "./room.mjs";

export const kWidth = 640, kHeight = 480;
const kBlock = 8, kMaskStep = 8;

const kScenery = (() => {
  const random = randomNumbers(11);
  return Array.from({ length: 14 }, () => ({
    x: 90 * random(), y: 14 + 26 * random(), w: 4 + 8 * random(), h: 5 + 12 * random(),
    color: [60 + 150 * random(), 60 + 120 * random(), 50 + 120 * random()],
  }));
})();

/** Where the person is in the image, px. */
function personBox(time_s) {
  return { label: "person", score: 0.93, x: 250 + 170 * Math.sin(0.5 * time_s), y: 90, w: 120, h: 340 };
}

const inside = ({ x, y, w, h }, u, v) => u >= x && u < x + w && v >= y && v < y + h;

export function cameraView(time_s) {
  const box = personBox(time_s), shift = 8 * Math.sin(0.2 * time_s);
  const color = (column, row) => {
    const u = column * kBlock, v = row * kBlock;
    if (inside(box, u, v)) return v < box.y + 70 ? [214, 170, 140] : v < box.y + 210 ? [70, 90, 150] : [45, 48, 60];
    const thing = kScenery.find((one) => inside({ ...one, x: one.x - shift }, column, row));
    if (thing) return thing.color;
    const light = 150 - 0.9 * row + 0.3 * column;
    return row > 44 ? [118 - row, 92 - row / 2, 70] : [light, light - 4, light - 14];
  };
  const depthColor = (column, row) => (inside(box, column * 2 * kBlock, row * 2 * kBlock) ? [250, 200, 0] : row < 4 ? [0, 0, 0] : [0, 120 + 2 * column, 255]);
  return { jpeg: flatJpeg(kWidth / kBlock, kHeight / kBlock, color), depth: flatJpeg(kWidth / 2 / kBlock, kHeight / 2 / kBlock, depthColor), box, features: featuresOf(box, shift), mask: maskOf(box), people: labelsOf(box) };
}

function featuresOf(box, shift) {
  const random = randomNumbers(5);
  return Array.from({ length: 700 }, () => {
    const thing = kScenery[Math.floor(random() * kScenery.length)];
    const u = Math.min(kWidth - 1, Math.max(0, kBlock * (thing.x - shift + thing.w * random())));
    return { u, v: kBlock * (thing.y + thing.h * random()) };
  }).concat(Array.from({ length: 160 }, () => ({ u: box.x + box.w * random(), v: box.y + box.h * random() })))
    .map((feature) => ({ ...feature, removed: inside(box, feature.u, feature.v) && random() < 0.95 }));
}

function maskOf(box) {
  const width = kWidth / kMaskStep, height = kHeight / kMaskStep, values = new Uint8Array(width * height);
  const wide = { x: box.x - 16, y: box.y - 16, w: box.w + 32, h: box.h + 32 };
  values.forEach((_, i) => {
    const u = (i % width) * kMaskStep, v = Math.floor(i / width) * kMaskStep;
    values[i] = inside(box, u, v) ? 255 : inside(wide, u, v) ? 128 : 0;
  });
  return { width, height, values };
}

/** Label 1 on the upper half of the person. */
function labelsOf(box) {
  const width = kWidth / kMaskStep, body = { ...box, x: box.x + 16, w: box.w - 32, h: box.h / 2 };
  return Uint8Array.from({ length: (width * kHeight) / kMaskStep },
    (_, i) => (inside(body, (i % width) * kMaskStep, Math.floor(i / width) * kMaskStep) ? 1 : 0));
}
