// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <tinyxml2.h>

#include "services/detector/core/evaluation/label_check.hpp"
#include "services/detector/core/evaluation/labels.hpp"

namespace rtd::detector {
namespace {

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

ImageLabels parse_voc_labels(const LabelFile& file, ImageSize image) {
  ImageLabels labels;
  tinyxml2::XMLDocument document;
  if (document.Parse(file.text.data(), file.text.size()) != tinyxml2::XML_SUCCESS) {
    labels.problems.push_back(
        fmt::format("{}:{}: is no XML ({})", file.name, document.ErrorLineNum(), document.ErrorName()));
    return labels;
  }
  const tinyxml2::XMLElement* const annotation = document.FirstChildElement("annotation");
  if (annotation == nullptr) {
    labels.problems.push_back(file.name + ":1: has no <annotation>, so it is no Pascal VOC file");
    return labels;
  }
  const Scale scale = scale_of(*annotation, image);
  for (const auto* object = annotation->FirstChildElement("object"); object != nullptr;
       object = object->NextSiblingElement("object")) {
    add_object(*object, file, image, scale, labels);
  }
  return labels;
}

}  // namespace rtd::detector
