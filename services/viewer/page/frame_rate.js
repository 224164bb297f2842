// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// How often the scene was drawn in the last two seconds.

const kWindow_ms = 2000;

export class FrameRate {
  constructor() {
    this.times_ms = [];
  }

  count(now_ms) {
    this.times_ms.push(now_ms);
    this.#forget(now_ms);
  }

  perSecond(now_ms) {
    this.#forget(now_ms);
    return this.times_ms.length / (kWindow_ms / 1000);
  }

  #forget(now_ms) {
    while (this.times_ms[0] < now_ms - kWindow_ms) this.times_ms.shift();
  }
}
