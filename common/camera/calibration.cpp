// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <vector>

#include "common/camera/calibration_forms.hpp"
#include "common/camera/frame_source.hpp"
#include "common/io/input_file.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::camera {
namespace {

constexpr const char* kAllowedKeys =
    "width height fx fy cx cy (needed), fisheye k1 k2 p1 p2 k3 k4 k5 k6 depth_factor fps readout_s depth_offset_s "
    "(optional)";

struct KeyRule {
  double min, max;
  bool needed;
};

const std::map<std::string, KeyRule>& key_rules() {
  constexpr double kTime = msg::kMaxSensorTime_s;
  static const std::map<std::string, KeyRule> rules = {{"width", {16, 1e5, true}},
                                                       {"height", {16, 1e5, true}},
                                                       {"fx", {1, 1e5, true}},
                                                       {"fy", {1, 1e5, true}},
                                                       {"cx", {-1e5, 1e5, true}},
                                                       {"cy", {-1e5, 1e5, true}},
                                                       {"k1", {-100, 100, false}},
                                                       {"k2", {-100, 100, false}},
                                                       {"p1", {-10, 10, false}},
                                                       {"p2", {-10, 10, false}},
                                                       {"k3", {-100, 100, false}},
                                                       {"k4", {-100, 100, false}},
                                                       {"k5", {-100, 100, false}},
                                                       {"k6", {-100, 100, false}},
                                                       {"fisheye", {0, 1, false}},
                                                       {"fps", {0.1, 1000, false}},
                                                       {"depth_factor", {1, 1e6, false}},
                                                       {"readout_s", {-kTime, kTime, false}},
                                                       {"depth_offset_s", {-kTime, kTime, false}}};
  return rules;
}

/// Keys of the distortion in the order of CameraModel::Parameters.
const std::vector<std::string>& coefficient_names(geometry::Lens lens) {
  static const std::vector<std::string> brown = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  static const std::vector<std::string> fisheye = {"k1", "k2", "k3", "k4"};
  return lens == geometry::Lens::kFisheye ? fisheye : brown;
}

SourceError out_of_range(const std::string& where, const std::string& key, const std::string& value) {
  const KeyRule& rule = key_rules().at(key);
  return SourceError(fmt::format("{}: {} is '{}', allowed is a number in [{:g}, {:g}]", where, key, io::abridged(value),
                                 rule.min, rule.max));
}

/// NaN is not.
bool in_range(const std::string& key, double value) {
  const KeyRule& rule = key_rules().at(key);
  return value >= rule.min && value <= rule.max;
}

std::pair<std::string, double> parse_entry(const io::TextLine& line, const std::string& origin) {
  const std::string where = origin + ":" + std::to_string(line.number);
  std::string joined;
  for (const std::string& field : line.fields) joined += field;
  const std::size_t colon = joined.find(':');
  if (colon == std::string::npos) throw SourceError(where + ": expected 'key: value' with the keys " + kAllowedKeys);
  const std::string key = joined.substr(0, colon), value_text = joined.substr(colon + 1);
  if (key_rules().count(key) == 0) {
    throw SourceError(where + ": unknown key '" + io::abridged(key) + "'; allowed: " + kAllowedKeys +
                      "; forms of other programs that are read: " + kCalibrationForms);
  }
  const std::optional<double> value = io::parse_number(value_text);
  if (!value || !in_range(key, *value)) throw out_of_range(where, key, value_text);
  return {key, *value};
}

void require_keys(const std::map<std::string, double>& values, const std::string& origin) {
  for (const auto& [key, rule] : key_rules()) {
    if (rule.needed && values.count(key) == 0) {
      throw SourceError(origin + ": key '" + key + "' is missing; keys: " + kAllowedKeys);
    }
  }
}

Calibration from_values(std::map<std::string, double> values, const std::string& origin,
                        LensModel lens = LensModel::kBrownConrady) {
  require_keys(values, origin);
  geometry::CameraModel::Parameters parameters;
  parameters.fx = values["fx"];
  parameters.fy = values["fy"];
  parameters.cx = values["cx"];
  parameters.cy = values["cy"];
  if (lens == LensModel::kFisheye) values["fisheye"] = 1;
  parameters.lens = values["fisheye"] != 0 ? geometry::Lens::kFisheye : geometry::Lens::kBrownConrady;
  const std::vector<std::string>& names = coefficient_names(parameters.lens);
  for (const std::string name : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}) {
    if (values[name] != 0 && std::ranges::find(names, name) == names.end())
      throw SourceError(origin + ": a fisheye lens has k1 k2 k3 k4; remove " + name);
  }
  std::ranges::transform(names, parameters.distortion.begin(), [&](const std::string& name) { return values[name]; });
  parameters.width = static_cast<int>(values["width"]);
  parameters.height = static_cast<int>(values["height"]);
  Calibration calibration;
  calibration.camera = geometry::CameraModel(with_lens(parameters, lens, origin));
  calibration.depth_factor_given = values.count("depth_factor") != 0;
  calibration.fps_given = values.count("fps") != 0;
  if (calibration.depth_factor_given) calibration.depth_scale_m = 1.0 / values["depth_factor"];
  if (calibration.fps_given) calibration.fps = values["fps"];
  calibration.origin = origin;
  calibration.readout_s = values["readout_s"];
  calibration.depth_offset_s = values["depth_offset_s"];
  return calibration;
}

