// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/calibration_forms.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/camera/settings_text.hpp"
#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

using Values = std::map<std::string, double>;
using Names = std::vector<std::string>;
using Numbers = std::vector<double>;

const Names kBrown = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}, kFisheye = {"k1", "k2", "k3", "k4"};

void set(Values& values, const Names& names, const Numbers& numbers) {
  for (std::size_t i = 0; i < std::min(names.size(), numbers.size()); ++i) values[names[i]] = numbers[i];
}

/// The first of the paths that has a number.
void take(Values& values, const std::string& name, const SettingsText& text, const Names& paths) {
  for (const std::string& path : paths) {
    if (const auto number = text.number(path)) {
      values.emplace(name, *number);
      return;
    }
  }
}

/// Throws SourceError for a lens that no model here fits.
void set_lens(CalibrationValues& found, const std::string& model, const Numbers& coefficients,
              const std::string& origin) {
  found.lens = lens_model(model);
  if (found.lens == LensModel::kUnknown)
    throw SourceError(origin + ": " + no_such_lens(model) + "; rectify the images, or calibrate with one of these");
  set(found.values, found.lens == LensModel::kFisheye ? kFisheye : kBrown, coefficients);
}

/// 3 x 3 or 4 x 4, by rows; with zeros in the third column by columns, as Open3D writes it.
bool set_matrix(Values& values, const Numbers& m) {
  if (m.size() < 9) return false;
  const bool wide = m.size() >= 16 && m[3] == 0 && m[7] == 0 && m[10] == 1 && m[15] == 1;
  const bool by_columns = !wide && m[2] == 0 && m[5] == 0;
  const std::size_t width = wide ? 4 : 3;
  values["fx"] = m[0];
  values["fy"] = m[width + 1];
  values["cx"] = by_columns ? m[6] : m[2];
  values["cy"] = by_columns ? m[7] : m[width + 2];
  return true;
}

void take_depth_scale(Values& values, const SettingsText& text, const Names& paths) {
  Values found;
  take(found, "scale", text, paths);
  if (found.empty() || !(found["scale"] > 0)) return;
  values["depth_factor"] = found["scale"] < 1 ? 1 / found["scale"] : found["scale"];  // metres of a unit, or units
}

