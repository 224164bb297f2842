// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/realsense/realsense_protocol.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

namespace rtd::camera::realsense {
namespace {

using nlohmann::json;

enum class DataFormat : std::uint32_t { kJson = 0, kCbor = 1 };

constexpr std::array<std::uint8_t, 4> kPlainCdr = {0, 1, 0, 0};
constexpr std::size_t kVersionBytes = 4;
constexpr std::size_t kMaxStreams = 64;

/// Runs what reads JSON; what is missing or of another type is an error of the message.
template <class Reading>
auto reading(const char* what, Reading&& read) {
  try {
    return read();
  } catch (const json::exception& error) {
    throw ros::WireError(std::string(what) + ": " + error.what());
  }
}

double finite(const json& number) {
  const auto value = number.get<double>();
  if (!std::isfinite(value)) throw ros::WireError("a number of the calibration is not finite");
  return value;
}

cv::Size parse_size(const json& width, const json& height) {
  constexpr int kMaxSide = 16384;
  const cv::Size size_px(width.get<int>(), height.get<int>());
  if (size_px.width < 1 || size_px.height < 1 || size_px.width > kMaxSide || size_px.height > kMaxSide) {
    throw ros::WireError("an image of " + width.dump() + " x " + height.dump() + " px");
  }
  return size_px;
}

VideoStream::Profile parse_profile(const json& profile) {
  return {finite(profile.at(0)), profile.at(1).get<std::string>(), parse_size(profile.at(2), profile.at(3))};
}

Intrinsics parse_intrinsics(const json& values) {
  Intrinsics intrinsics;
  intrinsics.size_px = parse_size(values.at("width"), values.at("height"));
  const json &focal = values.at("focal-length"), &center = values.at("principal-point");
  intrinsics.focal_px = {finite(focal.at(0)), finite(focal.at(1))};
  intrinsics.center_px = {finite(center.at(0)), finite(center.at(1))};
  intrinsics.symmetric = values.value("force-symmetry", false);
  if (intrinsics.focal_px.minCoeff() <= 0) throw ros::WireError("a focal length that is not positive");
  const std::string model = values.value("model", "brown");
  intrinsics.lens = lens_model(model);
  if (!values.contains("coefficients") || intrinsics.lens == LensModel::kNone) return intrinsics;
  for (const json& coefficient : values.at("coefficients")) intrinsics.distortion.push_back(finite(coefficient));
  constexpr std::size_t kCoefficients = 5;
  if (intrinsics.distortion.size() != kCoefficients) {
    throw ros::WireError(std::to_string(intrinsics.distortion.size()) + " distortion coefficients, expected 5");
  }
  const bool bent = std::ranges::any_of(intrinsics.distortion, [](double k) { return k != 0; });
  if (intrinsics.lens == LensModel::kUnknown && bent) throw ros::WireError(no_such_lens(model));
  return intrinsics;
}

/// 9 values of the rotation by columns, 3 of the translation.
Eigen::Isometry3d parse_extrinsics(const json& values) {
  if (values.size() != 12) throw ros::WireError("extrinsics of " + std::to_string(values.size()) + " values, not 12");
  Eigen::Isometry3d T_to_from = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 9; ++i) T_to_from.matrix()(i % 3, i / 3) = finite(values[static_cast<std::size_t>(i)]);
  for (int i = 0; i < 3; ++i) T_to_from.translation()[i] = finite(values[static_cast<std::size_t>(9 + i)]);
  const Eigen::Matrix3d R = T_to_from.linear();
  constexpr double kTolerance = 1e-3;
  if (!(R * R.transpose()).isIdentity(kTolerance) || R.determinant() < 0) {
    throw ros::WireError("extrinsics whose first 9 values are not a rotation");
  }
  return T_to_from;
}

/// Options are arrays (name, value, ...) or objects with the same.
std::optional<double> depth_unit_m(const json& options) {
  for (const json& option : options) {
    const json& name = option.is_array() ? option.at(0) : option.at("name");
    if (name != "Depth Units") continue;
    const json& value = option.is_array() ? option.at(1) : option.at("value");
    if (value.is_number() && value.get<double>() > 0) return finite(value);
  }
  return std::nullopt;
}

struct NamedFormat {
  const char *encoding, *format;
};
constexpr std::array kFormatNames = {
    NamedFormat{"rgb8", "RGB8"},   NamedFormat{"bgr8", "BGR8"},        NamedFormat{"mono8", "GREY"},
    NamedFormat{"yuyv", "YUYV"},   NamedFormat{"yuv422_yuy2", "YUYV"}, NamedFormat{"uyvy", "UYVY"},
    NamedFormat{"yuv422", "UYVY"}, NamedFormat{"16UC1", "Z16"},        NamedFormat{"mono16", "Z16"}};

json profile_of(const VideoStream& stream, const DeviceMode& mode) {
  for (const VideoStream::Profile& profile : stream.profiles) {
    const bool same =
        profile.size_px == mode.size_px && profile.fps == mode.fps && pixel_format_of(profile.encoding) == mode.format;
    if (same) return {profile.fps, profile.encoding, profile.size_px.width, profile.size_px.height};
  }
  return {};
}

}  // namespace

