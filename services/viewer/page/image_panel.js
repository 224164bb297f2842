// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The newest image of the camera with what the filter says about it: features, boxes, person masks,
// dynamic mask.

import { byId, setText } from "./dom.js";
import { expandMask, toBitmap } from "./decode.js";
import { DepthPicture } from "./depth_picture.js";
import { count } from "./format.js";
import { stackLevels } from "./geometry.js";
import { kContradicting, kKept, kRemoved } from "./palette.js";

const kMoving = [239, 68, 68, 105], kUnknown = [245, 158, 11, 60];
const kPeople = [[56, 189, 248, 120], [192, 132, 252, 120], [74, 222, 128, 120], [251, 146, 60, 120], [244, 114, 182, 120]];
const kColorOf = {
  mask: (value) => (value === 255 ? kMoving : kUnknown),
  people: (label) => kPeople[(label - 1) % kPeople.length],
};
const kFeatureRadius_px = 1.7;   // on the screen
const kFont_px = 12, kLarge = 1.4;

export class ImagePanel {
  /** onDrawn(bitmap): an image is shown; onSwitch(): something else is wanted; pause_ms(): least time between two images. */
  constructor(settings, { onDrawn, onSwitch, pause_ms }) {
    Object.assign(this, { settings, onDrawn, onSwitch, pause_ms });
    this.depth = new DepthPicture();
    this.canvas = byId("image");
    this.context = this.canvas.getContext("2d", { willReadFrequently: true });   // drawn by the processor
    this.legend = { kept: byId("kept"), removed: byId("removed"), boxes: byId("boxes") };
    this.masks = { mask: { canvas: document.createElement("canvas") }, people: { canvas: document.createElement("canvas") } };
    for (const name of Object.keys(settings.overlays)) this.#bindSwitch(name);
  }

  /** robot: or undefined; ended: its source has. Draws with the next frame of the screen. */
  update(robot, ended = this.ended) {
    this.robot = robot;
    this.ended = ended;
    if (this.requested) return;
    this.requested = true;
    const show = () => requestAnimationFrame((now_ms) => {
      this.requested = false;
      this.shown_ms = now_ms;
      this.#show();
    });
    const wait_ms = (this.shown_ms ?? -Infinity) + this.pause_ms() - performance.now();
    if (wait_ms > 0) setTimeout(show, wait_ms);
    else show();
  }

  /** Shows a moment of the history, without overlays; null: what comes. */
  freeze(moment) {
    this.frozen = moment;
    this.update(this.robot);
  }

