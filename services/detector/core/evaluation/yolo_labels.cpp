// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

#include "services/detector/core/evaluation/label_check.hpp"
#include "services/detector/core/evaluation/labels.hpp"

namespace rtd::detector {
namespace {

constexpr std::size_t kColumns = 5;  // class cx cy w h

std::vector<std::string> split_words(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// The whole word as a number, whatever the locale.
std::optional<double> parse_number(const std::string& word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The name of class `word`; a tool may have written 0.0.
std::optional<std::string> class_of(const std::string& word, const std::vector<std::string>& class_names) {
  const std::optional<double> index = parse_number(word);
  if (!index || *index < 0 || *index >= double(class_names.size()) || *index != std::floor(*index)) return std::nullopt;
  return class_names[static_cast<std::size_t>(*index)];
}

struct Row {
  std::optional<LabelledBox> box;
  std::string problem;
};

Row parse_row(const std::vector<std::string>& words, ImageSize image, const std::vector<std::string>& class_names) {
  if (words.size() != kColumns) {
    return {{}, fmt::format("{} columns, expected 5: class cx cy w h", words.size())};
  }
  const std::optional<std::string> name = class_of(words[0], class_names);
  if (!name) return {{}, fmt::format("class '{}' is not one of 0..{}", words[0], class_names.size() - 1)};
  double shares[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const std::optional<double> share = parse_number(words[i + 1]);
    if (!share || !std::isfinite(*share)) return {{}, fmt::format("'{}' is no number", words[i + 1])};
    shares[i] = *share;
  }
  const double width_px = shares[2] * image.width_px, height_px = shares[3] * image.height_px;
  return {LabelledBox{*name, shares[0] * image.width_px - width_px / 2, shares[1] * image.height_px - height_px / 2,
                      width_px, height_px},
          {}};
}

}  // namespace

ImageLabels parse_yolo_labels(const LabelFile& file, ImageSize image, const std::vector<std::string>& class_names) {
  ImageLabels labels;
  std::istringstream stream(file.text);
  std::size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    const std::string where = fmt::format("{}:{}", file.name, ++number);
    const std::vector<std::string> words = split_words(line);
    if (words.empty()) continue;
    const Row row = parse_row(words, image, class_names);
    if (row.box) {
      add_label(*row.box, image, where, labels);
    } else {
      labels.problems.push_back(where + ": " + row.problem);
    }
  }
  return labels;
}

}  // namespace rtd::detector
