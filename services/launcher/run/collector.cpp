// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/collector.hpp"

#include <algorithm>
#include <utility>

#include "common/camera/frame_source.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/peer_clocks.hpp"
#include "common/vision/image_codecs.hpp"
#include "common/vision/rgbd_image.hpp"

namespace rtd::launcher {
namespace {

constexpr int kJpegQuality = 80;

std::vector<std::uint8_t> jpeg_of(const msg::FrameView& frame) {
  return vision::encode_jpeg(vision::view_color(frame), kJpegQuality);
}

}  // namespace

Collector::Collector(bus::Bus& bus, FrameStore& store, const Options& options)
    : bus_(bus),
      camera_(service::follow_source("camera", process_gone())),
      filter_(service::follow_source("filter", process_gone())),
      slam_(service::follow_source("slam", process_gone())),
      peers_(process_gone()),
      builder_(store),
      samples_(options.samples, options.total),
      total_(options.total),
      held_(options.held),
      keep_features_(options.keep_features),
      with_masks_(options.masks) {
  if (options.secured) {
    peers_.accept_only_from("camera", camera_);
    peers_.accept_only_from("filter", filter_);
    peers_.accept_only_from("slam", slam_);
  }
  const auto add_message = [this](const auto& message) { add(*message); };
  tracking_reader_ = bus.reader(bus::topics::kTracking, add_message, slam_->callbacks());
  features_reader_ = bus.reader(bus::topics::kFeatures, add_message, filter_->callbacks());
  status_reader_ = bus.reader(bus::topics::kStatus, [this](const std::shared_ptr<const msg::ServiceStatus>& status,
                                                           const bus::WriterId& writer) { add(*status, writer); });
  if (with_masks_) masks_reader_ = bus.reader(bus::topics::kPersonMasks, add_message);
  encoder_ = std::thread([this] { encode_samples(); });  // last: the bus may refuse a reader
}

void Collector::read_frames() {
  frame_reader_ = bus::FrameReader(
      bus_, [this](const auto& frame) { add_image(frame); }, camera_->callbacks());
}

std::optional<double> Collector::metric_of(const std::string& service, const std::string& metric) const {
  const std::lock_guard lock(mutex_);
  const auto peer = peers_.peers().find(service);
  return peer == peers_.peers().end() ? std::nullopt : service::find_metric(peer->second.status, metric);
}

void Collector::add(const msg::TrackingResult& result) {
  const std::lock_guard lock(mutex_);
  builder_.add(result);
}

void Collector::add(const msg::FeatureFrame& features) {
  const std::lock_guard lock(mutex_);
  builder_.add(features);
  samples_.add_features(features.seq, features);
  if (keep_features_ && judged_.size() < kMaxJudgedFrames) {
    judged_.try_emplace(features.stamp_ns, run_record::judged({features.features.data(), features.count}));
  }
}

void Collector::add(const msg::ServiceStatus& status, const bus::WriterId& writer) {
  processes_->note(status, writer);
  const std::lock_guard lock(mutex_);
  if (peers_.note(status, writer, service::monotonic_ns())) builder_.add(status);
}

void Collector::add(const msg::Image& masks) {
  if (masks.encoding != "mono8" || masks.step != masks.width || masks.data.empty() ||
      masks.data.size() != std::size_t{masks.width} * masks.height)
    return;
  const std::lock_guard lock(mutex_);
  samples_.add_masks(msg::to_ns(masks.header.stamp),
                     {static_cast<int>(masks.width), static_cast<int>(masks.height), masks.data});
}

void Collector::add_image(const std::shared_ptr<const msg::FrameView>& frame) {
  {
    const std::lock_guard lock(mutex_);
    builder_.add(*frame);
    if (!samples_.wants(frame->seq)) return;
    if (with_masks_) samples_.expect_masks(frame->seq, frame->stamp_ns);
  }
  images_.push(frame);
}

service::ProcessGone Collector::process_gone() const {
  return [processes = processes_](const bus::ParticipantId& connection) { return processes->gone(connection); };
}

Collector::~Collector() {
  images_.close();
  encoder_.join();
}

/// A reader may find a writer before that writer finds it, and miss what is written meanwhile. Writers find the readers
/// of a process in their order: whose heartbeat has come has found the readers before it too.
bool Collector::connected(bool with_filter) const {
  const std::lock_guard lock(mutex_);
  const auto found = [this](const char* service) { return peers_.peers().contains(service); };
  return tracking_reader_.matched() > 0 && found("slam") &&
         (!with_filter || (features_reader_.matched() > 0 && found("filter")));
}

LiveStatus Collector::live() const {
  const std::lock_guard lock(mutex_);
  LiveStatus status = builder_.live();
  if (status.total == 0) status.total = total_;
  return status;
}

std::optional<std::string> Collector::take_notice() {
  const std::lock_guard lock(mutex_);
  return builder_.take_notice();
}

void Collector::close() {
  const std::lock_guard lock(mutex_);
  builder_.close();
}

void Collector::fill(run_record::RunRecord& record) const {
  const std::lock_guard lock(mutex_);
  builder_.fill(record);
  std::uint64_t met = record.frames_in + record.frames_left_out;
  for (const auto& [name, count] : record.left_out) {
    const auto reason = camera::skip_reason_of(name);
    if (reason && camera::is_intended(*reason)) met += static_cast<std::uint64_t>(count);
  }
  record.frames_not_played = held_ - std::min(held_, met);
  record.samples = samples_.samples();
  record.judged_frames.clear();
  for (const auto& [stamp_ns, features] : judged_) record.judged_frames.push_back({stamp_ns, features});
}

void Collector::encode_samples() {
  while (const auto image = images_.pop()) {
    std::vector<std::uint8_t> jpeg = jpeg_of(**image);
    const std::lock_guard lock(mutex_);
    if (!jpeg.empty()) samples_.add_image((*image)->seq, std::move(jpeg));
  }
}

}  // namespace rtd::launcher
