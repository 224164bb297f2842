// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// How often a processor that also draws may do so. Where it is the robot's own, drawing makes poses late: then the page
// steps back at once, and comes nearer again slowly.

const kShortest_ms = 33, kLongest_ms = 1000;   // between two drawings; with the wait for the screen 20 to 30 per second
const kLate = 1.6;                             // of the time between two frames, from a frame to its pose
const kBack = 1.25, kNearer = 0.997;           // for each late pose, for each that is in time
const kMemory = 0.9;

export class DrawPace {
  /** sameHost: whether the page may run on the computer whose poses it shows. */
  constructor(sameHost) {
    this.sameHost = sameHost;
    this.period_ms = kShortest_ms;
  }

  /** Of each pose: the frame's number, its stamp, and the time from the frame to its pose. */
  pose({ seq, stamp_s, latency_ms }) {
    const frames = seq - (this.seq ?? seq), passed_ms = 1000 * (stamp_s - (this.stamp_s ?? stamp_s));
    [this.seq, this.stamp_s] = [seq, stamp_s];
    if (!this.sameHost || !(frames > 0) || !(passed_ms > 0)) return;
    const frame_ms = passed_ms / frames;
    this.frame_ms = kMemory * (this.frame_ms ?? frame_ms) + (1 - kMemory) * frame_ms;
    this.period_ms *= latency_ms > kLate * this.frame_ms ? kBack : kNearer;
    this.period_ms = Math.min(kLongest_ms, Math.max(kShortest_ms, this.period_ms));
  }
}

/** Loopback is this host, or the end of a tunnel: there stepping back costs smoothness only. */
export const isLoopback = (hostname) => /^(localhost|127(\.\d+){3}|\[::1\])$/.test(hostname);
