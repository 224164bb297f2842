// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// How far the server's clock is ahead of the browser's, from pings: the one that came back fastest is the best.

const kKept = 16;

export class ClockOffset {
  constructor() {
    this.samples = [];
  }

  /** sent_ms and now_ms in the browser's clock, server_ms when the server answered. */
  add(sent_ms, server_ms, now_ms) {
    this.samples.push({ round_trip_ms: now_ms - sent_ms, offset_ms: server_ms - (sent_ms + now_ms) / 2 });
    if (this.samples.length > kKept) this.samples.shift();
  }

  get #best() {
    return this.samples.reduce((a, b) => (b.round_trip_ms < a.round_trip_ms ? b : a),
                               { round_trip_ms: Infinity, offset_ms: 0 });
  }

  /** 0 when nothing was measured, or when the difference lies within what a ping cannot show: then it is the same host. */
  get offset_ms() {
    const { round_trip_ms, offset_ms } = this.#best;
    return Math.abs(offset_ms) <= round_trip_ms / 2 ? 0 : offset_ms;
  }

  get round_trip_ms() {
    return this.#best.round_trip_ms;
  }
}
