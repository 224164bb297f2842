// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/lens_models.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/ros_codec/byte_cursor.hpp"
#include "services/camera/core/live/device_modes.hpp"

/// What RealSense cameras say about themselves over DDS: flexible messages (JSON) on `realsense/device-info` and
/// `TOPIC_ROOT/notification`, as librealsense documents them (third-party/realdds/doc). Pure functions and values.
namespace rtd::camera::realsense {

inline constexpr const char* kDeviceInfoTopic = "realsense/device-info";
inline constexpr const char* kFlexibleType = "realdds::topics::raw::flexible";

/// The JSON or CBOR of a flexible message in CDR. Throws ros::WireError.
nlohmann::json read_flexible(ros::Bytes cdr);
/// A flexible message in CDR with this JSON.
std::vector<std::uint8_t> write_flexible(const nlohmann::json& content);

struct DeviceInfo {
  std::string name, serial;
  std::string topic_root;  ///< of its other topics: "realsense/D555_1234"
  bool operator==(const DeviceInfo&) const = default;
};

/// Empty for a message that announces no usable device: going offline ("stopping"), or being updated ("recovery").
/// Throws ros::WireError when name or topic root are missing.
std::optional<DeviceInfo> parse_device_info(const nlohmann::json& message);

/// Calibration of a video stream at its native size; others are scaled and cropped from it.
struct Intrinsics {
  cv::Size size_px;
  Eigen::Vector2d focal_px, center_px;
  std::vector<double> distortion;  ///< five of the lens, or none
  LensModel lens = LensModel::kBrownConrady;
  bool symmetric = false;  ///< images are cropped so that the principal point is in their middle
  /// Of the stream's images of this size: scaled by the larger of the two ratios, then cropped in the middle.
  geometry::CameraModel at(cv::Size size_px) const;
};

/// One of the two streams that are used.
struct VideoStream {
  struct Profile {
    double fps = 0;
    std::string encoding;  ///< as the device names it: "rgb8", "16UC1"
    cv::Size size_px;
  };
  std::string name;  ///< "Color", "Depth"
  std::vector<Profile> profiles;
  std::vector<Intrinsics> intrinsics;
  double unit_m = 0.001;  ///< of depth
  /// Those of the size, else scaled from the largest; empty when the device named none.
  std::optional<geometry::CameraModel> camera(cv::Size size_px) const;
};

/// The description of a device, put together from its notifications.
class Description {
 public:
  /// Others than those that describe the device are passed over. Throws ros::WireError for one that is malformed.
  void take(const nlohmann::json& notification);
  /// All streams, and the options of colour and depth, have been described.
  bool complete() const;
  const VideoStream& color() const { return color_; }
  const VideoStream& depth() const { return depth_; }
  /// Of both streams; formats as in pixel_format.hpp where it has them.
  std::vector<DeviceMode> modes() const;
  /// p_color = T_color_depth * p_depth, m; empty when the device does not connect the two.
  std::optional<Eigen::Isometry3d> T_color_depth() const;

 private:
  void take_header(const nlohmann::json& header);
  void take_stream(const nlohmann::json& header);
  void take_options(const nlohmann::json& options);

  std::size_t streams_ = 0;
  std::map<std::string, bool> described_;  ///< stream -> its options have come
  VideoStream color_, depth_;
  std::map<std::string, std::map<std::string, Eigen::Isometry3d>> T_to_from_;  ///< [from][to]
};

/// The control message that asks for these modes of the two streams.
nlohmann::json open_streams(const Description& device, const DeviceMode& color, const DeviceMode& depth);

/// The topic of a stream's images: "rt/realsense/D555_1234_Color".
std::string stream_topic(const DeviceInfo& device, const std::string& stream);

/// pixel_format.hpp's name of an encoding ("rgb8" -> "RGB8"), or the encoding itself.
std::string pixel_format_of(const std::string& encoding);

}  // namespace rtd::camera::realsense
