// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/detection/labels.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/io/text.hpp"

namespace rtd::eval {
namespace {

std::string describe(const LabelledBox& box) {
  return fmt::format("{} {:.1f} {:.1f} {:.1f} x {:.1f} px", box.class_name, box.x_px, box.y_px, box.width_px,
                     box.height_px);
}

/// Text formats round: the same object marked twice may differ in the last digit.
bool same(const LabelledBox& a, const LabelledBox& b) {
  constexpr double kRounding_px = 0.05;
  const auto near = [](double left, double right) { return std::abs(left - right) < kRounding_px; };
  return a.class_name == b.class_name && near(a.x_px, b.x_px) && near(a.y_px, b.y_px) && near(a.width_px, b.width_px) &&
         near(a.height_px, b.height_px);
}

LabelledBox clip(const LabelledBox& box, ImageSize image) {
  LabelledBox clipped = box;
  clipped.x_px = std::clamp(box.x_px, 0.0, double(image.width_px));
  clipped.y_px = std::clamp(box.y_px, 0.0, double(image.height_px));
  clipped.width_px = std::clamp(box.x_px + box.width_px, 0.0, double(image.width_px)) - clipped.x_px;
  clipped.height_px = std::clamp(box.y_px + box.height_px, 0.0, double(image.height_px)) - clipped.y_px;
  return clipped;
}

/// Clips `box` to the image and keeps it; a box without area, outside the image or marked twice becomes a problem at
/// `where` ("file:line").
void add_label(const LabelledBox& box, ImageSize image, const std::string& where, ImageLabels& labels) {
  const auto reject = [&](const std::string& cause) {
    labels.problems.push_back(fmt::format("{}: {}: {}", where, describe(box), cause));
  };
  const bool finite =
      std::isfinite(box.x_px) && std::isfinite(box.y_px) && std::isfinite(box.width_px) && std::isfinite(box.height_px);
  if (!finite) return reject("is not a number");
  if (box.width_px <= 0 || box.height_px <= 0) return reject("has no area");
  const LabelledBox clipped = clip(box, image);
  if (clipped.width_px <= 0 || clipped.height_px <= 0) {
    return reject(fmt::format("lies outside the image of {} x {} px", image.width_px, image.height_px));
  }
  const bool repeated =
      std::ranges::any_of(labels.boxes, [&](const LabelledBox& earlier) { return same(earlier, clipped); });
  if (repeated) return reject("occurs twice, counted once");
  labels.boxes.push_back(clipped);
}

constexpr std::size_t kColumns = 5;  // class cx cy w h

/// The name of class number `text`; a tool may have written 0.0.
std::optional<std::string> class_of(const std::string& text, const std::vector<std::string>& class_names) {
  const std::optional<double> index = io::parse_number(text);
  if (!index || *index < 0 || *index >= double(class_names.size()) || *index != std::floor(*index)) return std::nullopt;
  return class_names[static_cast<std::size_t>(*index)];
}

struct Row {
  std::optional<LabelledBox> box;
  std::string problem;
};

Row parse_row(const std::vector<std::string>& columns, ImageSize image, const std::vector<std::string>& class_names) {
  if (columns.size() != kColumns) {
    return {{}, fmt::format("{} columns, expected 5: class cx cy w h", columns.size())};
  }
  const std::optional<std::string> name = class_of(columns[0], class_names);
  if (!name) return {{}, fmt::format("class '{}' is not one of 0..{}", columns[0], class_names.size() - 1)};
  double shares[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const std::optional<double> share = io::parse_number(columns[i + 1]);
    if (!share || !std::isfinite(*share)) return {{}, fmt::format("'{}' is not a number", columns[i + 1])};
    shares[i] = *share;
  }
  const double width_px = shares[2] * image.width_px, height_px = shares[3] * image.height_px;
  return {LabelledBox{*name, shares[0] * image.width_px - width_px / 2, shares[1] * image.height_px - height_px / 2,
                      width_px, height_px},
          {}};
}

/// Text of the child `name`, empty when there is none.
std::string text_of(const tinyxml2::XMLElement& parent, const char* name) {
  const tinyxml2::XMLElement* const child = parent.FirstChildElement(name);
  return child == nullptr || child->GetText() == nullptr ? std::string() : child->GetText();
}

/// Number in the child `name` of `parent`; adds a problem when it is none.
double number_in(const tinyxml2::XMLElement& parent, const char* name, const std::string& where,
                 std::vector<std::string>& problems) {
  const tinyxml2::XMLElement* const child = parent.FirstChildElement(name);
  double value = 0;
  if (child == nullptr || child->QueryDoubleText(&value) != tinyxml2::XML_SUCCESS) {
    problems.push_back(fmt::format("{}: <{}> is '{}', expected a number", where, name, text_of(parent, name)));
  }
  return value;
}

/// Image px per px of the annotation.
struct Scale {
  double x = 1, y = 1;
};

Scale scale_of(const tinyxml2::XMLElement& annotation, ImageSize image) {
  const tinyxml2::XMLElement* const size = annotation.FirstChildElement("size");
  int width_px = 0, height_px = 0;
  if (size == nullptr) return {};
  if (const auto* const width = size->FirstChildElement("width")) width->QueryIntText(&width_px);
  if (const auto* const height = size->FirstChildElement("height")) height->QueryIntText(&height_px);
  if (width_px <= 0 || height_px <= 0) return {};  // some tools write 0
  return {double(image.width_px) / width_px, double(image.height_px) / height_px};
}

void add_object(const tinyxml2::XMLElement& object, const LabelFile& file, ImageSize image, Scale scale,
                ImageLabels& labels) {
  const std::string where = fmt::format("{}:{}", file.name, object.GetLineNum());
  const std::string name = text_of(object, "name");
  const tinyxml2::XMLElement* const corners = object.FirstChildElement("bndbox");
  if (name.empty() || corners == nullptr) {
    labels.problems.push_back(where + ": <object> without " + (name.empty() ? "<name>" : "<bndbox>"));
    return;
  }
  const std::size_t before = labels.problems.size();
  const double left = number_in(*corners, "xmin", where, labels.problems) - 1;  // counted from 1
  const double top = number_in(*corners, "ymin", where, labels.problems) - 1;
  const double right = number_in(*corners, "xmax", where, labels.problems);  // the last pixel inside
  const double bottom = number_in(*corners, "ymax", where, labels.problems);
  if (labels.problems.size() != before) return;
  add_label({name, left * scale.x, top * scale.y, (right - left) * scale.x, (bottom - top) * scale.y,
             text_of(object, "difficult") == "1"},
            image, where, labels);
}

}  // namespace

ImageLabels parse_yolo_labels(const LabelFile& file, ImageSize image, const std::vector<std::string>& class_names) {
  ImageLabels labels;
  for (const io::TextLine& line : io::split_lines(file.text)) {
    const std::string where = fmt::format("{}:{}", file.name, line.number);
    const Row row = parse_row(line.fields, image, class_names);
    if (row.box) {
      add_label(*row.box, image, where, labels);
    } else {
      labels.problems.push_back(where + ": " + row.problem);
    }
  }
  return labels;
}

ImageLabels parse_voc_labels(const LabelFile& file, ImageSize image) {
  ImageLabels labels;
  tinyxml2::XMLDocument document;
  if (document.Parse(file.text.data(), file.text.size()) != tinyxml2::XML_SUCCESS) {
    labels.problems.push_back(
        fmt::format("{}:{}: is not XML ({})", file.name, document.ErrorLineNum(), document.ErrorName()));
    return labels;
  }
  const tinyxml2::XMLElement* const annotation = document.FirstChildElement("annotation");
  if (annotation == nullptr) {
    labels.problems.push_back(file.name + ":1: has no <annotation>, so it is not a Pascal VOC file");
    return labels;
  }
  const Scale scale = scale_of(*annotation, image);
  for (const auto* object = annotation->FirstChildElement("object"); object != nullptr;
       object = object->NextSiblingElement("object")) {
    add_object(*object, file, image, scale, labels);
  }
  return labels;
}

}  // namespace rtd::eval
