// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/decoder.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::detector {
namespace {

constexpr int kBoxNumbers = 5;  // x y w h objectness

int cells_of(InputSize input) {
  int cells = 0;
  for (const int stride_px : kStrides) cells += (input.height_px / stride_px) * (input.width_px / stride_px);
  return cells;
}

/// A row of the output and the cell that it belongs to.
struct Row {
  std::span<const float> numbers;
  int row, col, stride_px;
};

/// The largest class score; NaN never wins.
Candidate best_class(std::span<const float> numbers) {
  Candidate best{-1, 0, 0, 0, 0, 0};
  const std::span<const float> classes = numbers.subspan(kBoxNumbers);
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (classes[c] > best.score) best = {static_cast<int>(c), classes[c], 0, 0, 0, 0};
  }
  return best;
}

std::optional<Candidate> decode_row(const Row& row, float least_score) {
  Candidate box = best_class(row.numbers);
  box.score *= row.numbers[4];
  if (box.class_index < 0 || !(box.score >= least_score)) return std::nullopt;
  box.score = std::min(box.score, 1.0F);
  const auto stride_px = static_cast<float>(row.stride_px);
  const float x_px = (row.numbers[0] + static_cast<float>(row.col)) * stride_px;
  const float y_px = (row.numbers[1] + static_cast<float>(row.row)) * stride_px;
  const float half_width_px = 0.5F * std::exp(row.numbers[2]) * stride_px;
  const float half_height_px = 0.5F * std::exp(row.numbers[3]) * stride_px;
  box.left_px = x_px - half_width_px;
  box.top_px = y_px - half_height_px;
  box.right_px = x_px + half_width_px;
  box.bottom_px = y_px + half_height_px;
  return is_finite(box) ? std::optional(box) : std::nullopt;
}

bool has_cells(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  return outputs.size() == 1 && outputs[0].shape.size() == 3 && outputs[0].shape[1] == cells_of(facts.input);
}

std::optional<int> yolox_classes(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  if (!has_cells(facts, outputs) || outputs[0].shape[2] <= kBoxNumbers) return std::nullopt;
  return outputs[0].shape[2] - kBoxNumbers;
}

Decoder make_yolox(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  if (yolox_classes(facts, outputs) != facts.class_count) return {};
  return [facts](const std::vector<RawOutput>& given, int image, const DecodeConfig& config) {
    return decode_yolox(given.front().of(image), facts.input, facts.class_count, config);
  };
}

std::string yolox_shapes(const NetworkFacts& facts) {
  return shape_text({1, cells_of(facts.input), kBoxNumbers + facts.class_count});
}

}  // namespace

std::vector<Candidate> decode_yolox(std::span<const float> rows, InputSize input, int class_count,
                                    const DecodeConfig& config) {
  const auto least_score = static_cast<float>(config.confidence_threshold);
  const auto least_objectness = static_cast<float>(std::max(config.objectness_threshold, config.confidence_threshold));
  const auto numbers = static_cast<std::size_t>(kBoxNumbers + class_count);
  std::vector<Candidate> candidates;
  for (const int stride_px : kStrides) {
    const int cols = input.width_px / stride_px, cells = cols * (input.height_px / stride_px);
    for (int i = 0; i < cells; ++i, rows = rows.subspan(numbers)) {
      if (!(rows[4] >= least_objectness)) continue;
      const auto box = decode_row({rows.first(numbers), i / cols, i % cols, stride_px}, least_score);
      if (box) candidates.push_back(*box);
    }
  }
  return candidates;
}

DecoderFamily yolox_family() {
  const PixelFormat pixels{.rgb = false, .offset = {}, .scale = {1, 1, 1}};
  return {"yolox", "YOLOX", pixels, make_yolox, yolox_shapes, yolox_classes};
}

}  // namespace rtd::detector
