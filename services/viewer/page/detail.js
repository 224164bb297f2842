// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// How much of a large map is drawn while it moves, so that a slow graphics driver still shows 30 frames per second, of
// a map whose points must be that many ten. On a fast one it is everything, always; at rest it is everything, everywhere.

const kEnoughPoints = 60_000;           // a map in motion is recognised by
const kSlow_ms = 34.5, kFast_ms = 26;   // a frame takes, while more are drawn; in between nothing changes
const kSlowest_ms = 85, kSlowerFast_ms = 50;   // while fewer are
const kLongest_ms = 400;                // that counts: a hidden page waits for hours
const kLeastShare = 0.05;
const kLess = 0.85, kMore = 1.1;
const kMemory = 0.7;                    // weight of the past in the mean

export class Detail {
  constructor() {
    this.share = 1;
  }

  /** A frame of so many points, when all are drawn, took so long, without what was waited before it on purpose.
      frugal: no more than enough of them, because drawing takes time from the robot. */
  frame(took_ms, points, frugal = false) {
    if (frugal) this.share = Math.min(this.share, kEnoughPoints / points);
    const last_ms = Math.min(took_ms, kLongest_ms);
    this.mean_ms = kMemory * (this.mean_ms ?? last_ms) + (1 - kMemory) * last_ms;
    const many = this.share * points > kEnoughPoints;
    if (this.mean_ms > (many ? kSlow_ms : kSlowest_ms)) this.#change(Math.max(kLeastShare, this.share * kLess));
    const more = Math.min(frugal ? kEnoughPoints / points : 1, 1, this.share * kMore);
    if (this.mean_ms < (more * points > kEnoughPoints ? kFast_ms : kSlowerFast_ms)) this.#change(more);
  }

  /** What comes is expected to take as much less or more. */
  #change(share) {
    this.mean_ms *= share / this.share;
    this.share = share;
  }
}
