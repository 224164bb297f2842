// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Numbers as people read them.

const kThousands = new Intl.NumberFormat("en-US", { maximumFractionDigits: 0 });
const kNone = "–";

export const count = (value) => (Number.isFinite(value) ? kThousands.format(value) : kNone);

export function ms(value) {
  if (!Number.isFinite(value)) return kNone;
  if (Math.abs(value) >= 1000) return `${(value / 1000).toFixed(Math.abs(value) < 10_000 ? 1 : 0)} s`;
  return `${Math.abs(value) < 10 ? value.toFixed(1) : value.toFixed(0)} ms`;
}

export function length(value_m) {
  if (!Number.isFinite(value_m)) return kNone;
  return value_m < 1 ? `${(value_m * 100).toFixed(1)} cm` : `${value_m.toFixed(2)} m`;
}

export function rate(value_kBps) {
  if (!Number.isFinite(value_kBps)) return kNone;
  return value_kBps < 1000 ? `${value_kBps.toFixed(0)} kB/s` : `${(value_kBps / 1000).toFixed(1)} MB/s`;
}

/** A mark of an axis, short: 0.5, 200, 10k */
export const axisMark = (value) => (value < 10_000 ? String(Number(value.toPrecision(2))) : `${Number((value / 1000).toPrecision(2))}k`);

/** Minutes and seconds: 1:05.3 */
export function clockTime(value_s) {
  if (!Number.isFinite(value_s)) return kNone;
  const minutes = Math.floor(value_s / 60);
  return `${minutes}:${(value_s - 60 * minutes).toFixed(1).padStart(4, "0")}`;
}

/** As its makers write it. */
export const vendorName = (vendor) => ({ fastdds: "Fast DDS", cyclonedds: "Cyclone DDS" })[vendor] ?? vendor;

/** A metric of a service: whole numbers with separators, others with three digits. */
export function metric(value) {
  return Number.isInteger(value) ? kThousands.format(value) : String(Number(value.toPrecision(3)));
}
