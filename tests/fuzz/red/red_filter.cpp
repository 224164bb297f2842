// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Attacks the filter: red_filter [messages] [seed]. Hostile but well-formed frames, boxes, poses and keyframe events
/// between good ones go through the edge of the bus into the core, as FilterService hands them on. What must hold:
/// no crash, no sanitizer report, no exception, no call of a second, bounded memory (red_watch.hpp), and what the
/// filter would publish passes the edge of the next service. The preset asan-ubsan gives it its teeth.
#include <memory>
#include <utility>

#include "common/msg/transform_eigen.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/dynamic_filter.hpp"
#include "services/filter/core/modes/mode_table.hpp"
#include "services/filter/core/movers/world_movers.hpp"
#include "services/filter/filter_messages.hpp"
#include "services/filter/inboxes.hpp"
#include "tests/fuzz/red/attack.hpp"
#include "tests/fuzz/red/red_watch.hpp"
#include "tests/fuzz/red/small_frames.hpp"

namespace rtd::filter {
namespace {

using rtd::testing::SmallFrames;

FilterConfig small_config() {
  FilterConfig config;
  config.orb.feature_count = 150;
  return config;
}

/// The parts of FilterService behind its readers.
class Target {
 public:
  Target() : filter_(small_config(), [] { return std::int64_t{0}; }) {}

  void set_mode(FilterMode mode) {
    filter_.set_mode(mode);
    movers_.clear();
  }
  void put(const msg::Detection2DArray& message) {
    detections_.put(to_detection_batch(message), message.detections.size());
  }
  void put(const msg::Image& message) {
    detections_.put_masks(msg::to_ns(message.header.stamp), to_person_masks(message).masks);
  }
  void put(const msg::TrackingResult& result) { feedback_.put(result); }
  void put(const msg::KeyframeEvent& event) { feedback_.put(event); }

  /// False: the frame was not judged. `in_order`: what lies in the past makes the filter forget, as in the service.
  bool put(const msg::RgbdFrame& message, bool in_order, bool detector) {
    const msg::FrameView frame(message);
    if (!vision::defect(frame).empty()) return false;
    const bool other = frame.stamp_ns <= last_ns_ || frame.intrinsics != intrinsics_;
    if (in_order && other) forget();
    last_ns_ = frame.stamp_ns;
    intrinsics_ = frame.intrinsics;
    const vision::RgbdImage image = vision::view_image(frame);
    Extraction extraction = filter_.extract(image);
    apply_feedback();
    DetectorUpdate update{detector, detections_.take_until(frame.stamp_ns)};
    drop_misfits(update.batches, frame);
    const FilterResult result = filter_.judge(image, std::move(extraction), update);
    fill_message(frame, result, msg::DetectionUse::kExact, features_);
    mask_ = make_mask(frame, result, "camera");
    sightings_ = filter_.sight_objects(image, result);
    return true;
  }
  /// Would the next services take what this one publishes?
  bool output_is_plausible() const { return is_plausible(features_) && is_plausible(mask_); }

 private:
  void forget() {
    filter_.reset();
    movers_.clear();
    detections_.clear();
  }
  void apply_feedback() {
    const SlamUpdate update = feedback_.take();
    for (const msg::KeyframeEvent& event : update.events) filter_.on_keyframe(to_slam_keyframe(event));
    for (const msg::TrackingResult& result : update.results) {
      const auto pose = to_slam_pose(result);
      if (!pose) continue;
      filter_.on_pose(*pose);
      movers_.place(result.stamp_ns, pose->T_world_camera, sightings_);
    }
  }

