// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/datasets/dataset.hpp"

#include <algorithm>
#include <regex>

namespace rtd::eval {

const NamedDataset& named(Dataset dataset) {
  return *std::ranges::find(kDatasets, dataset, &NamedDataset::dataset);
}

const NamedDataset* find_dataset(std::string_view name) {
  const auto found = std::ranges::find(kDatasets, name, &NamedDataset::name);
  return found == kDatasets.end() ? nullptr : &*found;
}

std::string sequence_name(Dataset dataset, const std::string& folder_name) {
  static const std::regex kTum("rgbd_dataset_freiburg([123])_([A-Za-z0-9_]+)");
  static const std::regex kBonn("rgbd_bonn_([A-Za-z0-9_]+)");
  static const std::regex kOpenloris("(?:office|corridor|home|cafe|market)[0-9]+-[0-9]+");
  std::smatch parts;
  switch (dataset) {
    case Dataset::kTum:
      return std::regex_match(folder_name, parts, kTum) ? "fr" + parts[1].str() + "_" + parts[2].str() : "";
    case Dataset::kBonn:
      return std::regex_match(folder_name, parts, kBonn) ? parts[1].str() : "";
    case Dataset::kOpenloris:
      return std::regex_match(folder_name, kOpenloris) ? folder_name : "";
  }
  return "";
}

std::span<const char* const> mean_sequences(Dataset dataset) {
  static constexpr std::array kBonnMean{"balloon",
                                        "balloon2",
                                        "crowd",
                                        "crowd2",
                                        "person_tracking",
                                        "person_tracking2",
                                        "moving_nonobstructing_box",
                                        "moving_nonobstructing_box2"};
  if (dataset == Dataset::kBonn) return kBonnMean;
  return {};
}

}  // namespace rtd::eval