/// The digit of "freiburg2" or of a word that begins with "fr2"; no second digit may follow.
std::optional<int> family_in(const std::string& name) {
  for (const std::string prefix : {"freiburg", "fr"}) {
    for (std::size_t at = name.find(prefix); at != std::string::npos; at = name.find(prefix, at + 1)) {
      const std::size_t digit = at + prefix.size();
      if (digit >= name.size() || name[digit] < '1' || name[digit] > '3') continue;
      if (digit + 1 < name.size() && std::isdigit(static_cast<unsigned char>(name[digit + 1])) != 0) continue;
      if (prefix == "fr" && at > 0 && std::isalpha(static_cast<unsigned char>(name[at - 1])) != 0) continue;
      return name[digit] - '0';
    }
  }
  return std::nullopt;
}

std::string lower_case(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

}  // namespace

void apply(const Calibration& calibration, SourceInfo& info) {
  check_frame_size(calibration.camera.parameters().width, calibration.camera.parameters().height, calibration.origin);
  info.camera = calibration.camera;
  if (calibration.depth_factor_given || info.depth_scale_m <= 0) info.depth_scale_m = calibration.depth_scale_m;
  info.readout_s = calibration.readout_s;
  info.depth_offset_s = calibration.depth_offset_s;
}

cv::Size size_in_frame(cv::Size image_px) {
  constexpr int kSide = msg::kMaxFrameSide;
  for (int n = 1;; ++n) {
    const cv::Size part(image_px.width / n, image_px.height / n);
    if (std::max(part.width, part.height) <= kSide && std::size_t(part.area()) <= msg::kMaxFramePixels) return part;
  }
}

void check_frame_size(double width, double height, const std::string& origin) {
  if (width >= 1 && height >= 1 && width <= msg::kMaxFrameSide && height <= msg::kMaxFrameSide &&
      width * height <= static_cast<double>(msg::kMaxFramePixels))
    return;
  throw SourceError(
      fmt::format("{}: {:g} x {:g} px, but a frame carries at most 1920 x 1200 px; scale the images down "
                  "and fx fy cx cy with them",
                  origin, width, height));
}

Calibration make_calibration(const std::map<std::string, double>& given, const std::string& origin,
                             std::optional<cv::Size> image_px, LensModel lens) {
  std::map<std::string, double> values = given;
  const bool y_up = values.count("fy") != 0 && values["fy"] < 0;
  if (y_up) values["fy"] = -values["fy"];
  if (values.count("width") == 0 && image_px) values.insert({{"width", image_px->width}, {"height", image_px->height}});
  for (const auto& [key, value] : values)
    if (!in_range(key, value)) throw out_of_range(origin, key, fmt::format("{:g}", value));
  Calibration calibration = from_values(std::move(values), origin, lens);
  calibration.y_up = y_up;
  return calibration;
}

Calibration parse_calibration(const std::string& text, const std::string& origin, std::optional<cv::Size> image_px) {
  if (const std::optional<CalibrationValues> other = read_calibration_form(text, origin))
    return make_calibration(other->values, origin + " (" + other->form + ")", image_px, other->lens);
  std::map<std::string, double> values;
  for (const io::TextLine& line : io::split_lines(text)) {
    if (line.fields.front() == "---" || line.fields.front().front() == '%') continue;  // YAML document start, directive
    if (const auto entry = parse_entry(line, origin); !values.insert(entry).second) {
      throw SourceError(origin + ":" + std::to_string(line.number) + ": key '" + entry.first + "' occurs twice");
    }
  }
  return from_values(std::move(values), origin);
}

Calibration read_calibration(const std::filesystem::path& file, std::optional<cv::Size> image_px,
                             const std::filesystem::path& below) {
  try {
    return parse_calibration(io::read_file(file, io::kCalibration, below), file.string(), image_px);
  } catch (const io::IoError& error) {
    throw SourceError("calibration " + why_unread(error));
  }
}

bool is_bonn_name(const std::string& folder_name) {
  return folder_name.starts_with("rgbd_bonn_");
}

