// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/image_folder.hpp"

#include <algorithm>
#include <cctype>

#include "services/evaluation/detector/eval_detector_options.hpp"

namespace rtd::launcher {
namespace {

namespace fs = std::filesystem;

bool is_image(const fs::path& path) {
  static const std::vector<std::string> kEndings = {".jpg", ".jpeg", ".png", ".bmp"};
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

}  // namespace

void require_folder(const std::string& folder, const std::string& option) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw EvalDetectorError(option + " " + folder + ": there is no such folder");
  }
}

std::vector<fs::path> images_in(const std::string& folder, const std::string& option, int step) {
  require_folder(folder, option);
  std::vector<fs::path> all, taken;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_image(entry.path())) all.push_back(entry.path());
  if (all.empty()) throw EvalDetectorError(option + " " + folder + ": has no images (jpg, jpeg, png, bmp)");
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(step)) taken.push_back(all[i]);
  return taken;
}

fs::path partner_of(const fs::path& image, const std::string& folder, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) {
    const fs::path candidate = fs::path(folder) / image.stem().concat(ending);
    std::error_code ignored;
    if (fs::is_regular_file(candidate, ignored)) return candidate;
  }
  return {};
}

}  // namespace rtd::launcher
