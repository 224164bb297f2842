// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"
#include "common/run_record/run_record.hpp"

namespace rtd::launcher {

/// Content of the status line, as of the newest tracked frame.
struct LiveStatus {
  std::uint64_t frames = 0;    ///< frames of the source so far
  std::uint64_t total = 0;     ///< length of the source, 0 = unknown or endless
  std::string camera_message;  ///< the camera's own status, e.g. what it waits for
  bool tracking = false;       ///< false until the first TrackingResult: the fields below are empty
  msg::TrackingState state = msg::TrackingState::kInitializing;
  double frames_per_s = 0;  ///< over the last second or so
  std::uint32_t inliers = 0;
  std::uint32_t dynamic_points = 0;
  std::uint64_t dropped = 0;  ///< lost between camera and pose
  double latency_ms = 0;      ///< camera -> pose, median of the last frames
};

/// Services of others in the domain that disturb no run, besides recorders, which only subscribe.
struct Tolerated {
  bool detector = false;         ///< it runs on another host
  bool harmless_replay = false;  ///< a replay that plays no topic of a run: its metric run_topics is 0
  bool silent_replay = false;    ///< one that has not reported yet what it plays
};

/// Where the frames of a run are kept until its report is made, in the order of their numbers.
class FrameStore {
 public:
  virtual ~FrameStore() = default;
  /// False: it could not be kept.
  virtual bool append(const run_record::FrameRecord& frame) = 0;
  virtual std::vector<run_record::FrameRecord> read() = 0;
};

/// Where a camera was at a frame.
struct FramePlace {
  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0, published_ns = 0;
};

/// Joins the message streams of a run into its record. Messages may be missing, doubled or out of order: the first
/// message of a frame counts, because later ones answer a frame that was sent again. A camera that was restarted
/// continues the numbers of its frames. Memory is bounded: of the frames the newest kJoined are in memory, the
/// ones before in the store; services, counters and notices have a largest number. Not thread-safe.
class RecordBuilder {
 public:
  static constexpr std::size_t kJoined = 512;  ///< frames whose features or result may still come
  /// A frame that claims to be farther ahead of all frames seen is not one of this run.
  static constexpr std::uint64_t kFarthestAhead = 1'000'000;
  static constexpr std::size_t kMaxServices = 64, kMaxCounters = 256, kMaxNotices = 1000;

  /// `store` outlives this.
  explicit RecordBuilder(FrameStore& store) : store_(store) {}
  void add(const msg::FrameView& frame);
  void add(const msg::FeatureFrame& features);
  void add(const msg::TrackingResult& result);
  /// Counters of a service. Those named *dropped*, *late*, *skipped*, *lost* or *refused* become RunRecord::drops; they
  /// continue when the service is restarted.
  void add(const msg::ServiceStatus& status);

  /// Frames that the source delivered: the camera's own count, else the frames seen.
  std::uint64_t frames_in() const;
  bool tracked_any() const { return tracked_any_; }  ///< at least one frame got a pose
  /// The newest frame of the camera, and the newest one with a result; empty before the first.
  std::optional<FramePlace> last_seen() const { return last_seen_; }
  std::optional<FramePlace> last_answered() const { return last_answered_; }
  /// What the camera says about itself; at its end the first piece that its source left out.
  std::string camera_message() const;
  LiveStatus live() const;
  /// The newest message of a degraded service; returned once, also when its numbers change.
  std::optional<std::string> take_notice();
  /// The notices that came more than once, with number, first and last frame: for the end of a run.
  std::vector<std::string> repeated_notices() const;

  /// "filter (pid 42), slam (pid 43)": every service seen that has not ended and is not tolerated. Empty when there is
  /// none.
  std::string active_services(const Tolerated& tolerated = {}) const;

  /// The source has ended: frames behind those that it delivered are of another one, which others may follow now.
  void close();
  /// Frames that were not kept for the report: the store was full.
  std::uint64_t frames_not_kept() const { return not_kept_; }
  /// Writes frames, what was counted of them, drops and clocks.
  void fill(run_record::RunRecord& record) const;

