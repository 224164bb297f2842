// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "services/camera/core/live/device_modes.hpp"

namespace rtd::camera {

/// Why a device gives no images.
enum class DeviceProblem {
  kAbsent,           ///< not plugged in, unplugged, or no answer: it may come back
  kBusy,             ///< another program uses it
  kNoPermission,     ///< the user may not open it
  kUnsupportedMode,  ///< it has no such size, rate or format
  kBandwidth,        ///< the USB port cannot carry the streams
  kEnded,            ///< a recording is at its end
};

/// A device cannot be used now; what() names the device, the cause and the fix.
class DeviceError : public std::runtime_error {
 public:
  DeviceError(DeviceProblem problem, const std::string& what) : std::runtime_error(what), problem_(problem) {}
  DeviceProblem problem() const { return problem_; }

 private:
  DeviceProblem problem_;
};

/// The camera that takes the depth images, when they are not registered to colour.
struct DepthCamera {
  geometry::CameraModel camera;
  Eigen::Isometry3d T_color_depth = Eigen::Isometry3d::Identity();  ///< p_color = T_color_depth * p_depth, m
};

/// What a started device delivers.
struct DeviceSetup {
  DeviceMode color, depth;
  double depth_scale_m = 0.001;  ///< metres of one depth unit
  /// Of the colour image; empty when the device does not know its own lens.
  std::optional<geometry::CameraModel> camera;
  std::optional<DepthCamera> depth_camera;  ///< empty when depth is registered to colour
};

/// An image as the device gives it, not yet decoded (pixel_format.hpp).
struct DeviceImage {
  Stream stream = Stream::kColor;
  std::int64_t stamp_ns = 0;  ///< the device's clock, one for both streams
  std::vector<std::uint8_t> bytes;
};

/// A camera on this host or its network: opened, started, read, and after an error closed and opened again. One thread
/// uses it. Every function but close() throws DeviceError.
class LiveDevice {
 public:
  virtual ~LiveDevice() = default;
  /// "openni2:1d27/0609@1/5": for messages, known before it is opened.
  virtual std::string name() const = 0;
  virtual void open() = 0;
  /// All modes that it has, readable or not; it is open.
  virtual std::vector<DeviceMode> modes() = 0;
  /// Starts both streams in the modes that fit best (choose_mode()); it is open.
  virtual DeviceSetup start(const ModeRequest& request) = 0;
  /// The next image of either stream; empty when none came within the time. kAbsent when it was unplugged.
  virtual std::optional<DeviceImage> read(std::chrono::milliseconds timeout) = 0;
  /// Stops the streams and frees everything; also before open() and twice.
  virtual void close() noexcept = 0;
};

/// The time of a DeviceSource. now_ns() and wait() belong to one thread, close() and closed() are thread-safe.
class DeviceClock {
 public:
  virtual ~DeviceClock() = default;
  virtual std::int64_t now_ns() const = 0;  ///< never goes back
  /// Ends early when the clock is closed.
  virtual void wait(std::chrono::milliseconds time) = 0;
  virtual void close() = 0;
  virtual bool closed() const = 0;
};

}  // namespace rtd::camera
