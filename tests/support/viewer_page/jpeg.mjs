// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// A JPEG of flat blocks: only the mean (DC coefficient) of every 8 x 8 block is coded, which needs no cosine transform.
// Baseline, three components without subsampling; tables of ITU-T T.81 annex K.3 (Huffman), quantisation 1.

const kCounts = [0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0];      // codes per length, DC luminance
const kEndOfBlock = [0b0, 1];                                          // the only AC code of our own table

/** The codes of the table in canonical order: category -> [code, length]. */
const kDcCodes = (() => {
  const codes = [];
  let code = 0;
  kCounts.forEach((count, i) => {
    for (let k = 0; k < count; ++k) codes.push([code++, i + 1]);
    code <<= 1;
  });
  return codes;
})();

class Bits {
  bytes = [];
  value = 0;
  length = 0;
  put(code, length) {
    for (let i = length - 1; i >= 0; --i) {
      this.value = (this.value << 1) | ((code >> i) & 1);
      if (++this.length < 8) continue;
      this.bytes.push(this.value);
      if (this.value === 0xff) this.bytes.push(0);
      this.value = this.length = 0;
    }
  }
  finish() {
    while (this.length > 0) this.put(1, 1);
    return this.bytes;
  }
}

const segment = (marker, bytes) => [0xff, marker, (bytes.length + 2) >> 8, (bytes.length + 2) & 255, ...bytes];

/** color(column, row) of a block: [r, g, b]; width and height in blocks. */
export function flatJpeg(width, height, color) {
  const size = [(height * 8) >> 8, (height * 8) & 255, (width * 8) >> 8, (width * 8) & 255];
  return Buffer.from([
    0xff, 0xd8,
    ...segment(0xdb, [0, ...new Array(64).fill(1)]),
    ...segment(0xc0, [8, ...size, 3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0]),
    ...segment(0xc4, [0x00, ...kCounts, ...kDcCodes.keys()]),
    ...segment(0xc4, [0x10, 1, ...new Array(15).fill(0), 0]),
    ...segment(0xda, [3, 1, 0, 2, 0, 3, 0, 0, 63, 0]),
    ...scan(width, height, color),
    0xff, 0xd9,
  ]);
}

function scan(width, height, color) {
  const bits = new Bits(), last = [0, 0, 0];
  for (let row = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column) {
      toYcc(color(column, row)).forEach((value, i) => {
        const mean = Math.round(8 * (value - 128));
        putDifference(bits, mean - last[i]);
        bits.put(...kEndOfBlock);
        last[i] = mean;
      });
    }
  }
  return bits.finish();
}

function putDifference(bits, difference) {
  const category = 32 - Math.clz32(Math.abs(difference));
  bits.put(...kDcCodes[category]);
  if (category > 0) bits.put(difference > 0 ? difference : difference + (1 << category) - 1, category);
}

function toYcc([r, g, b]) {
  return [0.299 * r + 0.587 * g + 0.114 * b, 128 - 0.1687 * r - 0.3313 * g + 0.5 * b, 128 + 0.5 * r - 0.4187 * g - 0.0813 * b];
}
