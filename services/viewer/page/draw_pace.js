// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// How often a computer may draw. Where the processor draws, and it is the robot's own, drawing makes poses late: there the page
// begins slowly, steps back at once when poses become late, and draws more often again while they are in time.

import { percentile } from "./series.js";

const kShortest_ms = 33, kLongest_ms = 1000;   // between two drawings; with the wait for the screen 20 to 30 per second
const kCautious_ms = 250;                      // at first, on the robot's own computer
const kLate = 1.6, kLater = 1.5;               // times a frame, from a frame to its pose; times what is usual here
const kBack = 1.4, kNearer = 0.998;            // for each late pose, for each that is in time
const kMemory = 0.9;
const kSlow_ms = 200, kSlowFrame_ms = 150;     // between two drawings of a computer that needs so long for each
const kSlowFrames = 15;                        // in a row; one alone may be a program that starts
const kWorthSaying_ms = 70;
const kUsual = 150;                            // poses that show what is usual

export class DrawPace {
  /** sameHost: whether the page may run on the computer whose poses it shows. */
  constructor(sameHost) {
    this.sameHost = sameHost;
    this.shortest_ms = kShortest_ms;
    this.period_ms = sameHost ? kCautious_ms : kShortest_ms;
    this.latencies_ms = [];
    this.slowFrames = 0;
  }

  /** A drawing took so long. True when this is the last of many slow ones: from now on there are few. */
  drawn(took_ms) {
    this.slowFrames = took_ms > kSlowFrame_ms ? this.slowFrames + 1 : 0;
    if (this.slow || this.slowFrames < kSlowFrames) return false;
    this.slow = true;
    this.shortest_ms = kSlow_ms;
    this.period_ms = Math.max(this.period_ms, kSlow_ms);
    return true;
  }

  /** Why there are few drawings, one line; empty: there are not. software: without a graphics card. */
  reason(software) {
    if (!(software || this.slow) || this.period_ms < kWorthSaying_ms) return "";
    const rate = Math.round(1000 / this.period_ms), why = software ? "Drawn without a graphics card" : "This computer draws slowly";
    return `${why}: at most ${rate} ${rate === 1 ? "picture" : "pictures"} per second`;
  }

  /** Of each pose: the frame's number, its stamp, and the time from the frame to its pose. */
  pose({ seq, stamp_s, latency_ms }) {
    const frames = seq - (this.seq ?? seq), passed_ms = 1000 * (stamp_s - (this.stamp_s ?? stamp_s));
    [this.seq, this.stamp_s] = [seq, stamp_s];
    if (!this.sameHost || !(frames > 0) || !(passed_ms > 0)) return;
    const frame_ms = passed_ms / frames;
    this.frame_ms = kMemory * (this.frame_ms ?? frame_ms) + (1 - kMemory) * frame_ms;
    this.period_ms *= this.#isLate(latency_ms) ? kBack : kNearer;
    this.period_ms = Math.min(kLongest_ms, Math.max(this.shortest_ms, this.period_ms));
  }

  /** Later than the robot can afford, or than it usually is while less than a frame is no reason to hurry. */
  #isLate(latency_ms) {
    this.latencies_ms.push(latency_ms);
    if (this.latencies_ms.length > kUsual) this.latencies_ms.shift();
    const usual_ms = percentile(this.latencies_ms, 0.5);
    return latency_ms > Math.min(kLate * this.frame_ms, Math.max(kLater * usual_ms, this.frame_ms));
  }
}

/** Loopback is this host, or the end of a tunnel: there stepping back costs smoothness only. */
export const isLoopback = (hostname) => /^(localhost|127(\.\d+){3}|\[::1\])$/.test(hostname);
