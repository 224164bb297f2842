// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Attacks the dense map: red_dense [messages] [seed]. Hostile but well-formed frames, masks, poses and keyframe events
/// between good ones go through the edge of the bus into the core, as DenseService joins them. What must hold: no
/// crash, no sanitizer report, no exception, no call of a second, bounded memory (red_watch.hpp). The preset asan-ubsan
/// gives it its teeth.
#include <memory>

#include "common/msg/transform_eigen.hpp"
#include "common/occupancy/grid_message.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/dense/core/navigation_map.hpp"
#include "services/dense/dense_service.hpp"
#include "services/dense/frame_joiner.hpp"
#include "tests/fuzz/red/attack.hpp"
#include "tests/fuzz/red/red_watch.hpp"
#include "tests/fuzz/red/small_frames.hpp"

namespace rtd::dense {
namespace {

using rtd::testing::SmallFrames;

/// A map that is full within the bound of memory.
DenseConfig small_config() {
  DenseConfig config;
  config.fusion.max_voxels = 50'000;
  return config;
}

NavigationConfig small_plan() {
  NavigationConfig config;
  config.max_cells = 100'000;
  config.space.max_scans = 200;
  config.space.max_blocks = 1000;
  return config;
}

/// The parts of DenseService behind its readers.
class Target {
 public:
  void put(const msg::TrackingResult& result) { joiner_.put(result); }
  void put(const msg::KeyframeEvent& event) { joiner_.put(event); }
  void put(const msg::Image& message) {
    if (auto mask = from_message(message)) joiner_.put(msg::to_ns(message.header.stamp), std::move(*mask));
  }
  void put(const std::shared_ptr<const msg::RgbdFrame>& frame) {
    joiner_.put(std::make_shared<const msg::FrameView>(*frame, frame));
  }
  void work() {
    while (const auto joined = joiner_.take(std::chrono::milliseconds(0))) integrate(*joined);
  }
  void publish() {
    map_.cloud(1000);
    navigation_.follow_corrections(2);
    const Volume volume = navigation_.volume(map_);
    if (const auto grid = navigation_.grid(volume)) occupancy::make_grid(*grid, navigation_.R_grid_map(), 0, "map");
  }

 private:
  void integrate(const JoinedFrame& joined) {
    for (const KeyframeUpdate& update : joined.updates) {
      if (update.new_map) {
        map_.clear();
        navigation_.clear();
      }
      map_.update(update.event);
      navigation_.update(update.event);
    }
    if (!vision::defect(*joined.frame).empty()) return;
    const vision::RgbdImage image = vision::view_image(*joined.frame);
    const DynamicMask mask = joined.mask.value_or(all_static());
    const Eigen::Isometry3d T_world_camera = msg::to_isometry(joined.result.T_world_camera);
    if (map_.integrate(image, mask, T_world_camera).outcome != FusionReport::Outcome::kFused) return;
    navigation_.integrate(image, T_world_camera);
  }

  FrameJoiner joiner_{{.every = 1, .needs_masks = false}};
  StaticMap map_{small_config()};
  NavigationMap navigation_{small_plan(), -Eigen::Vector3d::UnitY()};
};

msg::TrackingResult result_of(std::uint64_t seq) {
  msg::TrackingResult result{};
  result.seq = seq;
  result.stamp_ns = SmallFrames::stamp_ns(seq);
  result.T_world_camera = msg::to_message(SmallFrames::T_world_camera(seq));
  result.state = msg::TrackingState::kOk;
  return result;
}

msg::KeyframeEvent event_of(std::uint64_t seq) {
  return {seq,
          seq,
          SmallFrames::stamp_ns(seq),
          msg::to_message(SmallFrames::T_world_camera(seq)),
          static_cast<std::uint32_t>(seq % 100),
          msg::KeyframeEventKind::kCreated};
}

msg::Image mask_of(std::uint64_t seq) {
  constexpr std::uint32_t kColumns = 24, kRows = 18;
  return {{msg::to_time(SmallFrames::stamp_ns(seq)), "camera"},
          kRows,
          kColumns,
          "mono8",
          0,
          kColumns,
          std::vector<std::uint8_t>(kColumns * kRows, DynamicMask::kStatic)};
}

class Attack {
 public:
  explicit Attack(rtd::testing::RedWatch& watch) : watch_(watch), attacker_(watch.seed()) {}

  int run() {
    for (; watch_.messages() < 800 && watch_.more();) step(false);
    watch_.call("publish", [&] { target_->publish(); });
    watch_.settled();
    while (watch_.more()) {
      if (attacker_.one_in(4000)) target_ = std::make_unique<Target>();
      step(!attacker_.one_in(3));
      if (seq_ % 200 == 0) watch_.call("publish", [&] { target_->publish(); });
    }
    return watch_.finish();
  }

 private:
  void step(bool hostile) {
    ++seq_;
    for (std::uint64_t more = hostile ? 1 + attacker_.below(6) : 1; more > 0; --more) {
      give("keyframe event", event_of(seq_), hostile);
      give("mask", mask_of(seq_), hostile);
    }
    if (attacker_.one_in(2)) give_frame(hostile && attacker_.one_in(2));
    give("pose", result_of(seq_), hostile);
    watch_.call("work", [&] { target_->work(); });
  }

  template <class Message>
  void give(const char* what, Message message, bool hostile) {
    if (hostile) attacker_.attack(message);
    if (watch_.passes(message)) watch_.call(what, [&] { target_->put(message); });
  }

  void give_frame(bool hostile) {
    const auto frame = std::make_shared<msg::RgbdFrame>();
    SmallFrames::paint(seq_, *frame);
    if (hostile) attacker_.attack(*frame);
    if (hostile && attacker_.one_in(8)) {
      frame->width = static_cast<std::uint32_t>(1 + attacker_.below(200));
      frame->height = static_cast<std::uint32_t>(1 + attacker_.below(4));
    }
    if (watch_.passes(*frame)) watch_.call("frame", [&] { target_->put(frame); });
  }

  rtd::testing::RedWatch& watch_;
  rtd::testing::Attacker attacker_;
  std::unique_ptr<Target> target_ = std::make_unique<Target>();
  std::uint64_t seq_ = 0;
};

}  // namespace
}  // namespace rtd::dense

int main(int argc, char** argv) {
  rtd::testing::RedWatch watch("red_dense", 8000, argc, argv);
  return rtd::dense::Attack(watch).run();
}