json read_flexible(ros::Bytes cdr) {
  ros::ByteCursor cursor(cdr);
  if (!std::ranges::equal(cursor.take(2), std::span(kPlainCdr).first(2))) {
    throw ros::WireError("a flexible message that is not plain little-endian CDR");
  }
  cursor.take(2);
  const auto format = cursor.read<std::uint32_t>();
  cursor.take(kVersionBytes);
  const ros::Bytes data = cursor.take(cursor.read<std::uint32_t>());
  return reading("a flexible message", [&] {
    if (format == static_cast<std::uint32_t>(DataFormat::kCbor)) return json::from_cbor(data);
    if (format == static_cast<std::uint32_t>(DataFormat::kJson)) return json::parse(data);
    throw ros::WireError("a flexible message of format " + std::to_string(format) + ": expected JSON or CBOR");
  });
}

std::vector<std::uint8_t> write_flexible(const json& content) {
  const std::string text = content.dump();
  std::vector<std::uint8_t> cdr(kPlainCdr.begin(), kPlainCdr.end());
  const auto put = [&](std::uint32_t number) {
    for (int shift = 0; shift < 32; shift += 8) cdr.push_back(static_cast<std::uint8_t>(number >> shift));
  };
  put(static_cast<std::uint32_t>(DataFormat::kJson));
  cdr.insert(cdr.end(), kVersionBytes, 0);
  put(static_cast<std::uint32_t>(text.size()));
  cdr.insert(cdr.end(), text.begin(), text.end());
  return cdr;
}

std::optional<DeviceInfo> parse_device_info(const json& message) {
  return reading("a device-info message", [&]() -> std::optional<DeviceInfo> {
    if (message.contains("stopping") || message.value("recovery", false)) return std::nullopt;
    return DeviceInfo{message.at("name").get<std::string>(), message.value("serial", ""),
                      message.at("topic-root").get<std::string>()};
  });
}

geometry::CameraModel Intrinsics::at(cv::Size wanted_px) const {
  Eigen::Vector2d native(size_px.width, size_px.height), center = center_px;
  if (symmetric) {
    for (int axis = 0; axis < 2; ++axis) {
      native[axis] = 1 + 2 * std::floor(std::min(center[axis], native[axis] - 1 - center[axis]));
      center[axis] = (native[axis] - 1) / 2;
    }
  }
  const Eigen::Vector2d wanted(wanted_px.width, wanted_px.height), half(0.5, 0.5);
  const double scale = (wanted.array() / native.array()).maxCoeff();
  center = scale * (center + half) - (scale * native - wanted) / 2 - half;
  geometry::CameraModel::Parameters camera;
  camera.fx = scale * focal_px.x();
  camera.fy = scale * focal_px.y();
  camera.cx = center.x();
  camera.cy = center.y();
  std::ranges::copy(distortion, camera.distortion.begin());
  camera.width = wanted_px.width;
  camera.height = wanted_px.height;
  return geometry::CameraModel(with_lens(camera, lens, "the camera"));
}

std::optional<geometry::CameraModel> VideoStream::camera(cv::Size size_px) const {
  if (intrinsics.empty()) return std::nullopt;
  const auto exact = std::ranges::find(intrinsics, size_px, &Intrinsics::size_px);
  if (exact != intrinsics.end()) return exact->at(size_px);
  const auto area = [](const Intrinsics& one) { return one.size_px.area(); };
  return std::ranges::max_element(intrinsics, {}, area)->at(size_px);
}