 private:
  struct Counter {
    double current = 0, before_restart = 0;
    double total() const { return current + before_restart; }
  };
  struct Service {
    std::int64_t pid = 0;
    msg::ServiceState state = msg::ServiceState::kStarting;
    std::string message;
    std::map<std::string, Counter> counters;
  };

  static bool disturbs_a_run(const std::string& name, const Service& service, const Tolerated& tolerated);
  /// An empty one where none of this name was seen.
  const Service& service(const std::string& name) const;
  std::map<std::string, double> drops() const;
  std::map<std::string, double> left_out() const;
  std::vector<run_record::HostClock> clocks() const;
  void note_troubles(const msg::ServiceStatus& status);
  Counter camera_counter(const std::string& name) const;

  struct Frame {
    run_record::FrameRecord record;
    bool has_features = false, has_result = false;
  };
  /// The frame of this message; none where it cannot be one of this run, or is in the store already.
  Frame* frame_of(const FramePlace& place);
  void store_oldest();
  void set_counter(Service& service, const msg::Metric& metric);
  void notify(const std::string& text);
  void notify_grouped(const std::string& text);

  /// Notices that differ in their numbers only.
  struct Repeated {
    std::uint64_t count = 0, first_frame = 0, last_frame = 0;
    std::string newest;
  };

  FrameStore& store_;
  std::map<std::uint64_t, Frame> frames_;  ///< by number, the newest
  std::uint64_t end_of_stored_ = 0, not_kept_ = 0;
  std::size_t notices_given_ = 0;
  bool named_forged_ = false;
  std::optional<std::uint64_t> end_of_source_;  ///< once it has ended
  std::map<std::string, Service> services_;
  std::deque<std::string> notices_;
  std::map<std::string, Repeated> kinds_;        ///< of notices
  std::map<std::string, std::string> troubles_;  ///< already reported, by service or counter
  std::deque<msg::TrackingResult> recent_;
  std::uint64_t end_of_seen_ = 0;  ///< highest number seen + 1
  std::optional<FramePlace> last_seen_, last_answered_;
  bool tracked_any_ = false;
};

/// Keeps about `wanted` frames, evenly spread over a source whose length need not be known: every stride-th frame is
/// kept, and whenever twice the wanted number is reached, the stride doubles and every second kept frame is dropped. So
/// few images are encoded, and memory stays bounded in an endless run. Not thread-safe.
class SampleKeeper {
 public:
  /// total: length of the source in frames, 0 = unknown.
  explicit SampleKeeper(std::uint64_t wanted = 12, std::uint64_t total = 0);

  /// True when frame `seq` is one to keep.
  bool wants(std::uint64_t seq) const { return seq % stride_ == 0; }
  void add_image(std::uint64_t seq, std::vector<std::uint8_t> jpeg);
  void add_features(std::uint64_t seq, const msg::FeatureFrame& features);
  /// Masks name their frame by its stamp: that of a frame to keep, before its masks.
  void expect_masks(std::uint64_t seq, std::int64_t stamp_ns);
  void add_masks(std::int64_t stamp_ns, vision::PersonMasks masks);

  /// The kept frames that have both image and features, by seq, at most `wanted`.
  std::vector<run_record::SampleFrame> samples() const;

 private:
  void thin_out();

  std::uint64_t wanted_, stride_;
  std::map<std::uint64_t, run_record::SampleFrame> kept_;
  std::map<std::int64_t, std::uint64_t> awaited_;  ///< frames whose masks have not come, by stamp
};

/// The poses as they were published, one line per tracked frame in TUM's format: "stamp_s tx ty tz qx qy qz qw";
/// those before `end_ns`, e.g. what a slam published that was restarted.
std::string online_trajectory_text(const std::vector<run_record::FrameRecord>& frames, std::int64_t end_ns = INT64_MAX);

}  // namespace rtd::launcher
