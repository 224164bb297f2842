// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/record_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <utility>

#include "common/io/text.hpp"
#include "common/service/metric_names.hpp"
#include "common/vision/samples.hpp"

namespace rtd::launcher {
namespace {

namespace metric = service::metric;

constexpr std::size_t kRecentFrames = 30;
constexpr std::uint64_t kStrideOfUnknownLength = 4;
constexpr std::uint64_t kFirstAtMost = std::uint64_t{1} << 48U;
constexpr double kMaxCounted = 9e15;  // beyond, a double counts no single frames
constexpr double kNsPerMs = 1e6, kNsPerS = 1e9;
constexpr std::array<const char*, 5> kLossNames = {"dropped", "late", "skipped", "lost", "refused"};

/// Of frames: a heartbeat that did not arrive is none.
bool counts_losses(const std::string& metric) {
  if (metric.starts_with(metric::kTopicPrefix) && metric.find("/frame") == std::string::npos &&
      metric.find("/features") == std::string::npos)
    return false;
  return !metric.starts_with(metric::kFrameIdPrefix) &&
         std::ranges::any_of(kLossNames, [&](const char* name) { return metric.find(name) != std::string::npos; });
}

/// "frames_late" of camera -> "camera.late".
std::string place_of(const std::string& service, const std::string& metric) {
  const std::string prefix = "frames_";
  return service + "." + (metric.starts_with(prefix) ? metric.substr(prefix.size()) : metric);
}

/// Whatever a metric claims.
std::uint64_t counted(double value) {
  return value > 0 ? static_cast<std::uint64_t>(std::min(value, kMaxCounted)) : 0;
}

double median_latency_ms(const std::deque<msg::TrackingResult>& results) {
  std::vector<double> latencies_ms;
  latencies_ms.reserve(results.size());
  for (const msg::TrackingResult& r : results) {
    latencies_ms.push_back(static_cast<double>(r.finished_ns - r.published_ns) / kNsPerMs);
  }
  return vision::median(std::move(latencies_ms));
}

double frames_per_second(const std::deque<msg::TrackingResult>& results) {
  const double span_s = static_cast<double>(results.back().finished_ns - results.front().finished_ns) / kNsPerS;
  return span_s > 0 ? static_cast<double>(results.size() - 1) / span_s : 0.0;
}

FramePlace frame_place(const auto& message) {
  return {message.seq, message.stamp_ns, message.published_ns};
}

void advance(std::optional<FramePlace>& last, const FramePlace& place) {
  if (!last || place.seq > last->seq) last = place;
}

}  // namespace

RecordBuilder::Frame* RecordBuilder::frame_of(const FramePlace& place) {
  const std::uint64_t seq = place.seq;
  if (seq < end_of_stored_ || seq >= end_of_source_.value_or(UINT64_MAX)) return nullptr;
  const bool first = end_of_seen_ == 0;  // a replay may begin anywhere
  if (seq >= (first ? kFirstAtMost : end_of_seen_ + kFarthestAhead)) {
    if (!named_forged_) notify(fmt::format("a frame claims to be number {}: ignored, {} were seen", seq, end_of_seen_));
    named_forged_ = true;
    return nullptr;
  }
  end_of_seen_ = std::max(end_of_seen_, seq + 1);
  advance(last_seen_, place);
  return &frames_[seq];
}

/// Frames without a result are not part of the record.
void RecordBuilder::store_oldest() {
  while (frames_.size() > kJoined) {
    const auto oldest = frames_.begin();
    if (oldest->second.has_result && !store_.append(oldest->second.record) && ++not_kept_ == 1)
      notify("the disk is full: of the frames from now on the report has only the newest");
    end_of_stored_ = oldest->first + 1;
    frames_.erase(oldest);
  }
}

void RecordBuilder::add(const msg::FrameView& frame) {
  if (frame_of(frame_place(frame)) != nullptr) store_oldest();
}

void RecordBuilder::add(const msg::FeatureFrame& features) {
  Frame* const frame = frame_of(frame_place(features));
  if (frame == nullptr || frame->has_features) return;
  frame->has_features = true;
  frame->record.filter_stage_ms = features.stage_ms;
  store_oldest();
}

void RecordBuilder::add(const msg::TrackingResult& result) {
  Frame* const frame = frame_of(frame_place(result));
  if (frame == nullptr || frame->has_result) return;
  frame->has_result = true;
  advance(last_answered_, frame_place(result));
  frame->record.tracking = result;
  tracked_any_ = tracked_any_ || msg::is_measured(result.state);
  recent_.push_back(result);
  if (recent_.size() > kRecentFrames) recent_.pop_front();
  store_oldest();
}

void RecordBuilder::add(const msg::ServiceStatus& status) {
  if (services_.size() >= kMaxServices && !services_.contains(status.service)) return;
  Service& service = services_[status.service];
  if (service.pid != status.pid) {
    service.pid = status.pid;
    for (auto& [name, counter] : service.counters) counter = {0, counter.total()};
    if (status.service == "camera") end_of_source_.reset();
  }
  for (const msg::Metric& metric : status.metrics) set_counter(service, metric);
  if (status.service == "camera" && status.state == msg::ServiceState::kFinished) close();

  note_troubles(status);
  const bool degraded = status.state == msg::ServiceState::kDegraded;  // a failed one ends and gives the reason itself
  const bool news = service.state != status.state || service.message != status.message;
  if (degraded && news && !status.message.empty()) notify_grouped(status.service + ": " + status.message);
  service.state = status.state;
  service.message = status.message;
}

void RecordBuilder::set_counter(Service& service, const msg::Metric& metric) {
  if (service.counters.size() >= kMaxCounters && !service.counters.contains(metric.name)) return;
  service.counters[metric.name].current = metric.value;
}

/// Of those that differ in their numbers only the first; the others are counted.
void RecordBuilder::notify_grouped(const std::string& text) {
  const std::string about = io::without_numbers(text);
  if (kinds_.size() < kMaxNotices || kinds_.contains(about)) {
    Repeated& kind = kinds_[about];
    if (kind.count++ == 0) kind.first_frame = end_of_seen_;
    kind.last_frame = end_of_seen_;
    kind.newest = text;
    if (kind.count > 1) return;
  }
  notify(text);
}

void RecordBuilder::notify(const std::string& text) {
  if (notices_given_ == kMaxNotices) return;
  const bool last = ++notices_given_ == kMaxNotices;
  notices_.push_back(last ? "further notices are left out: the logs of the services have them" : text);
}

std::vector<std::string> RecordBuilder::repeated_notices() const {
  std::vector<std::string> lines;
  for (const auto& [about, kind] : kinds_) {
    if (kind.count < 2) continue;
    lines.push_back(
        fmt::format("{} ({} times, from frame {} to {})", kind.newest, kind.count, kind.first_frame, kind.last_frame));
  }
  return lines;
}

/// Several services may report the same about a peer; it counts as new again after the peer was seen.
void RecordBuilder::note_troubles(const msg::ServiceStatus& status) {
  const auto report_once = [this](const std::string& about, const std::string& text) {
    if (troubles_.size() < kMaxNotices && troubles_.emplace(about, text).second) notify(text);
  };
  troubles_.erase(status.service);
  for (const msg::Metric& metric : status.metrics) {
    const auto& name = metric.name;
    const std::string what = name.substr(name.rfind('.') + 1);
    const auto about = [&](std::string_view prefix) {
      return name.substr(prefix.size(), name.size() - prefix.size() - 1 - what.size());
    };
    if (name.starts_with(metric::kPeerPrefix) && (what == "dead" || what == "hung")) {
      const std::string peer = about(metric::kPeerPrefix);
      report_once(peer, peer + " is " + what + ": no heartbeat");
    } else if (name.starts_with(metric::kTopicPrefix) &&
               (what == "rejected" || what == "incompatible_qos" || what == "type_mismatch" || what == "implausible" ||
                what == "too_large")) {
      const std::string topic = about(metric::kTopicPrefix);
      report_once(status.service + ' ' + name, status.service + ": " + topic + ": " + what);
    }
  }
}

/// The camera's own count, which continues when it is restarted, where it has given one: what the services follow after
/// it may have been seen already.
void RecordBuilder::close() {
  const std::uint64_t counted_by_camera = counted(camera_counter(metric::kFramesIn).current);
  if (!end_of_source_) end_of_source_ = counted_by_camera > 0 ? counted_by_camera : end_of_seen_;
}

std::uint64_t RecordBuilder::frames_in() const {
  return end_of_source_.value_or(std::max(counted(camera_counter(metric::kFramesIn).current), end_of_seen_));
}

LiveStatus RecordBuilder::live() const {
  LiveStatus status;
  status.frames = end_of_seen_;
  for (const auto& [place, count] : drops()) {
    const bool before_the_pose = !place.starts_with("detector.") &&
                                 place.find(".topic.") == std::string::npos;  // it only needs the newest frame
    if (before_the_pose) status.dropped += counted(count);
  }
  status.camera_message = camera_message();
  if (recent_.empty()) return status;
  const msg::TrackingResult& newest = recent_.back();
  status.tracking = true;
  status.state = newest.state;
  status.inliers = newest.inliers;
  status.dynamic_points = newest.features_removed;
  status.frames_per_s = frames_per_second(recent_);
  status.latency_ms = median_latency_ms(recent_);
  return status;
}

std::optional<std::string> RecordBuilder::take_notice() {
  if (notices_.empty()) return std::nullopt;
  std::string notice = notices_.front();
  notices_.pop_front();
  return notice;
}

bool RecordBuilder::disturbs_a_run(const std::string& name, const Service& service, const Tolerated& tolerated) {
  // A detector for several robots sends a "detector" heartbeat next to its own to each robot that it serves.
  const bool harmless =
      name == "record" || name == "detector_box" || name == "link" || name == "viewer" || name == "atlas";
  if (service.state == msg::ServiceState::kFinished || harmless) return false;
  if (name == "detector") return !tolerated.detector;
  if (name != "replay") return true;
  const auto run_topics = service.counters.find(metric::kRunTopics);
  if (run_topics == service.counters.end()) return !tolerated.silent_replay;
  return !tolerated.harmless_replay || run_topics->second.current > 0;
}

std::string RecordBuilder::active_services(const Tolerated& tolerated) const {
  std::string text;
  for (const auto& [name, service] : services_) {
    if (!disturbs_a_run(name, service, tolerated)) continue;
    text += (text.empty() ? "" : ", ") + name + " (pid " + std::to_string(service.pid) + ")";
  }
  return text;
}

void RecordBuilder::fill(run_record::RunRecord& record) const {
  record.frames_in = frames_in();
  record.frames = store_.read();
  for (const auto& [seq, frame] : frames_) {
    if (frame.has_result && seq < record.frames_in) record.frames.push_back(frame.record);
  }
  record.frames_dropped = record.frames_in - record.frames.size();
  record.frames_left_out = counted(camera_counter(metric::kFramesLeftOut).total());
  record.frames_out_of_range = counted(camera_counter(metric::kFramesOutOfRange).total());
  record.left_out = left_out();
  record.drops = drops();
  record.depth_median_m = camera_counter(metric::kDepthMedianM).current;
  record.depth_holes = camera_counter(metric::kDepthHoles).current;
  record.clocks = clocks();
}

/// Slam runs on the first host, so its measurements of other hosts stand for all services of the first host.
std::vector<run_record::HostClock> RecordBuilder::clocks() const {
  const std::string prefix = metric::kClockPrefix, suffix = metric::kClockOffsetSuffix;
  std::vector<run_record::HostClock> clocks;
  const auto& counters = service("slam").counters;
  for (const auto& [name, counter] : counters) {
    if (!name.starts_with(prefix) || !name.ends_with(suffix)) continue;
    const std::string other = name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
    const auto round_trip = counters.find(prefix + other + metric::kClockRoundTripSuffix);
    if (round_trip != counters.end()) clocks.push_back({other, counter.current, round_trip->second.current});
  }
  return clocks;
}

std::map<std::string, double> RecordBuilder::drops() const {
  std::map<std::string, double> result;
  for (const auto& [name, service] : services_) {
    for (const auto& [metric, counter] : service.counters) {
      if (counts_losses(metric)) result[place_of(name, metric)] = counter.total();
    }
  }
  return result;
}

std::map<std::string, double> RecordBuilder::left_out() const {
  std::map<std::string, double> result;
  const std::string_view prefix = metric::kLeftOutPrefix;
  for (const auto& [name, counter] : service("camera").counters)
    if (name.starts_with(prefix)) result[name.substr(prefix.size())] = counter.total();
  return result;
}

const RecordBuilder::Service& RecordBuilder::service(const std::string& name) const {
  static const Service kNotSeen;
  const auto found = services_.find(name);
  return found == services_.end() ? kNotSeen : found->second;
}

std::string RecordBuilder::camera_message() const {
  return service("camera").message;
}

RecordBuilder::Counter RecordBuilder::camera_counter(const std::string& name) const {
  const auto& counters = service("camera").counters;
  const auto counter = counters.find(name);
  return counter == counters.end() ? Counter{} : counter->second;
}

SampleKeeper::SampleKeeper(std::uint64_t wanted, std::uint64_t total)
    : wanted_(std::max<std::uint64_t>(wanted, 1)),
      stride_(total > 0 ? (total + wanted_ - 1) / wanted_ : kStrideOfUnknownLength) {}

void SampleKeeper::add_image(std::uint64_t seq, std::vector<std::uint8_t> jpeg) {
  if (!wants(seq)) return;
  run_record::SampleFrame& sample = kept_[seq];
  sample.seq = seq;
  sample.jpeg = std::move(jpeg);
  thin_out();
}

void SampleKeeper::add_features(std::uint64_t seq, const msg::FeatureFrame& features) {
  if (!wants(seq)) return;
  run_record::SampleFrame& sample = kept_[seq];
  sample.seq = seq;
  sample.features =
      run_record::judged({features.features.data(), std::min<std::size_t>(features.count, msg::kMaxFeatures)});
  sample.points = run_record::seen(features);
  thin_out();
}

void SampleKeeper::expect_masks(std::uint64_t seq, std::int64_t stamp_ns) {
  awaited_[stamp_ns] = seq;
  if (awaited_.size() > wanted_) awaited_.erase(awaited_.begin());  // no detector answers every frame
}

void SampleKeeper::add_masks(std::int64_t stamp_ns, vision::PersonMasks masks) {
  const auto awaited = awaited_.extract(stamp_ns);
  if (awaited.empty() || !wants(awaited.mapped())) return;
  run_record::SampleFrame& sample = kept_[awaited.mapped()];
  sample.seq = awaited.mapped();
  sample.masks = std::move(masks);
  thin_out();
}

void SampleKeeper::thin_out() {
  while (kept_.size() >= 2 * wanted_) {
    stride_ *= 2;
    for (auto sample = kept_.begin(); sample != kept_.end();) {
      sample = wants(sample->first) ? std::next(sample) : kept_.erase(sample);
    }
  }
}

std::vector<run_record::SampleFrame> SampleKeeper::samples() const {
  std::vector<run_record::SampleFrame> complete;
  for (const auto& [seq, sample] : kept_) {
    if (!sample.jpeg.empty() && !sample.features.empty()) complete.push_back(sample);
  }
  if (complete.size() <= wanted_) return complete;
  std::vector<run_record::SampleFrame> result;
  for (std::uint64_t i = 0; i < wanted_; ++i) result.push_back(std::move(complete[i * complete.size() / wanted_]));
  return result;
}

std::string online_trajectory_text(const std::vector<run_record::FrameRecord>& frames, std::int64_t end_ns) {
  std::string text;
  for (const run_record::FrameRecord& frame : frames) {
    if (!msg::is_measured_in_map(frame.tracking) || frame.tracking.stamp_ns >= end_ns) continue;
    const auto& [t, q] = frame.tracking.T_world_camera;
    fmt::format_to(std::back_inserter(text), "{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                   static_cast<double>(frame.tracking.stamp_ns) * 1e-9, t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
  }
  return text;
}

}  // namespace rtd::launcher
