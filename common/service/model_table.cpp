// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/model_table.hpp"

#include <algorithm>
#include <filesystem>

namespace rtd::service {

std::string known_model_names() {
  std::string text;
  for (const KnownModel& model : kKnownModels) text += (text.empty() ? "" : ", ") + std::string(model.name);
  return text;
}

const KnownModel* find_known_model(const std::string& name_or_path) {
  const std::string file = std::filesystem::path(name_or_path).filename().string();
  const auto is_meant = [&](const KnownModel& model) { return name_or_path == model.name || file == model.file; };
  if (is_meant(kMaskModel)) return &kMaskModel;
  const auto found = std::ranges::find_if(kKnownModels, is_meant);
  return found == kKnownModels.end() ? nullptr : found;
}

std::string describe_model(const std::string& path) {
  if (const KnownModel* const model = find_known_model(path)) return std::string(model->title) + ", " + model->licence;
  return std::filesystem::path(path).filename().string() + ", licence not known";
}

}  // namespace rtd::service
