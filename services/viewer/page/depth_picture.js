// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The depth of the camera as colours, next to its image.

import { toBitmap } from "./decode.js";
import { byId } from "./dom.js";

export class DepthPicture {
  constructor() {
    this.canvas = byId("depth");
    this.context = this.canvas.getContext("2d", { willReadFrequently: true });   // drawn by the processor
  }

  /** message: of the depth, or null; shown: the switch is on. */
  async update(message, shown) {
    byId("depth-figure").hidden = !shown;
    byId("depth-none").hidden = Boolean(message);
    this.canvas.hidden = !message;
    if (!shown || !message || message === this.drawn || this.decoding) return;
    this.decoding = true;
    try {
      const bitmap = await toBitmap(message);
      this.canvas.width = bitmap.width;
      this.canvas.height = bitmap.height;
      this.context.drawImage(bitmap, 0, 0);
      bitmap.close();
    } catch {
      this.canvas.hidden = true;   // damaged: the next one comes
    }
    this.decoding = false;
    this.drawn = message;
  }
}
