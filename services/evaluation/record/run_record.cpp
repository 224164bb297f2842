// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/record/run_record.hpp"

namespace rtd::eval {

std::vector<JudgedFeature> judged(std::span<const msg::Feature> features) {
  std::vector<JudgedFeature> result;
  result.reserve(features.size());
  for (const msg::Feature& f : features) {
    result.push_back({f.u_raw_px, f.v_raw_px, (f.flags & msg::kFeatureRemoved) != 0});
  }
  return result;
}

bool is_synthetic(const std::string& source_uri) {
  return source_uri.starts_with("synthetic:");
}

std::filesystem::path mask_folder(const std::string& source_uri) {
  constexpr std::string_view kTum = "tum:";
  if (!source_uri.starts_with(kTum)) return {};
  const std::string folder = source_uri.substr(kTum.size());
  return std::filesystem::path(folder.substr(0, folder.find('?'))) / "mask";
}

bool has_true_masks(const std::string& source_uri) {
  std::error_code error;
  const std::filesystem::path folder = mask_folder(source_uri);
  return is_synthetic(source_uri) || (!folder.empty() && std::filesystem::is_directory(folder, error));
}

}  // namespace rtd::eval
