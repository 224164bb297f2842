// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Numbers over time for the plots, and their percentiles.

/** The last `span_s` seconds of a value, at most `limit` of them. */
export class Series {
  constructor(span_s = 60, limit = 2000) {
    this.span_s = span_s;
    this.limit = limit;
    this.times_s = [];
    this.values = [];
  }

  /** A time that goes back, as after a seek in a recording, begins the series again. */
  push(time_s, value) {
    if (time_s < this.times_s[this.times_s.length - 1]) this.clear();
    this.times_s.push(time_s);
    this.values.push(value);
    let old = 0;
    while (this.times_s[old] < time_s - this.span_s) ++old;
    old = Math.max(old, this.values.length - this.limit);
    if (old > 0) {
      this.times_s.splice(0, old);
      this.values.splice(0, old);
    }
  }

  clear() {
    this.times_s = [];
    this.values = [];
  }

  get last() {
    return this.values[this.values.length - 1];
  }
}

/** The value below which the share p (0..1) of the values lies; NaN for none. */
export function percentile(values, p) {
  if (values.length === 0) return NaN;
  const sorted = Float64Array.from(values).sort();
  const rank = Math.ceil(p * sorted.length - 1e-9);
  return sorted[Math.min(sorted.length, Math.max(1, rank)) - 1];
}

/** A round number at or above the value: the upper end of an axis. */
export function niceCeiling(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((step) => step * power).find((end) => end >= value * (1 - 1e-9));
}
