// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/image_folder.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

#include "services/evaluation/detector/eval_detector_command.hpp"

namespace rtd::eval {
namespace {

namespace fs = std::filesystem;

bool is_image(const fs::path& path) {
  static const std::vector<std::string> kEndings = {".jpg", ".jpeg", ".png", ".bmp"};
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

namespace fs = std::filesystem;

std::string detect_format(const std::string& folder) {
  std::size_t yolo = 0, voc = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    if (name.extension() == ".txt" && name != "classes.txt") ++yolo;
    if (name.extension() == ".xml") ++voc;
  }
  if (yolo > 0 && voc > 0) {
    throw EvalDetectorError("--labels " + folder + ": has " + std::to_string(yolo) + " .txt and " +
                            std::to_string(voc) + " .xml files; add --label-format yolo or voc");
  }
  if (yolo + voc == 0) throw EvalDetectorError("--labels " + folder + ": has neither .txt (YOLO) nor .xml (VOC) files");
  return yolo > 0 ? "yolo" : "voc";
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

LabelFolder::LabelFolder(const std::string& folder, const std::string& format) : folder_(folder), format_(format) {
  require_folder(folder, "--labels");
  if (format == "auto") format_ = detect_format(folder);
}

bool LabelFolder::has(const fs::path& image) const {
  return !file_of(image).empty();
}

detector::ImageLabels LabelFolder::read(const fs::path& image, detector::ImageSize size,
                                        const std::vector<std::string>& class_names) const {
  const fs::path path = file_of(image);
  if (path.empty()) return {};
  std::ifstream file(path, std::ios::binary);
  const detector::LabelFile text{path.filename().string(), {std::istreambuf_iterator<char>(file), {}}};
  return format_ == "yolo" ? parse_yolo_labels(text, size, class_names) : parse_voc_labels(text, size);
}

fs::path LabelFolder::file_of(const fs::path& image) const {
  return partner_of(image, folder_, {format_ == "yolo" ? ".txt" : ".xml"});
}

}  // namespace rtd::eval
