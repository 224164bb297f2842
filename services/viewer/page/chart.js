// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Small charts on a canvas: lines, and stacked areas, over the last minute. The newest value is at the right edge.

import { axisMark } from "./format.js";
import { kSeriesColors } from "./palette.js";
import { niceCeiling, percentile } from "./series.js";

const kSpan_s = 60;
const kBin_s = 0.25;
const kPad = { left: 34, right: 4, top: 5, bottom: 4 };

/** Colours come from the style sheet, so that charts follow the theme. */
function colorsOf(canvas) {
  const style = getComputedStyle(canvas);
  return { line: style.getPropertyValue("--line"), muted: style.getPropertyValue("--muted"), accent: style.getPropertyValue("--accent") };
}

class Frame {
  constructor(canvas, end_s, highest) {
    const ratio = Math.min(2, window.devicePixelRatio), { clientWidth: width, clientHeight: height } = canvas;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    this.context = canvas.getContext("2d", { willReadFrequently: true });   // small: drawn by the processor
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    this.colors = colorsOf(canvas);
    this.end_s = end_s;
    this.font_px = parseFloat(getComputedStyle(canvas).fontSize);
    this.box = { left: kPad.left * this.font_px / 11, right: width - kPad.right, top: kPad.top, bottom: height - kPad.bottom };
    this.highest = highest;
    this.#axis();
  }
  x(time_s) { return this.box.right - (this.end_s - time_s) / kSpan_s * (this.box.right - this.box.left); }
  y(value) { return this.box.bottom - Math.min(1, value / this.highest) * (this.box.bottom - this.box.top); }

  #axis() {
    const { context, box } = this;
    context.font = `${this.font_px}px system-ui, sans-serif`;
    context.fillStyle = this.colors.muted;
    context.strokeStyle = this.colors.line;
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const value of [0, this.highest / 2, this.highest]) {
      const y = Math.round(this.y(value)) + 0.5;
      context.beginPath();
      context.moveTo(box.left, y);
      context.lineTo(box.right, y);
      context.stroke();
      const inside = Math.min(box.bottom - this.font_px / 2 + 3, Math.max(box.top + this.font_px / 2 - 3, y));
      context.fillText(axisMark(value), box.left - 5, inside);
    }
  }
}

/** Bins of kBin_s: [{time_s, values}], so that a chart costs the same however many values there are. */
function binned(series) {
  const bins = [];
  series.values.forEach((value, i) => {
    const index = Math.floor(series.times_s[i] / kBin_s), last = bins[bins.length - 1];
    if (last?.index === index) last.values.push(value);
    else bins.push({ index, time_s: (index + 0.5) * kBin_s, values: [value] });
  });
  return bins;
}

/** marks: [{value, color}] are drawn as dashed lines. highest: of the axis, or undefined for a round number that fits. */
export function drawLine(canvas, series, end_s, { highest, marks = [] } = {}) {
  const frame = new Frame(canvas, end_s, highest ?? niceCeiling(percentile(series.values, 1) || 0)), { context, box } = frame;
  context.beginPath();
  for (const { time_s, values } of binned(series)) {
    const x = frame.x(time_s);
    if (x < box.left) continue;
    context.lineTo(x, frame.y(Math.min(...values)));   // both ends of the bin: peaks stay visible
    context.lineTo(x, frame.y(Math.max(...values)));
  }
  context.strokeStyle = frame.colors.accent;
  context.lineWidth = 1.5;
  context.lineJoin = "round";
  context.stroke();
  for (const { value, color } of marks) {
    if (Number.isFinite(value)) dashedLine(frame, frame.y(value), color);
  }
}

function dashedLine({ context, box }, y, color) {
  context.fillStyle = color;
  for (let x = box.left; x < box.right; x += 7) context.fillRect(x, Math.round(y), 4, 1);
}

/** Values of the series: {part: number}. names: parts from below, in the order of their colours. */
export function drawStack(canvas, series, names, end_s) {
  const bins = binned(series).map(({ time_s, values }) => ({ time_s, parts: names.map((name) => meanOf(values, name)) }));
  const sums = bins.map(({ parts }) => parts.reduce((sum, part) => sum + part, 0));
  const frame = new Frame(canvas, end_s, niceCeiling(percentile(sums, 1) || 0)), { context, box } = frame;
  const width = Math.ceil((box.right - box.left) * kBin_s / kSpan_s);
  for (const { time_s, parts } of bins) {
    const x = Math.floor(frame.x(time_s - kBin_s / 2));
    if (x < box.left) continue;
    let base = 0;
    parts.forEach((part, i) => {
      context.fillStyle = kSeriesColors[i % kSeriesColors.length];
      context.fillRect(x, frame.y(base + part), width, frame.y(base) - frame.y(base + part));
      base += part;
    });
  }
}

const meanOf = (values, name) => values.reduce((sum, parts) => sum + (parts[name] ?? 0), 0) / values.length;
