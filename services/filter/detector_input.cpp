// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/msg/stamps.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/filter/core/modes/mode_table.hpp"
#include "services/filter/filter_messages.hpp"
#include "services/filter/filter_service.hpp"

/// What the service has of the detector: boxes, masks, and whether it is there.
namespace rtd::filter {

/// Realtime: what has arrived so far. Asap and lockstep: waits for the detections of exactly this frame.
DetectorUpdate FilterService::collect_detections(const msg::FrameView& frame) {
  if (!looks_at_boxes(filter_.mode()) || config_.detector == "off") return {};
  if (runtime_.pace != service::Pace::kRealtime) wait_for_detections(frame);
  DetectorUpdate update{detector_seen_ && !detector_gone_, detections_->take_until(frame.stamp_ns)};
  const std::string cause = drop_misfits(update.batches, frame);
  if (!cause.empty() && misfit_log_.pass())
    SPDLOG_WARN("event=masks_ignored cause=\"{}\" effect=\"boxes alone\"", cause);
  return update;
}

/// Broken ones count as received and empty, so that no frame waits for them.
void FilterService::read_masks() {
  mask_reader_ = runtime_.bus.reader<msg::Image>(
      bus::topics::kPersonMasks,
      [this](const std::shared_ptr<const msg::Image>& message) {
        MaskMessage received = to_person_masks(*message);
        if (!received.problem.empty() && broken_masks_log_.pass())
          SPDLOG_WARN("event=masks_ignored cause=\"{}\" effect=\"boxes alone\"", received.problem);
        detections_->put_masks(msg::to_ns(message->header.stamp), std::move(received.masks));
      },
      detector_->callbacks());
}

void FilterService::wait_for_detections(const msg::FrameView& frame) {
  if (!detector_seen_ || detector_gone_) return;
  const std::int64_t since_ns = service::monotonic_ns();
  const auto give_up = [&] {
    const std::int64_t waited_ns = service::monotonic_ns() - since_ns;
    runtime_.heartbeat.tick();
    return waited_ns > std::int64_t{config_.detections_timeout_ms} * 1'000'000 ||
           (waited_ns > kPatienceNs && runtime_.heartbeat.gone("detector"));
  };
  if (detections_->wait_for(frame.stamp_ns, give_up)) {
    const bool complete = !masks_come() || detections_->wait_for_masks(frame.stamp_ns, give_up);
    if (!complete && !runtime_.stop.stop_requested() && wait_log_.pass())
      SPDLOG_WARN("event=no_masks frame={} effect=\"boxes alone\"", frame.seq);
    return;
  }
  if (runtime_.stop.stop_requested()) return;
  ++unpaired_;
  if (wait_log_.pass()) SPDLOG_WARN("event=no_detections frame={} total={}", frame.seq, unpaired_);
}

msg::DetectionUse FilterService::use_of(const DetectorUpdate& detector, const FilterResult& result,
                                        std::int64_t stamp_ns) const {
  if (!detector.batches.empty() && detector.batches.back().stamp_ns == stamp_ns) return msg::DetectionUse::kExact;
  if (std::ranges::any_of(result.objects, &SceneObject::carried)) return msg::DetectionUse::kCarried;
  return detector_gone_ ? msg::DetectionUse::kDetectorGone : msg::DetectionUse::kNone;
}

void FilterService::watch_detector() {
  if (config_.detector == "off") return;
  const bool gone = detector_gone();
  if (!gone && (!detector_seen_ || detector_gone_)) SPDLOG_INFO("event=detector_found frames={}", published_);
  if (gone && detector_seen_ && !detector_gone_) {
    SPDLOG_WARN("event=detector_gone frames={} effect=\"geometry only until it returns\"", published_);
  }
  detector_gone_ = detector_seen_ && gone;
  detector_seen_ = detector_seen_ || !gone;
}

/// Without a wait at stake, silence is noticed sooner; in lockstep and asap a busy host must not change the result.
bool FilterService::detector_gone() const {
  constexpr std::int64_t kDetectorSilentNs = 450'000'000;  // two heartbeats missed: reported within half a second
  if (runtime_.pace != service::Pace::kRealtime) return runtime_.heartbeat.gone("detector");
  return service::monotonic_ns() - detector_alive_ns_ >= kDetectorSilentNs;
}

/// At a pace that waits for its boxes the first frame waits until they will come.
bool FilterService::detector_there() const {
  return config_.detector != "on" || runtime_.pace == service::Pace::kRealtime || detector_ready_;
}

}  // namespace rtd::filter
