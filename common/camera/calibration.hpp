// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>

#include "common/camera/lens_models.hpp"
#include "common/geometry/camera_model.hpp"

namespace rtd::camera {

/// The content of a calibration.yaml, or of what another program writes in its place.
struct Calibration {
  geometry::CameraModel camera;
  double depth_scale_m = 1.0 / 5000.0;  ///< metres of one depth unit; the file gives its inverse, depth_factor
  double fps = 30.0;                    ///< Hz
  double readout_s = 0;       ///< of the colour image's rolling shutter, first row to last, s; 0 = none or unknown
  double depth_offset_s = 0;  ///< added to the difference of the stamps of depth and colour, s
  std::string origin;         ///< "orb2.yaml (ORB-SLAM2 settings)": for people
  bool depth_factor_given = false;  ///< the file says it
  bool fps_given = false;
  bool y_up = false;  ///< fy was negative: true poses belong to a camera whose y axis points up
};

/// Reads "key: value" lines with the keys width height fx fy cx cy (needed) fisheye k1 k2 p1 p2 k3 k4 k5 k6
/// depth_factor fps readout_s depth_offset_s, or a form of calibration_forms.hpp. `image_px` is the size where the text
/// has none. Throws SourceError naming `origin`, line and fix: unknown or doubled key, not a finite number, out of
/// range, size not known.
Calibration parse_calibration(const std::string& text, const std::string& origin,
                              std::optional<cv::Size> image_px = std::nullopt);

/// The same of a file, which must not lead out of the folder `below` (io::open_regular; empty: it may). Throws
/// SourceError also when it cannot be read.
Calibration read_calibration(const std::filesystem::path& file, std::optional<cv::Size> image_px = std::nullopt,
                             const std::filesystem::path& below = {});

/// The pinhole camera of these values; `origin` is for messages. A negative fy is taken for the positive one. Throws
/// SourceError.
Calibration make_calibration(const std::map<std::string, double>& values, const std::string& origin,
                             std::optional<cv::Size> image_px, LensModel lens = LensModel::kBrownConrady);

struct SourceInfo;
/// What the calibration says about a source; neither its rate nor anything else changes. A depth unit that is known
/// stays unless the calibration gives one. Throws SourceError for a size above the frame type's.
void apply(const Calibration& calibration, SourceInfo& info);

/// Of images of so many pixels what a frame carries: all, else the most with a whole number as one in each direction.
cv::Size size_in_frame(cv::Size image_px);

/// Throws SourceError naming `origin` for images larger than the frame type.
void check_frame_size(double width_px, double height_px, const std::string& origin);

/// Calibration of a TUM-layout folder: its calibration.yaml, else that of the camera that its path names, the innermost
/// folder first (freiburg1 or fr1, ..., rgbd_bonn_...; the values of config/cameras/, compiled in). Throws SourceError
/// with what to write.
Calibration load_calibration(const std::filesystem::path& folder);

/// The calibration of the camera that the path names; empty when it names none.
std::optional<Calibration> known_calibration(const std::filesystem::path& folder);

/// Whether the name of a folder is that of a sequence of the Bonn RGB-D Dynamic Dataset: rgbd_bonn_balloon, ...
bool is_bonn_name(const std::string& folder_name);

/// The calibration as a file that parse_calibration() reads back.
std::string to_yaml(const Calibration& calibration);

/// Text of config/cameras/tum_fr<family>.yaml, family 1..3. The definition is generated from these files.
const std::string& tum_camera_yaml(int family);

/// Text of config/cameras/bonn.yaml, the camera of the Bonn RGB-D Dynamic Dataset. Generated as above.
const std::string& bonn_camera_yaml();

/// What the parameters of a source say about its camera: ?calibration=FILE, ?intrinsics=fx,fy,cx,cy[,width,height],
/// ?depth_factor=UNITS_PER_METRE, ?fps=HZ.
struct CalibrationRequest {
  std::string file;
  std::map<std::string, double> intrinsics;  ///< keys of calibration.yaml; empty: none given
  std::optional<double> depth_factor, fps;

  /// Whether they give the camera itself.
  bool has_camera() const { return !file.empty() || !intrinsics.empty(); }
};

/// For messages.
inline constexpr const char* kCalibrationParameters = "calibration, depth_factor, intrinsics";

/// Takes a parameter that is one of these; false for another. Throws SourceError naming `uri`, value and what is
/// allowed.
bool take_calibration_parameter(CalibrationRequest& request, const std::string& uri, const std::string& key,
                                const std::string& value);

/// The camera that is asked for; its file may lie in `folder`. Throws SourceError, also when has_camera() is false.
Calibration requested_calibration(const CalibrationRequest& request, const std::filesystem::path& folder,
                                  std::optional<cv::Size> image_px);

}  // namespace rtd::camera
