// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/camera/depth_alignment.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/live_uri.hpp"
#include "common/camera/recording/frame_pairer.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/geometry/transform_log.hpp"
#include "common/vision/depth_registration.hpp"

namespace rtd::camera {

inline constexpr const char* kLastingTransforms = "/tf_static";
inline constexpr const char* kTransforms = "/tf";

/// Where the messages of a running camera come from: topic is the ROS name, recorded_ns when it came. next() belongs to
/// one thread, the rest is thread-safe.
class LiveFeed {
 public:
  virtual ~LiveFeed() = default;
  /// The oldest that waits; empty when none came within the time or the feed is closed.
  virtual std::optional<RecordedMessage> next(std::chrono::milliseconds timeout) = 0;
  /// Drops the waiting messages: they are old by now.
  virtual void clear() = 0;
  /// From now on transforms are left out: they can be many.
  virtual void end_transforms() {}
  /// Ends it and wakes next().
  virtual void close() = 0;
  virtual bool closed() const = 0;
  virtual std::uint64_t dropped() const = 0;  ///< messages that were not fetched in time
  virtual std::int64_t now_ns() const = 0;    ///< clock of recorded_ns
  /// Who publishes a topic, for messages: "it has no publisher in DDS domain 0".
  virtual std::string state_of(const std::string& topic) const = 0;
  /// Whether a publisher of its type is known.
  virtual bool is_published(const std::string& topic) const = 0;
};

/// Frames of a running ROS camera: colour and depth paired by their stamps, as soon as both are there; depth that is
/// not registered to colour is registered by both CameraInfos and the transform between the two frames. It ends only
/// when it is stopped; without frames it waits and reports what is missing.
class LiveSource final : public FrameSource {
 public:
  LiveSource(std::string uri, std::unique_ptr<LiveFeed> feed, LiveOptions options);

  /// Waits for calibration, a first usable pair, whose frame is not given out, and what its depth needs to be
  /// registered. Throws SourceError: encoding, calibration, sizes; and when nothing comes in time, with who publishes
  /// what.
  bool open() override;
  std::optional<SourceFrame> next() override;
  std::uint64_t pass_over(std::int64_t) override { return 0; }  // what is late has been dropped by the feed
  const SourceInfo& info() const override { return info_; }
  const SourceCounters& counters() const override { return skips_.counters(); }
  geometry::Trajectory groundtruth() const override { return {}; }
  std::vector<SkippedInput> take_skipped() override { return skips_.take(); }
  void stop() override { feed_->close(); }

 private:
  /// What has come of one of the two images.
  struct Images {
    bool any = false;
    std::int64_t stamp_ns = 0, arrived_ns = 0;  ///< of the newest
  };

  bool try_to_open(RecordedMessage message);
  void take_calibration(const msg::CameraInfo& info);
  void take_depth_camera(const msg::CameraInfo& info);
  void take_transforms(const RecordedMessage& message);
  std::optional<Eigen::Isometry3d> extrinsics() const;
  void check_first(const FramePairer::Pair& pair);
  /// Sees to it that depth is registered to colour; false while something is missing (lacking_).
  bool align_depth();
  void give_up_aligning() const;
  void check_after_opening() const;
  void take(RecordedMessage message);
  void take_image(RecordedMessage&& message);
  std::optional<FramePairer::Pair> next_pair();
  std::optional<SourceFrame> decode(const FramePairer::Pair& pair);
  void refuse_stepped_clock();
  void count_dropped();
  /// Reports what is missing when no pair has come for a while.
  void report_wait();
  void report_frames();
  std::string missing() const;
  bool silent(const Images& images) const;

  const LiveOptions options_;
  const std::unique_ptr<LiveFeed> feed_;
  SourceInfo info_;
  SkipLog skips_;
  FramePairer pairer_;
  bool calibrated_ = false, waiting_ = false, opened_ = false;
  ImageOrigin color_origin_, depth_origin_;
  std::string unregistered_, lacking_;  ///< why depth must be registered, and what that lacks
  geometry::TransformLog lasting_transforms_, transforms_;
  std::optional<vision::DepthRegistration> registration_;
  Images color_, depth_;
  std::int64_t last_pair_ns_ = 0, reported_ns_ = 0;
  std::optional<std::int64_t> first_lack_ns_;  ///< when a pair came that could not be aligned
  std::uint64_t backwards_at_last_pair_ = 0, dropped_ = 0;
};

}  // namespace rtd::camera
