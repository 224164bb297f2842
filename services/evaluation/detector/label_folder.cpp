// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/label_folder.hpp"

#include <fstream>
#include <iterator>

#include "services/evaluation/detector/eval_detector_options.hpp"
#include "services/evaluation/detector/image_folder.hpp"

namespace rtd::launcher {
namespace {

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
                            std::to_string(voc) + " .xml files; say --label-format yolo or voc");
  }
  if (yolo + voc == 0) throw EvalDetectorError("--labels " + folder + ": has neither .txt (YOLO) nor .xml (VOC) files");
  return yolo > 0 ? "yolo" : "voc";
}

}  // namespace

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

}  // namespace rtd::launcher
