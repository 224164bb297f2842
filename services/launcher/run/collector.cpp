// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/collector.hpp"

#include <atomic>
#include <utility>

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
      keep_features_(options.keep_features),
      with_masks_(options.masks) {
  if (options.secured) {
    peers_.believe_only("camera", camera_);
    peers_.believe_only("filter", filter_);
    peers_.believe_only("slam", slam_);
  }
  readers_ = subscribe();
  encoder_ = std::thread([this] { encode_samples(); });  // last: the bus may refuse a reader
}

std::unique_ptr<Collector::Readers> Collector::subscribe() {
  auto readers = std::make_unique<Readers>();
  const auto recipient = readers->recipient = std::make_shared<Recipient>();
  recipient->collector = this;
  const auto add = [recipient](const auto& message) {
    deliver(*recipient, [&](Collector& collector) { collector.add(*message); });
  };
  readers->tracking = bus_.reader(bus::topics::kTracking, add, slam_->callbacks());
  readers->features = bus_.reader(bus::topics::kFeatures, add, filter_->callbacks());
  readers->status =
      bus_.reader(bus::topics::kStatus,
                  [recipient](const std::shared_ptr<const msg::ServiceStatus>& status, const bus::WriterId& writer) {
                    deliver(*recipient, [&](Collector& collector) { collector.add(*status, writer); });
                  });
  if (with_masks_) readers->masks = bus_.reader(bus::topics::kPersonMasks, add);
  if (reads_frames_) subscribe_to_frames(*readers);
  return readers;
}

void Collector::subscribe_to_frames(Readers& readers) {
  readers.frames = bus::FrameReader(
      bus_,
      [recipient = readers.recipient](const auto& frame) {
        deliver(*recipient, [&](Collector& collector) { collector.add_image(frame); });
      },
      camera_->callbacks());
}

void Collector::deliver(Recipient& recipient, const std::function<void(Collector&)>& action) {
  const std::lock_guard lock(recipient.mutex);
  if (recipient.collector != nullptr) action(*recipient.collector);
}

void Collector::read_frames() {
  reads_frames_ = true;
  subscribe_to_frames(*readers_);
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
  samples_.add_features(builder_.run_seq(features.seq), features);
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
  std::uint64_t seq = 0;
  {
    const std::lock_guard lock(mutex_);
    seq = builder_.run_seq(frame->seq);
    if (!samples_.wants(seq)) return;
    if (with_masks_) samples_.expect_masks(seq, frame->stamp_ns);
  }
  images_.push({seq, frame});
}

service::ProcessGone Collector::process_gone() const {
  return [processes = processes_](const bus::ParticipantId& connection) { return processes->gone(connection); };
}

void Collector::subscribe_again() {
  {
    const std::lock_guard lock(readers_->recipient->mutex);
    readers_->recipient->collector = nullptr;
  }
  static std::atomic<Readers*> kept = nullptr;
  readers_->kept_before = kept;
  kept = readers_.release();
  readers_ = subscribe();
}

Collector::~Collector() {
  images_.close();
  encoder_.join();
}

bool Collector::connected(bool with_filter) const {
  return readers_->tracking.matched() > 0 && (!with_filter || readers_->features.matched() > 0);
}

std::string Collector::active_services(const Tolerated& tolerated) const {
  const std::lock_guard lock(mutex_);
  return builder_.active_services(tolerated);
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

std::vector<std::string> Collector::repeated_notices() const {
  const std::lock_guard lock(mutex_);
  return builder_.repeated_notices();
}

bool Collector::tracked_any() const {
  const std::lock_guard lock(mutex_);
  return builder_.tracked_any();
}

bool Collector::any_frame() const {
  const std::lock_guard lock(mutex_);
  return builder_.frames_in() > 0;
}

std::string Collector::camera_message() const {
  const std::lock_guard lock(mutex_);
  return builder_.camera_message();
}

void Collector::close() {
  const std::lock_guard lock(mutex_);
  builder_.close();
}

void Collector::fill(run_record::RunRecord& record) const {
  const std::lock_guard lock(mutex_);
  builder_.fill(record);
  record.samples = samples_.samples();
  record.judged_frames.clear();
  for (const auto& [stamp_ns, features] : judged_) record.judged_frames.push_back({stamp_ns, features});
}

void Collector::encode_samples() {
  while (const auto image = images_.pop()) {
    std::vector<std::uint8_t> jpeg = jpeg_of(*image->frame);
    const std::lock_guard lock(mutex_);
    if (!jpeg.empty()) samples_.add_image(image->seq, std::move(jpeg));
  }
}

}  // namespace rtd::launcher
