// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Attacks the viewer: red_mirror [messages] [seed]. Hostile but well-formed messages of every topic that a page shows,
/// between good ones, go through the edge of the bus into the mirror of a robot while a page is shown everything. What
/// must hold: no crash, no sanitizer report, no exception, no call of a second, bounded memory (red_watch.hpp). The
/// preset asan-ubsan gives it its teeth.
#include <memory>

#include "common/msg/point_cloud.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/viewer/core/page_hub.hpp"
#include "services/viewer/core/page_messages.hpp"
#include "tests/fuzz/red/attack.hpp"
#include "tests/fuzz/red/red_watch.hpp"

namespace rtd::viewer {
namespace {

constexpr std::int64_t stamp_ns(std::uint64_t seq) {
  return 1'000'000'000'000 + static_cast<std::int64_t>(seq) * 33'333'333;
}

msg::Transform pose_of(std::uint64_t seq) {
  return {{0.01 * static_cast<double>(seq % 300), 0, 1}, {0, 0, 0, 1}};
}

template <class T>
T make(std::uint64_t seq);

template <>
msg::TrackingResult make(std::uint64_t seq) {
  msg::TrackingResult result{};
  result.seq = seq;
  result.stamp_ns = stamp_ns(seq);
  result.T_world_camera = pose_of(seq);
  result.state = msg::TrackingState::kOk;
  return result;
}

template <>
msg::KeyframeEvent make(std::uint64_t seq) {
  return {
      seq, seq, stamp_ns(seq), pose_of(seq), static_cast<std::uint32_t>(seq % 200), msg::KeyframeEventKind::kCreated};
}

template <>
msg::ServiceStatus make(std::uint64_t seq) {
  return {"filter", 7, 1, stamp_ns(seq), msg::ServiceState::kRunning, "", {{"frames", 1.0 * static_cast<double>(seq)}}};
}

template <>
msg::MapUpdate make(std::uint64_t seq) {
  msg::MapUpdate update{1, seq, {}, {1, 2}};
  for (std::uint64_t i = 0; i < 4; ++i) {
    const auto id = static_cast<std::uint32_t>((seq + i) % 200);
    update.keyframes.push_back(
        {id, 0, stamp_ns(id), pose_of(id), msg::kMapPoints | msg::kMapEdges, std::vector<float>(90, 1.5F), {id / 2}});
  }
  return update;
}

template <>
msg::Movers make(std::uint64_t seq) {
  return {seq, stamp_ns(seq), {{1, "person", {1, 1, 1}, {1, 1, 1}, {}, 0.1F, 0, {}}}};
}

template <>
msg::PoseStamped make(std::uint64_t seq) {
  return {{msg::to_time(stamp_ns(seq)), "map"}, {{0.01 * static_cast<double>(seq % 300), 0, 1}, {}}};
}

template <>
msg::CompressedImage make(std::uint64_t seq) {
  return {{msg::to_time(stamp_ns(seq)), "camera"}, "jpeg", std::vector<std::uint8_t>(600, 7)};
}

template <>
msg::Detection2DArray make(std::uint64_t seq) {
  msg::Detection2DArray boxes{{msg::to_time(stamp_ns(seq)), "camera"}, {}};
  boxes.detections.emplace_back().results.emplace_back().hypothesis = {"person", 0.9};
  boxes.detections[0].bbox = {{{100, 100}, 0}, 50, 90};
  return boxes;
}

template <>
msg::Image make(std::uint64_t seq) {
  return {{msg::to_time(stamp_ns(seq)), "camera"}, 12, 16, "mono8", 0, 16, std::vector<std::uint8_t>(192, 1)};
}

template <>
msg::PointCloud2 make(std::uint64_t seq) {
  const auto x = static_cast<float>(seq % 100);
  return msg::make_cloud({{x, 1, 2, 0}, {x, 2, 2, 0}, {1, 2, 3, 0}}, "rgb", stamp_ns(seq), "map");
}

template <>
msg::OccupancyGrid make(std::uint64_t seq) {
  msg::OccupancyGrid plan{.header = {msg::to_time(stamp_ns(seq)), "map"}};
  plan.info.resolution = 0.05F;
  plan.info.width = 8;
  plan.info.height = 4;
  plan.data.assign(32, static_cast<std::int8_t>(seq % 2 == 0 ? 0 : 100));
  return plan;
}

class Attack {
 public:
  explicit Attack(rtd::testing::RedWatch& watch) : watch_(watch), attacker_(watch.seed()) {
    features_->width = 640;
    features_->height = 480;
    features_->intrinsics = {500, 500, 320, 240};
    features_->count = 100;
    open_viewer();
  }