  get #image() {
    return this.frozen ? this.frozen.image : this.robot?.image;
  }

  #bindSwitch(name) {
    const box = byId(`overlay-${name}`);
    box.checked = this.settings.overlays[name];
    box.addEventListener("change", () => {
      this.settings.overlays[name] = box.checked;
      this.settings.save();
      this.onSwitch();
      this.#show();
    });
  }

  #show() {
    this.depth.update(this.frozen ? null : this.robot?.overlay("depth"), this.settings.overlays.depth);
    const image = this.#image;
    if (!image) {
      this.decoded = null;
      this.bitmap = null;
      this.#reveal();
      this.#describe();
    } else if (image === this.decoded) {
      this.#draw();
    } else if (!this.decoding) {
      this.#decode(image);
    }
  }

  #reveal() {
    this.canvas.hidden = !this.bitmap;
    byId("image-none").hidden = !this.canvas.hidden;
    setText(byId("image-none"), this.ended ? "The source has ended, and no image was kept: this page was not open when images came."
                                           : "No image yet. It appears with the first frame of the camera.");
  }

  /** One at a time: while an image is decoded the next ones wait, and only the newest of them is shown. */
  async #decode(image) {
    this.decoding = true;
    try {
      const bitmap = await toBitmap(image);
      this.bitmap?.close();
      this.bitmap = bitmap;
      this.error = "";
    } catch {
      this.error = "this image could not be decoded";
    }
    this.decoding = false;
    this.decoded = image;
    if (this.#image === image) this.#draw();
    else this.update(this.robot);
  }

  #draw() {
    const image = this.#image;
    if (!image || !this.bitmap) return;
    this.#reveal();
    if (this.canvas.width !== image.width || this.canvas.height !== image.height) {
      this.canvas.width = image.width;
      this.canvas.height = image.height;
    }
    this.scale = image.width / (this.canvas.clientWidth || image.width);   // image pixels per pixel of the screen
    this.context.drawImage(this.bitmap, 0, 0, image.width, image.height);
    this.onDrawn(this.bitmap);
    if (this.frozen) {
      this.#describe();
      return;
    }
    const { overlays } = this.settings;
    if (overlays.people) this.#drawMask("people");
    if (overlays.mask) this.#drawMask("mask");
    if (overlays.features) this.#drawFeatures(this.robot.overlay("features"));
    if (overlays.boxes) this.#drawBoxes(this.robot.overlay("boxes"));
    if (overlays.features && this.robot.doubts) this.#drawDoubt(this.robot.overlay("doubt"));
    this.#describe();
  }

  /** name: of the overlay, "mask" or "people". */
  #drawMask(name) {
    const overlay = this.robot.overlay(name), drawn = this.masks[name];
    if (!overlay || overlay.width * overlay.height === 0) return;
    if (overlay !== drawn.overlay) this.#paintMask(drawn, overlay, kColorOf[name]);
    this.context.imageSmoothingEnabled = false;
    this.context.drawImage(drawn.canvas, 0, 0, this.canvas.width, this.canvas.height);
    this.context.imageSmoothingEnabled = true;
  }

  #paintMask(drawn, overlay, colorOf) {
    const { canvas } = drawn, { width, height } = overlay;
    drawn.overlay = overlay;
    canvas.width = width;
    canvas.height = height;
    const context = canvas.getContext("2d", { willReadFrequently: true }), pixels = context.createImageData(width, height);
    expandMask(overlay).forEach((value, i) => {
      if (value > 0) pixels.data.set(colorOf(value), 4 * i);
    });
    context.putImageData(pixels, 0, 0);
  }

  #drawFeatures(features) {
    if (!features) return;
    const { context } = this, toX = this.canvas.width / features.width, toY = this.canvas.height / features.height;
    const radius = kFeatureRadius_px * this.scale;
    for (const flag of [0, 1]) {
      context.fillStyle = flag ? kRemoved : kKept;
      for (let i = 0; i < features.count; ++i) {
        if (features.removed[i] !== flag) continue;
        context.fillRect(features.us[i] * toX - radius, features.vs[i] * toY - radius, 2 * radius, 2 * radius);
      }
    }
  }

  /** A line from where the pose shows a landmark to where it is. */
  #drawDoubt(doubt) {
    const { context } = this, radius = 1.5 * kFeatureRadius_px * this.scale;
    context.lineWidth = 1.5 * this.scale;
    for (const [u, v, expectedU, expectedV, motion] of doubt?.landmarks ?? []) {
      context.strokeStyle = context.fillStyle = kContradicting.at(motion);
      context.beginPath();
      context.moveTo(expectedU, expectedV);
      context.lineTo(u, v);
      context.stroke();
      context.fillRect(u - radius, v - radius, 2 * radius, 2 * radius);
    }
  }

  #drawBoxes(overlay) {
    if (!overlay) return;
    const { context } = this, size = kFont_px * this.scale * (this.settings.large ? kLarge : 1), height = 1.4 * size;
    context.lineWidth = 1.5 * this.scale;
    context.font = `600 ${size}px system-ui, sans-serif`;
    context.textBaseline = "top";
    context.strokeStyle = "#fbbf24";
    const labels = overlay.boxes.map(({ label, score, x, y, w, h }) => {
      context.strokeRect(x, y, w, h);
      const text = `${label} ${Math.round(100 * score)} %`, width = context.measureText(text).width + 0.8 * size;
      return { text, x: x + width / 2, y: Math.max(0, y - height), width, height };
    });
    const levels = stackLevels(labels);
    labels.forEach(({ text, x, y, width }, i) => {
      const left = x - width / 2, top = y + levels[i] * height;
      context.fillStyle = "rgba(20, 16, 4, 0.75)";
      context.fillRect(left, top, width, height);
      context.fillStyle = "#fde68a";
      context.fillText(text, left + 0.4 * size, top + 0.2 * size);
    });
  }

  #describe() {
    const shown = this.frozen ? undefined : this.robot, features = shown?.overlay("features"), boxes = shown?.overlay("boxes");
    const removed = features ? features.removed.reduce((sum, flag) => sum + flag, 0) : NaN;
    const doubt = shown?.doubts ? shown.overlay("doubt") : null;
    byId("doubt-key").hidden = !doubt;
    setText(byId("disagree"), count(doubt?.disagree));
    setText(this.legend.kept, count(features ? features.count - removed : NaN));
    setText(this.legend.removed, count(removed));
    setText(this.legend.boxes, count(boxes ? boxes.boxes.length : NaN));
    setText(byId("image-error"), this.error ?? "");
  }
}
