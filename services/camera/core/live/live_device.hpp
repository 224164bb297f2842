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

#include "common/camera/frame_source.hpp"
#include "common/camera/recording/frame_pairer.hpp"
#include "common/camera/recording/ros_images.hpp"
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
  kChanged,          ///< images or calibration are others than before: it begins again with these
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
  std::vector<std::string> remarks = {};    ///< what is wrong with the images although they can be used
  bool stamped_by_arrival = false;          ///< stamps are those of DeviceClock: the driver gives none
  std::string frame_id = {};                ///< as SourceInfo::frame_id
};

/// An image as the device gives it, not yet decoded.
struct DeviceImage {
  Stream stream = Stream::kColor;
  std::int64_t stamp_ns = 0;  ///< the device's clock, one for both streams
  RecordedMessage message;    ///< a device of this host gives the bytes alone, without topic and time
};

/// What has come of a stream.
struct Arrivals {
  bool silent = true;
  std::int64_t stamp_ns = 0;  ///< of the newest
};

/// A camera on this host or its network: opened, started, read, and after an error closed and opened again. Or one that
/// another program runs (a ROS driver): it is read as it comes, with the stamps of that program, and never started
/// again. One thread uses it. Functions throw DeviceError for what may pass, where nothing else is said.
class LiveDevice {
 public:
  virtual ~LiveDevice() = default;
  /// "openni2:1d27/0609@1/5": for messages, known before it is opened.
  virtual std::string name() const = 0;
  virtual void open() = 0;
  /// Starts both streams in the modes that fit best (choose_mode()); it is open. Empty: another program runs it, and
  /// setup_by() gives its setup.
  virtual std::optional<DeviceSetup> start(const ModeRequest& request) = 0;
  /// The setup by a first pair of images and what is known from a calibration file; empty while something lacks.
  virtual std::optional<DeviceSetup> setup_by(const FramePairer::Pair& /*first*/, const SourceInfo& /*known*/) {
    return std::nullopt;
  }
  /// The next image of either stream; empty when none came within the time. kAbsent when it was unplugged.
  virtual std::optional<DeviceImage> read(std::chrono::milliseconds timeout) = 0;
  /// Takes the images from now on as its first ones: they are others than before.
  virtual void begin_again() {}
  /// Drops the images that wait: they are old by now.
  virtual void drop_waiting() {
    for (int i = 0; i < kMostWaiting && read(std::chrono::milliseconds(0)); ++i) {
    }
  }
  /// CV_8UC3 BGR or CV_16UC1, 0 = no measurement, or a problem. Throws SourceError for what no image will be better in.
  virtual ImageRead decode(const DeviceMode& mode, const RecordedMessage& message) const {
    return decode_image(mode, message.bytes, name_of(message));
  }
  /// What did not become an image since the last call.
  virtual std::vector<SkippedInput> take_skipped() { return {}; }
  /// Why no frame comes, by what has come of the streams; empty: there is nothing else to say.
  virtual std::string why_no_frame(const Arrivals& /*color*/, const Arrivals& /*depth*/) const { return {}; }
  /// Stops the streams and frees everything; also before open() and twice.
  virtual void close() noexcept = 0;

 private:
  static constexpr int kMostWaiting = 64;
};

/// A camera that was looked for and found.
struct FoundCamera {
  std::string uri;   ///< for --source
  std::string name;  ///< for people
  std::vector<DeviceMode> modes;
  std::string problem;  ///< why it cannot be used now; empty when it can
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