  DynamicFilter filter_;
  DetectionInbox detections_;
  SlamFeedback feedback_;
  WorldMovers movers_;
  std::vector<ObjectSighting> sightings_;
  msg::FeatureFrame features_{};
  msg::Image mask_;
  std::int64_t last_ns_ = 0;
  std::array<double, 4> intrinsics_{};
};

msg::Detection2DArray boxes_of(std::uint64_t seq) {
  msg::Detection2DArray boxes;
  boxes.header = {msg::to_time(SmallFrames::stamp_ns(seq)), "camera"};
  msg::Detection2D box;
  box.results.emplace_back().hypothesis = {"person", 0.9};
  box.bbox = {{{static_cast<double>(seq % SmallFrames::kWidth), 40}, 0}, 30, 44};
  boxes.detections = {box, box};
  boxes.detections[1].results[0].hypothesis.class_id = "chair";
  boxes.detections[1].bbox.center.position.x = 60;
  return boxes;
}

/// The person of boxes_of() as pixels.
msg::Image labels_of(std::uint64_t seq) {
  constexpr auto cells = [](int px) { return static_cast<std::uint32_t>((px - 1) / vision::kMaskStepPx + 1); };
  msg::Image labels;
  labels.header = {msg::to_time(SmallFrames::stamp_ns(seq)), "camera"};
  labels.width = labels.step = cells(SmallFrames::kWidth);
  labels.height = cells(SmallFrames::kHeight);
  labels.encoding = "mono8";
  labels.data.assign(std::size_t{labels.width} * labels.height, 0);
  const std::uint64_t middle = seq % SmallFrames::kWidth / vision::kMaskStepPx;
  for (std::uint32_t row = 5; row < labels.height; ++row) labels.data[row * labels.width + middle] = 1;
  return labels;
}

msg::TrackingResult result_of(std::uint64_t seq) {
  msg::TrackingResult result{};
  result.seq = seq;
  result.stamp_ns = SmallFrames::stamp_ns(seq);
  result.T_world_camera = msg::to_message(SmallFrames::T_world_camera(seq));
  result.state = msg::TrackingState::kOk;
  result.event_count = seq / 10;
  return result;
}

msg::KeyframeEvent event_of(std::uint64_t seq) {
  return {seq / 10,
          seq,
          SmallFrames::stamp_ns(seq),
          msg::to_message(SmallFrames::T_world_camera(seq)),
          static_cast<std::uint32_t>(seq / 10),
          msg::KeyframeEventKind::kCreated};
}

class Attack {
 public:
  Attack(rtd::testing::RedWatch& watch) : watch_(watch), attacker_(watch.seed()) {}

  int run() {
    for (; watch_.messages() < 400 && watch_.more();) step(false);
    watch_.settled();
    while (watch_.more()) {
      if (attacker_.one_in(2000)) target_->set_mode(all_modes()[attacker_.below(all_modes().size())].mode);
      if (attacker_.one_in(5000)) target_ = std::make_unique<Target>();
      step(!attacker_.one_in(3));
    }
    return broken_ > 0 ? 1 : watch_.finish();
  }

 private:
  /// A frame and what goes with it.
  void step(bool hostile) {
    ++seq_;
    if (seq_ % 3 != 0) give("masks", labels_of(seq_), hostile);
    give("boxes", boxes_of(seq_), hostile);
    if (seq_ % 10 == 0) give("keyframe event", event_of(seq_ - 1), hostile);
    give("pose", result_of(seq_ - 1), hostile);
    for (std::uint64_t more = hostile ? attacker_.below(6) : 0; more > 0; --more) {
      if (attacker_.one_in(2)) give("boxes", boxes_of(seq_ + attacker_.below(3)), true);
      if (attacker_.one_in(2)) give("masks", labels_of(seq_ + attacker_.below(3)), true);
      if (attacker_.one_in(2)) give("pose", result_of(seq_ - attacker_.below(40) % seq_), true);
      if (attacker_.one_in(2)) give("keyframe event", event_of(seq_ - attacker_.below(40) % seq_), true);
    }
    give_frame(hostile && attacker_.one_in(2));
  }

  template <class Message>
  void give(const char* what, Message message, bool hostile) {
    if (hostile) attacker_.attack(message);
    if (watch_.passes(message)) watch_.call(what, [&] { target_->put(message); });
  }

  void give_frame(bool hostile) {
    SmallFrames::paint(seq_, *frame_);
    if (hostile) attacker_.attack(*frame_);
    if (hostile && attacker_.one_in(8)) reshape();
    if (!watch_.passes(*frame_)) return;
    const bool in_order = !attacker_.one_in(8), detector = !attacker_.one_in(5);
    watch_.call("frame", [&] {
      if (!target_->put(*frame_, in_order, detector) || target_->output_is_plausible()) return;
      if (broken_++ == 0) std::fprintf(stderr, "the filter would publish what no service takes\n");
    });
  }
  /// Sizes that a camera never has.
  void reshape() {
    frame_->width = static_cast<std::uint32_t>(1 + attacker_.below(attacker_.one_in(2) ? 4 : 200));
    frame_->height = static_cast<std::uint32_t>(1 + attacker_.below(attacker_.one_in(2) ? 4 : 200));
    if (attacker_.one_in(4)) (attacker_.one_in(2) ? frame_->width : frame_->height) = msg::kMaxFrameSide;
  }

  rtd::testing::RedWatch& watch_;
  rtd::testing::Attacker attacker_;
  std::unique_ptr<Target> target_ = std::make_unique<Target>();
  std::unique_ptr<msg::RgbdFrame> frame_ = std::make_unique<msg::RgbdFrame>();
  std::uint64_t seq_ = 0, broken_ = 0;
};

}  // namespace
}  // namespace rtd::filter

int main(int argc, char** argv) {
  rtd::testing::RedWatch watch("red_filter", 4000, argc, argv);
  return rtd::filter::Attack(watch).run();
}
