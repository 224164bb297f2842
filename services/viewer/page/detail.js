// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// How much of a large map is drawn while it moves, so that a slow graphics driver still shows ten frames per second.
// On a fast one it is everything, always; at rest it is everything, everywhere.

const kSlow_ms = 85, kFast_ms = 50;     // between two frames; in between nothing changes
const kPause_ms = 400;                  // frames that are further apart say nothing about the speed
const kLeastShare = 0.05;
const kLess = 0.85, kMore = 1.1;
const kMemory = 0.7;                    // weight of the past in the mean

export class Detail {
  constructor() {
    this.share = 1;
  }

  /** A frame was drawn so long after the one before. */
  frame(interval_ms) {
    if (interval_ms > kPause_ms) return;
    this.mean_ms = kMemory * (this.mean_ms ?? interval_ms) + (1 - kMemory) * interval_ms;
    if (this.mean_ms > kSlow_ms) this.share = Math.max(kLeastShare, this.share * kLess);
    if (this.mean_ms < kFast_ms) this.share = Math.min(1, this.share * kMore);
  }
}
