// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Whether a page looks as it did: with a tolerance, because drivers and fonts draw a little differently.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";

const kCellTolerance = 34;          // of 255, per colour of a cell
const kDifferingCells = 0.06;       // share of cells that may differ more

export function differing(a, b, tolerance) {
  const far = a.cells.filter((cell, i) => cell.some((value, k) => Math.abs(value - b.cells[i][k]) > tolerance));
  return far.length / a.cells.length;
}

/** A look as coarse() gives it against the one in the file; RTD_UPDATE_LOOKS=1 writes it, for a look at the screenshots. */
export function compareLook(file, name, look) {
  const looks = JSON.parse(readFileSync(file, "utf8"));
  if (process.env.RTD_UPDATE_LOOKS) {
    writeFileSync(file, `${JSON.stringify({ ...looks, [name]: look })}\n`);
    return;
  }
  assert.equal(look.background, looks[name].background, "background colour");
  const share = differing(look, looks[name], kCellTolerance);
  assert.ok(share <= kDifferingCells, `${(100 * share).toFixed(0)} % of the cells of ${name} look different`);
  assert.ok(Math.abs(look.other - looks[name].other) < 0.05, `${look.other} of the pixels are no background, expected ${looks[name].other}`);
}