/// ORB-SLAM2, ORB-SLAM3 ("Camera1"), stella_vslam and its forerunner: one key a line, or nested below Camera.
std::optional<CalibrationValues> read_orb_slam(const SettingsText& text, const std::string& origin) {
  const std::string camera = text.has("Camera1.fx") ? "Camera1" : "Camera";
  if (!text.has(camera + ".fx")) return std::nullopt;
  const bool stella = text.has("Camera.setup") || text.has("Camera.cols");
  CalibrationValues found{stella               ? "stella_vslam settings"
                          : camera == "Camera" ? "ORB-SLAM2 settings"
                                               : "ORB-SLAM3 settings",
                          {}};
  for (const char* const key : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"})
    take(found.values, key, text, {camera + "." + key});
  take(found.values, "width", text, {"Camera.width", "Camera.cols"});
  take(found.values, "height", text, {"Camera.height", "Camera.rows"});
  take(found.values, "fps", text, {"Camera.fps"});
  take(found.values, "depth_factor", text,
       {"DepthMapFactor", "RGBD.DepthMapFactor", "depthmap_factor", "Preprocessing.depthmap_factor",
        "Camera.depthmap_factor"});
  if (found.values["depth_factor"] == 0) found.values.erase("depth_factor");
  set_lens(found, text.text(text.has("Camera.model") ? "Camera.model" : "Camera.type"), {}, origin);
  if (found.lens == LensModel::kFisheye)
    for (const char* const key : {"p1", "p2", "k5", "k6"}) found.values.erase(key);
  return found;
}

/// What camera_calibration and OpenCV write, and a printed CameraInfo.
std::optional<CalibrationValues> read_camera_info(const SettingsText& text, const std::string& origin) {
  CalibrationValues found{"ROS camera_info", {}};
  Numbers matrix, distortion;
  for (const char* const path : {"camera_matrix.data", "K", "k", "Camera_Matrix.data", "K.data"})
    if (matrix.size() < 9) matrix = text.numbers(path);
  if (!set_matrix(found.values, matrix)) return std::nullopt;
  for (const char* const path : {"distortion_coefficients.data", "D", "d", "Distortion_Coefficients.data", "D.data"})
    if (distortion.empty()) distortion = text.numbers(path);
  take(found.values, "width", text, {"image_width", "width", "image_Width"});
  take(found.values, "height", text, {"image_height", "height", "image_Height"});
  set_lens(found, text.text("distortion_model"), distortion, origin);
  return found;
}

/// Kalibr's camchain, of several cameras the first; EuRoC's sensor.yaml has the same without "cam0".
std::optional<CalibrationValues> read_kalibr(const SettingsText& text, const std::string& origin) {
  const std::string camera = text.has("cam0.intrinsics") ? "cam0." : "";
  const Numbers intrinsics = text.numbers(camera + "intrinsics"), size = text.numbers(camera + "resolution");
  if (intrinsics.size() < 4 || size.size() != 2) return std::nullopt;
  CalibrationValues found{camera.empty() ? "EuRoC sensor" : "Kalibr camchain", {}};
  set_lens(found, text.text(camera + "camera_model"), {}, origin);
  set(found.values, {"fx", "fy", "cx", "cy"}, intrinsics);
  set(found.values, {"width", "height"}, size);
  const bool kalibr = text.has(camera + "distortion_coeffs");
  set_lens(found, text.text(camera + "distortion_model"),
           text.numbers(camera + (kalibr ? "distortion_coeffs" : "distortion_coefficients")), origin);
  take(found.values, "fps", text, {"rate_hz"});
  return found;
}

/// The RealSense D400's colour camera, whose four numbers are fx cx fy cy.
std::optional<CalibrationValues> read_openloris(const SettingsText& text, const std::string& origin) {
  const std::string camera = "d400_color_optical_frame.";
  const Numbers intrinsics = text.numbers(camera + "intrinsics.data");
  if (intrinsics.size() != 4) return std::nullopt;
  CalibrationValues found{"OpenLORIS sensors", {{"depth_factor", 1000}}};
  set(found.values, {"fx", "cx", "fy", "cy"}, intrinsics);
  for (const char* const key : {"width", "height", "fps"}) take(found.values, key, text, {camera + key});
  set_lens(found, {}, text.numbers(camera + "distortion_coefficients.data"), origin);
  return found;
}

std::optional<CalibrationValues> read_open3d(const SettingsText& text, const std::string& /*origin*/) {
  const std::string path = text.path_of("intrinsic_matrix");
  CalibrationValues found{"Open3D intrinsics", {}};
  if (path.empty() || !set_matrix(found.values, text.numbers(path))) return std::nullopt;
  const std::string parent = path.substr(0, path.size() - std::string("intrinsic_matrix").size());
  for (const char* const key : {"width", "height"}) take(found.values, key, text, {parent + key});
  take_depth_scale(found.values, text, {"depth_scale", parent + "depth_scale"});
  take(found.values, "fps", text, {"fps"});
  return found;
}

/// m_calibrationColorIntrinsic of BundleFusion, fx_color of ScanNet: `key = value`.
std::optional<CalibrationValues> read_sens_info(const SettingsText& text, const std::string& /*origin*/) {
  CalibrationValues found{"ScanNet", {}};
  if (set_matrix(found.values, text.numbers("m_calibrationColorIntrinsic"))) found.form = "BundleFusion";
  for (const char* const key : {"fx", "fy"}) take(found.values, key, text, {std::string(key) + "_color"});
  take(found.values, "cx", text, {"mx_color", "cx_color"});
  take(found.values, "cy", text, {"my_color", "cy_color"});
  if (found.values.size() != 4) return std::nullopt;
  take(found.values, "width", text, {"colorWidth", "m_colorWidth"});
  take(found.values, "height", text, {"colorHeight", "m_colorHeight"});
  take(found.values, "depth_factor", text, {"depthShift", "m_depthShift"});
  return found;
}

/// JSON of NeRF tools, RealSense, Replica and others: fx fy cx cy under several names.
std::optional<CalibrationValues> read_json(const SettingsText& text, const std::string& origin) {
  CalibrationValues found{"JSON", {}};
  const auto take_any = [&](const std::string& name, const Names& names) {
    for (const std::string& other : names) take(found.values, name, text, {text.path_of(other)});
  };
  take_any("fx", {"fx", "fl_x", "focal_x"});
  take_any("fy", {"fy", "fl_y", "focal_y"});
  take_any("cx", {"cx", "ppx", "principal_x"});
  take_any("cy", {"cy", "ppy", "principal_y"});
  if (found.values.size() != 4) return std::nullopt;
  take_any("width", {"width", "w"});
  take_any("height", {"height", "h"});
  for (const std::string& key : kBrown) take_any(key, {key});
  std::string model;
  for (const char* const name : {"camera_model", "distortion_model", "model"})  // the last may be that of a phone
    if (const std::string named = text.text(text.path_of(name)); model.empty()) model = named;
  if (text.path_of("camera_model").empty() && text.path_of("distortion_model").empty() &&
      lens_model(model) == LensModel::kUnknown)
    model.clear();
  Numbers coefficients;
  for (const char* const name : {"coeffs", "distortion_coefficients", "distortion_coeffs"})
    if (coefficients.empty()) coefficients = text.numbers(text.path_of(name));
  set_lens(found, model, coefficients, origin);
  take_any("fps", {"fps"});
  take_depth_scale(found.values, text,
                   {text.path_of("depth_scale"), text.path_of("scale"), text.path_of("png_depth_scale")});
  return found;
}

struct ColmapModel {
  const char* name;
  Names parameters;
};

/// `CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS...`, of several cameras the first.
std::optional<CalibrationValues> read_colmap(const std::string& text) {
  static const std::vector<ColmapModel> models = {
      {"SIMPLE_PINHOLE", {"fx", "cx", "cy"}},
      {"PINHOLE", {"fx", "fy", "cx", "cy"}},
      {"SIMPLE_RADIAL", {"fx", "cx", "cy", "k1"}},
      {"RADIAL", {"fx", "cx", "cy", "k1", "k2"}},
      {"OPENCV", {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}},
      {"FULL_OPENCV", {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}},
      {"OPENCV_FISHEYE", {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}}};
  const std::vector<io::TextLine> lines = io::split_lines(text);
  if (lines.empty() || lines.front().fields.size() < 7) return std::nullopt;
  const std::vector<std::string>& fields = lines.front().fields;
  const auto model = std::ranges::find(models, fields[1], &ColmapModel::name);
  if (model == models.end() || fields.size() != 4 + model->parameters.size()) return std::nullopt;
  Numbers numbers;
  for (std::size_t i = 2; i < fields.size(); ++i) numbers.push_back(io::parse_number(fields[i]).value_or(0));
  CalibrationValues found{"COLMAP cameras", {}};
  Names names = {"width", "height"};
  names.insert(names.end(), model->parameters.begin(), model->parameters.end());
  set(found.values, names, numbers);
  if (found.values.count("fy") == 0) found.values["fy"] = found.values["fx"];
  found.lens = lens_model(model->name);
  return found;
}

/// Nothing but numbers: `fx fy cx cy`, with the size behind it, or a matrix.
std::optional<CalibrationValues> read_numbers(const std::string& text) {
  Numbers numbers;
  for (const io::TextLine& line : io::split_lines(text, " \t\r\v\f,;[]")) {
    for (const std::string& field : line.fields) {
      const std::optional<double> number = io::parse_number(field);
      if (!number || numbers.size() > 16) return std::nullopt;
      numbers.push_back(*number);
    }
  }
  CalibrationValues found{"numbers", {}};
  if (numbers.size() == 4 || numbers.size() == 6) {
    set(found.values, {"fx", "fy", "cx", "cy", "width", "height"}, numbers);
    return found;
  }
  if (numbers.size() != 9 && numbers.size() != 16) return std::nullopt;
  found.form = "matrix";
  set_matrix(found.values, numbers);
  return found;
}

}  // namespace

std::optional<CalibrationValues> read_calibration_form(const std::string& text, const std::string& origin) {
  constexpr std::array kReaders = {read_orb_slam, read_openloris, read_kalibr,
                                   read_open3d,   read_sens_info, read_camera_info};
  if (auto numbers = read_numbers(text)) return numbers;
  if (auto cameras = read_colmap(text)) return cameras;
  const SettingsText settings(text);
  for (const auto reader : kReaders)
    if (auto found = reader(settings, origin)) return found;
  const bool json = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF") != std::string::npos &&
                    text[text.find_first_not_of(" \t\r\n\xEF\xBB\xBF")] == '{';
  return json ? read_json(settings, origin) : std::nullopt;
}

}  // namespace rtd::camera
