// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/depth_alignment.hpp"
#include "common/camera/live_uri.hpp"
#include "common/camera/recording/emitter_switch.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/geometry/transform_log.hpp"
#include "services/camera/core/live/live_device.hpp"

namespace rtd::camera {

inline constexpr const char* kLastingTransforms = "/tf_static";
inline constexpr const char* kTransforms = "/tf";

/// Where the messages of a running camera come from: topic is the ROS name, recorded_ns when it came. One thread uses
/// it.
class LiveFeed {
 public:
  virtual ~LiveFeed() = default;
  /// The oldest that waits; empty when none came within the time.
  virtual std::optional<RecordedMessage> next(std::chrono::milliseconds timeout) = 0;
  /// Drops the waiting messages: they are old by now.
  virtual void clear() = 0;
  /// From now on transforms are left out: they can be many.
  virtual void end_transforms() {}
  virtual std::uint64_t dropped() const = 0;             ///< messages that were not fetched in time
  virtual std::uint64_t of_others() const { return 0; }  ///< colour images of a second publisher: the first is followed
  virtual std::int64_t now_ns() const = 0;               ///< clock of recorded_ns
  /// Who publishes a topic, for messages: "it has no publisher in DDS domain 0".
  virtual std::string state_of(const std::string& topic) const = 0;
  /// Whether a publisher of its type is known.
  virtual bool is_published(const std::string& topic) const = 0;
};

/// The topics of a ROS camera driver as a device: it needs no start, and its setup is that of its first images. Depth
/// that is not registered to colour is registered by both CameraInfos and the transform between the two frames.
class Ros2Device final : public LiveDevice {
 public:
  Ros2Device(std::string uri, std::unique_ptr<LiveFeed> feed, LiveOptions options);

  std::string name() const override { return uri_; }
  void open() override {}
  std::optional<DeviceSetup> start(const ModeRequest&) override { return std::nullopt; }
  /// Throws SourceError for encodings and sizes that cannot be used.
  std::optional<DeviceSetup> setup_by(const FramePairer::Pair& first, const SourceInfo& known) override;
  /// Throws SourceError: calibration, stamps that went back, depth that must be registered and cannot be; DeviceError,
  /// kChanged: a CameraInfo that is another than before.
  std::optional<DeviceImage> read(std::chrono::milliseconds timeout) override;
  void begin_again() override;
  void drop_waiting() override;
  ImageRead decode(const DeviceMode& mode, const RecordedMessage& message) const override;
  std::vector<SkippedInput> take_skipped() override;
  std::string why_no_frame(const Arrivals& color, const Arrivals& depth) const override;
  void close() noexcept override {}

 private:
  bool calibrated() const { return color_origin_.camera || !options_.calibration_file.empty(); }
  std::optional<DeviceImage> take(RecordedMessage& message);
  std::optional<DeviceImage> take_image(RecordedMessage& message);
  void take_calibration(const msg::CameraInfo& info);
  void take_depth_camera(const msg::CameraInfo& info);
  void take_transforms(const RecordedMessage& message);
  void note_color(std::int64_t stamp_ns);
  bool is_of_other_camera(const RecordedMessage& message);
  bool shows_dots(const RecordedMessage& color);
  /// Empty while the stamps of the driver are 0 and it is not clear that they stay so.
  std::optional<std::int64_t> stamp_of(const RecordedMessage& message);
  void watch_calibration(const msg::CameraInfo& info);
  std::optional<Eigen::Isometry3d> extrinsics() const;
  /// Takes over what the first images are; false while the CameraInfo is that of another size.
  bool check_first(const FramePairer::Pair& pair, const SourceInfo& known);
  bool may_still_fit(const std::string& mismatch);
  /// Sees to it that depth is registered to colour; false while something is missing (lacking_).
  bool align_depth();
  std::string lack() const;
  void give_up_aligning() const;
  void check_after_opening() const;

  const std::string uri_;
  const std::unique_ptr<LiveFeed> feed_;
  const LiveOptions options_;
  bool opened_ = false;       ///< frames are given out from now on
  bool begun_again_ = false;  ///< drop_waiting() is not called a second time
  ImageOrigin color_origin_, depth_origin_;
  double unit_m_ = 0;                     ///< of depth
  double float_step_ = kFloatDepthUnitM;  ///< of depth in floats: what becomes a unit, in the unit of the floats
  int grey_bits_ = 16;                    ///< of 16-bit grey, by the first image
  EmitterSwitch emitter_;                 ///< of infrared in place of colour
  std::string unregistered_, lacking_;    ///< why depth must be registered, and what that lacks
  geometry::TransformLog lasting_transforms_, transforms_;
  std::optional<DepthCamera> depth_camera_;      ///< when depth is to be registered
  std::optional<std::int64_t> first_lack_ns_;    ///< when a pair came that could not be aligned
  std::optional<std::int64_t> first_misfit_ns_;  ///< when a pair came that the CameraInfo does not fit
  std::optional<msg::CameraInfo> newest_info_, newest_depth_info_;
  std::uint64_t recalibrated_ = 0;  ///< colour images in a row since CameraInfo is another
  std::uint64_t unstamped_ = 0;     ///< images so far, if all have the stamp 0
  bool by_arrival_ = false;         ///< images have the time of their arrival in place of a stamp
  std::vector<std::string> remarks_;
  std::int64_t newest_color_ns_ = std::numeric_limits<std::int64_t>::min();
  std::uint64_t stepped_ = 0;  ///< colour images in a row that are older
  std::uint64_t dropped_ = 0, of_others_ = 0;
  std::uint64_t other_camera_ = 0;  ///< colour images in a row that are in another frame
  std::vector<SkippedInput> skipped_;
};

}  // namespace rtd::camera