  int run() {
    for (; watch_.messages() < 2500 && watch_.more();) step(false);
    watch_.settled();
    while (watch_.more()) {
      if (attacker_.one_in(20)) open_page();
      if (attacker_.one_in(50)) open_viewer();
      step(!attacker_.one_in(3));
    }
    return watch_.finish();
  }

 private:
  /// Another viewer: how much a map may grow is a matter of its bounds, not of this attack.
  void open_viewer() {
    page_.reset();
    hub_ = std::make_unique<PageHub>(
        PageGreeting{.control = true}, PageLimits{.bytes_per_s = 1e9},
        PageHub::Hooks{.on_call = [](const auto&, const auto&, const auto&, const auto& answer) { answer({}); },
                       .now_ms = [] { return 0.0; }});
    mirror_ = hub_->robot("");
    open_page();
  }

  void open_page() {
    page_ = hub_->open();
    page_->on_text(R"({"op":"options","image":true,"mask":true,"points":true,"dense":true,"moving":true,"plan":true})");
  }

  void step(bool hostile) {
    ++seq_;
    give<msg::TrackingResult>("pose", hostile, [&](const auto& result) { mirror_->add(result, 1e12); });
    give<msg::KeyframeEvent>("keyframe event", hostile, [&](const auto& event) { mirror_->map().add(event); });
    give<msg::ServiceStatus>("status", hostile, [&](const auto& status) { mirror_->add(status, now_ns_); });
    give<msg::MapUpdate>("map", hostile, [&](const auto& update) { mirror_->map().add(update); });
    give<msg::Movers>("movers", hostile, [&](const auto& movers) { mirror_->add(movers); });
    give<msg::PoseStamped>("truth", hostile, [&](const auto& pose) {
      const msg::Point& at = pose.pose.position;
      mirror_->add_truth(to_ns(pose.header.stamp), {at.x, at.y, at.z});
    });
    give<msg::CompressedImage>("image", hostile, [&](const auto& image) { mirror_->add(image); });
    give<msg::Detection2DArray>("boxes", hostile, [&](const auto& boxes) { mirror_->add(boxes); });
    give<msg::Image>("mask", hostile, [&](const auto& mask) { mirror_->add(mask); });
    give<msg::Image>("people", hostile, [&](const auto& masks) { mirror_->add_people(masks); });
    give<msg::PointCloud2>("cloud", hostile, [&](const auto& cloud) { mirror_->add(CloudKind::kStatic, cloud); });
    give<msg::PointCloud2>("moving points", hostile,
                           [&](const auto& cloud) { mirror_->add(CloudKind::kMoving, cloud); });
    give<msg::OccupancyGrid>("floor plan", hostile, [&](const auto& plan) { mirror_->add(plan); });
    give_features(hostile);
    now_ns_ += 33'333'333;
    watch_.call("refresh", [&] { mirror_->refresh(now_ns_); });
    watch_.call("page", [&] {
      for (int i = 0; i < 20 && page_->next(now_ns_); ++i) {
      }
    });
  }

  template <class Message, class Core>
  void give(const char* what, bool hostile, const Core& core) {
    Message message = make<Message>(seq_);
    if (hostile) attacker_.attack(message);
    if (watch_.passes(message)) watch_.call(what, [&] { core(message); });
  }

  void give_features(bool hostile) {
    if (seq_ % 4 != 0) return;
    *attacked_ = *features_;
    attacked_->stamp_ns = stamp_ns(seq_);
    if (hostile) attacker_.attack(*attacked_);
    if (watch_.passes(*attacked_)) watch_.call("features", [&] { mirror_->add(*attacked_); });
  }

  rtd::testing::RedWatch& watch_;
  rtd::testing::Attacker attacker_;
  std::unique_ptr<PageHub> hub_;
  RobotMirror* mirror_ = nullptr;
  std::unique_ptr<Session> page_;
  std::unique_ptr<msg::FeatureFrame> features_ = std::make_unique<msg::FeatureFrame>(),
                                     attacked_ = std::make_unique<msg::FeatureFrame>();
  std::uint64_t seq_ = 0;
  std::int64_t now_ns_ = 1;
};

}  // namespace
}  // namespace rtd::viewer

int main(int argc, char** argv) {
  rtd::testing::RedWatch watch("red_mirror", 40000, argc, argv);
  return rtd::viewer::Attack(watch).run();
}
