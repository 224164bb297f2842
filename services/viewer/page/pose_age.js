// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// How old a pose is when it is on the screen, in the server's clock.

import { percentile } from "./series.js";

const kKept = 200;

export class PoseAge {
  constructor() {
    this.ages_ms = [];
  }

  /** offset_ms: server's clock minus the browser's. */
  add(finished_ms, now_ms, offset_ms) {
    this.finished_ms = finished_ms;
    this.ages_ms.push(now_ms + offset_ms - finished_ms);
    if (this.ages_ms.length > kKept) this.ages_ms.shift();
  }

  get p50_ms() {
    return percentile(this.ages_ms, 0.5);
  }

  /** What the header shows: how late poses are, and how long ago the last one was if none comes. */
  shown_ms(now_ms, offset_ms) {
    const since_ms = now_ms + offset_ms - this.finished_ms, recent_ms = percentile(this.ages_ms.slice(-15), 0.5);
    return since_ms > 1000 ? since_ms : recent_ms;
  }
}