std::optional<Calibration> known_calibration(const std::filesystem::path& folder) {
  const std::filesystem::path path = std::filesystem::absolute(folder);
  const std::vector<std::filesystem::path> parts(path.begin(), path.end());
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    const std::string name = lower_case(part->string());
    if (is_bonn_name(name)) return parse_calibration(bonn_camera_yaml(), "config/cameras/bonn.yaml");
    if (const std::optional<int> family = family_in(name))
      return parse_calibration(tum_camera_yaml(*family), fmt::format("config/cameras/tum_fr{}.yaml", *family));
  }
  return std::nullopt;
}

Calibration load_calibration(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "calibration.yaml";
  if (std::error_code unknown; std::filesystem::exists(file, unknown)) return read_calibration(file);
  if (std::optional<Calibration> known = known_calibration(folder)) return *known;
  throw SourceError("no calibration for " + folder.string() + ": write " + file.string() +
                    " with one 'key: value' a line, keys " + kAllowedKeys +
                    "; or give ?calibration=FILE or ?intrinsics=fx,fy,cx,cy; or name the folder after its TUM camera "
                    "(freiburg1, freiburg2, freiburg3) or its Bonn sequence (rgbd_bonn_NAME)");
}

std::string to_yaml(const Calibration& calibration) {
  const auto& p = calibration.camera.parameters();
  std::string text = fmt::format("width: {}\nheight: {}\nfx: {:.9g}\nfy: {:.9g}\ncx: {:.9g}\ncy: {:.9g}\n", p.width,
                                 p.height, p.fx, p.fy, p.cx, p.cy);
  if (p.lens == geometry::Lens::kFisheye) text += "fisheye: 1\n";
  const std::vector<std::string>& names = coefficient_names(p.lens);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i < 5 || p.distortion[i] != 0) text += fmt::format("{}: {:.9g}\n", names[i], p.distortion[i]);
  }
  text += fmt::format("depth_factor: {:.9g}\nfps: {:.9g}\n", 1.0 / calibration.depth_scale_m, calibration.fps);
  if (calibration.readout_s != 0) text += fmt::format("readout_s: {:.9g}\n", calibration.readout_s);
  if (calibration.depth_offset_s != 0) text += fmt::format("depth_offset_s: {:.9g}\n", calibration.depth_offset_s);
  return text;
}

namespace {

double parse_in(const std::string& uri, const std::string& key, const std::string& value, double least, double most) {
  const std::optional<double> number = io::parse_number(value);
  if (number && *number >= least && *number <= most) return *number;
  throw SourceError(fmt::format("source '{}': {} is '{}', allowed: {:g} to {:g}", io::abridged(uri), key,
                                io::abridged(value), least, most));
}

std::map<std::string, double> parse_intrinsics(const std::string& uri, const std::string& value) {
  constexpr std::array kKeys = {"fx", "fy", "cx", "cy", "width", "height"};
  std::vector<double> numbers;
  if (const auto lines = io::split_lines(value, ", \t"); !lines.empty()) {
    for (const std::string& field : lines.front().fields) {
      const std::optional<double> number = io::parse_number(field);
      if (number && std::isfinite(*number)) numbers.push_back(*number);
    }
    if (numbers.size() != lines.front().fields.size()) numbers.clear();
  }
  if (numbers.size() != 4 && numbers.size() != kKeys.size()) {
    throw SourceError("source '" + io::abridged(uri) + "': intrinsics is '" + io::abridged(value) +
                      "'; write fx,fy,cx,cy or fx,fy,cx,cy,width,height in px");
  }
  std::map<std::string, double> intrinsics;
  for (std::size_t i = 0; i < numbers.size(); ++i) intrinsics[kKeys[i]] = numbers[i];
  return intrinsics;
}

}  // namespace

bool take_calibration_parameter(CalibrationRequest& request, const std::string& uri, const std::string& key,
                                const std::string& value) {
  if (key == "calibration") {
    request.file = value;
  } else if (key == "intrinsics") {
    request.intrinsics = parse_intrinsics(uri, value);
  } else if (key == "depth_factor") {
    request.depth_factor = parse_in(uri, key, value, 1, 1e6);
  } else if (key == "fps") {
    request.fps = parse_in(uri, key, value, 0.1, 1000);
  } else {
    return false;
  }
  return true;
}

Calibration requested_calibration(const CalibrationRequest& request, const std::filesystem::path& folder,
                                  std::optional<cv::Size> image_px) {
  if (!request.intrinsics.empty()) return make_calibration(request.intrinsics, "?intrinsics=", image_px);
  std::filesystem::path file = request.file;
  std::error_code error;
  if (!std::filesystem::exists(file, error) && std::filesystem::exists(folder / file, error)) file = folder / file;
  return read_calibration(file, image_px);
}

}  // namespace rtd::camera