void Description::take(const json& notification) {
  reading("a notification", [&] {
    const std::string id = notification.value("id", "");
    if (id == "device-header") take_header(notification);
    if (id == "stream-header") take_stream(notification);
    if (id == "stream-options") take_options(notification);
  });
}

void Description::take_header(const json& header) {
  const auto streams = header.at("n-streams").get<std::size_t>();
  if (streams > kMaxStreams) throw ros::WireError("a device of " + std::to_string(streams) + " streams");
  streams_ = streams;
  if (!header.contains("extrinsics")) return;
  for (const json& edge : header.at("extrinsics")) {
    const auto from = edge.at(0).get<std::string>(), to = edge.at(1).get<std::string>();
    const Eigen::Isometry3d T_to_from = parse_extrinsics(edge.at(2));
    T_to_from_[from][to] = T_to_from;
    T_to_from_[to].try_emplace(from, T_to_from.inverse());
  }
}

void Description::take_stream(const json& header) {
  const auto name = header.at("name").get<std::string>(), type = header.at("type").get<std::string>();
  if (described_.size() >= kMaxStreams) throw ros::WireError("more than 64 streams");
  described_.try_emplace(name, false);
  if (type != "color" && type != "depth") return;
  VideoStream& stream = type == "color" ? color_ : depth_;
  if (!stream.name.empty() && stream.name != name) return;  // the first of its kind is used
  stream.name = name;
  stream.profiles.clear();
  for (const json& profile : header.at("profiles")) stream.profiles.push_back(parse_profile(profile));
}

void Description::take_options(const json& options) {
  const auto name = options.at("stream-name").get<std::string>();
  const auto described = described_.find(name);
  if (described == described_.end()) return;
  described->second = true;
  if (name != color_.name && name != depth_.name) return;
  VideoStream& stream = name == color_.name ? color_ : depth_;
  if (options.contains("intrinsics")) {
    const json& intrinsics = options.at("intrinsics");
    stream.intrinsics.clear();
    for (const json& one : intrinsics.is_array() ? intrinsics : json::array({intrinsics})) {
      stream.intrinsics.push_back(parse_intrinsics(one));
    }
  }
  if (options.contains("options")) stream.unit_m = depth_unit_m(options.at("options")).value_or(stream.unit_m);
}

bool Description::complete() const {
  const auto has_options = [&](const VideoStream& stream) { return stream.name.empty() || described_.at(stream.name); };
  return streams_ > 0 && described_.size() >= streams_ && has_options(color_) && has_options(depth_);
}

std::vector<DeviceMode> Description::modes() const {
  std::vector<DeviceMode> modes;
  for (const auto& [stream, kind] : {std::pair(&color_, Stream::kColor), std::pair(&depth_, Stream::kDepth)}) {
    for (const VideoStream::Profile& profile : stream->profiles) {
      modes.push_back({kind, profile.size_px, profile.fps, pixel_format_of(profile.encoding)});
    }
  }
  return modes;
}

/// Breadth first from depth: the device names some of the edges, the rest follow.
std::optional<Eigen::Isometry3d> Description::T_color_depth() const {
  std::vector<std::pair<std::string, Eigen::Isometry3d>> reached = {{depth_.name, Eigen::Isometry3d::Identity()}};
  std::set<std::string> seen = {depth_.name};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const auto [from, T_from_depth] = reached[i];
    if (from == color_.name) return T_from_depth;
    const auto edges = T_to_from_.find(from);
    if (edges == T_to_from_.end()) continue;
    for (const auto& [to, T_to_from] : edges->second) {
      if (seen.insert(to).second) reached.emplace_back(to, T_to_from * T_from_depth);
    }
  }
  return std::nullopt;
}

json open_streams(const Description& device, const DeviceMode& color, const DeviceMode& depth) {
  return {{"id", "open-streams"},
          {"stream-profiles",
           {{device.color().name, profile_of(device.color(), color)},
            {device.depth().name, profile_of(device.depth(), depth)}}}};
}

std::string stream_topic(const DeviceInfo& device, const std::string& stream) {
  std::string topic = "rt/" + device.topic_root + '_' + stream;
  std::ranges::replace(topic, ' ', '_');
  return topic;
}

std::string pixel_format_of(const std::string& encoding) {
  for (const auto& [name, format] : kFormatNames) {
    if (encoding == name) return format;
  }
  return encoding;
}

}  // namespace rtd::camera::realsense
