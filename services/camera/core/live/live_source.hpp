// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "services/camera/core/live/live_feed.hpp"
#include "services/camera/core/live/live_options.hpp"
#include "services/camera/core/recording/frame_pairer.hpp"
#include "services/camera/core/skip_log.hpp"

namespace rtd::camera {

/// Frames of a running ROS camera: colour and depth paired by their stamps, as soon as both are there. It ends only
/// when it is stopped; while nothing comes it waits and says for what.
class LiveSource final : public FrameSource {
 public:
  LiveSource(std::string uri, std::unique_ptr<LiveFeed> feed, LiveOptions options);

  /// Waits for calibration and a first usable pair, whose frame is not given out. Throws SourceError: encoding,
  /// calibration, sizes; and when nothing comes in time, with who publishes what.
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
    std::string type;           ///< empty: nothing
    std::int64_t stamp_ns = 0;  ///< newest
    std::int64_t heard_ns = 0;
  };

  bool try_to_open(LiveMessage message);
  void take_calibration(const LiveMessage& message);
  void check_first(const FramePairer::Pair& pair);
  void take(LiveMessage message);
  std::optional<FramePairer::Pair> next_pair();
  std::optional<SourceFrame> decode(const FramePairer::Pair& pair);
  void refuse_stepped_clock();
  void count_dropped();
  /// Tells what is missing when no pair has come for a while.
  void tell_wait();
  void tell_frames_come();
  std::string missing() const;
  bool silent(const Images& images) const;

  const LiveOptions options_;
  const std::unique_ptr<LiveFeed> feed_;
  SourceInfo info_;
  SkipLog skips_;
  FramePairer pairer_;
  bool calibrated_ = false, waiting_ = false;
  Images color_, depth_;
  std::int64_t last_pair_ns_ = 0, told_ns_ = 0;
  std::uint64_t backwards_at_last_pair_ = 0, dropped_ = 0;
};

}  // namespace rtd::camera
