// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Attacks slam: red_slam [messages] [seed]. Hostile but well-formed feature frames, IMU and wheel messages between
/// good ones go through the edge of the bus into the core; sessions end with a reset, as by its command. What must
/// hold: no crash, no sanitizer report, no exception, no call of a second, bounded memory (red_watch.hpp), finite
/// poses. The preset asan-ubsan gives it its teeth.
#include <memory>

#include "common/inertial/motion_feed.hpp"
#include "common/msg/imu.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/slam_messages.hpp"
#include "tests/fuzz/red/attack.hpp"
#include "tests/fuzz/red/red_watch.hpp"
#include "tests/support/feature_world.hpp"

namespace rtd::slam {
namespace {

using test_support::FeatureWorld;

FeatureWorld small_world() {
  FeatureWorld::Options options;
  options.points = 700;
  options.noise_px = 0.5;
  options.depth_noise_factor = 0.0015;
  options.flipped_bits = 8;
  return FeatureWorld(options);
}

SlamConfig config_of(std::uint64_t session) {
  SlamConfig config;
  config.prior.imu = session % 3 == 1;
  config.prior.wheels = session % 3 == 2;
  config.tracker.min_initial_points = 100;
  return config;
}

msg::Imu imu_of(std::int64_t stamp_ns) {
  msg::Imu imu;
  imu.header = {msg::to_time(stamp_ns), "imu"};
  imu.linear_acceleration = {0, 0, 9.8};
  return imu;
}

msg::Odometry wheels_of(std::int64_t stamp_ns) {
  msg::Odometry odometry;
  odometry.header = {msg::to_time(stamp_ns), "odom"};
  odometry.pose.pose.position.x = 1e-9 * static_cast<double>(stamp_ns % 1'000'000'000);
  return odometry;
}

class Attack {
 public:
  explicit Attack(rtd::testing::RedWatch& watch) : watch_(watch), attacker_(watch.seed()), world_(small_world()) {
    for (std::uint64_t seq = 0; seq < kViews; ++seq) views_.push_back(world_.view(seq));
  }

  int run() {
    for (std::uint64_t session = 0; watch_.more(); ++session) {
      begin(session);
      for (int step = 0; step < kSteps && watch_.more(); ++step) frame(session > 0 && !attacker_.one_in(3));
      if (session == 0) watch_.settled();
    }
    std::printf("%llu of %llu frames tracked, %llu keyframes at most\n", static_cast<unsigned long long>(tracked_),
                static_cast<unsigned long long>(frames_), static_cast<unsigned long long>(keyframes_));
    if (4 * tracked_ < frames_) std::fprintf(stderr, "less than a quarter of the frames were tracked\n");
    return broken_ > 0 || 4 * tracked_ < frames_ ? 1 : watch_.finish();
  }

 private:
  static constexpr std::uint64_t kViews = 120;
  static constexpr int kSteps = 400;

  /// Another system, or the same one after a reset.
  void begin(std::uint64_t session) {
    seq_ = 0;
    if (slam_ && session % 4 != 0) {
      watch_.call("reset", [&] { slam_->reset(); });
    } else {
      slam_ = std::make_unique<SlamSystem>(config_of(session), MappingMode::kSynchronous, test_support::frozen_clock);
    }
  }

  void frame(bool hostile) {
    ++seq_;
    *message_ = *views_[(seq_ / kViews % 2 == 0 ? seq_ : kViews - 1 - seq_ % kViews) % kViews];
    message_->seq = seq_;
    message_->stamp_ns = FeatureWorld::stamp_ns(seq_);
    give_motion(message_->stamp_ns, hostile);
    if (hostile) spoil(*message_);
    if (!watch_.passes(*message_)) return;
    watch_.call("frame", [&] { check(slam_->process(*message_)); });
  }

  void spoil(msg::FeatureFrame& frame) {
    attacker_.attack(frame);
    if (attacker_.one_in(10)) {
      for (std::uint32_t i = 0; i < std::min(frame.count, msg::kMaxFeatures); ++i) attacker_.spoil(frame.features[i]);
    }
    if (attacker_.one_in(20)) frame.count = msg::kMaxFeatures;
    if (attacker_.one_in(20)) {
      frame.width = static_cast<std::uint32_t>(1 + attacker_.below(500));
      frame.height = static_cast<std::uint32_t>(1 + attacker_.below(500));
    }
  }

  void give_motion(std::int64_t stamp_ns, bool hostile) {
    for (int i = 0; i < 2; ++i) {
      msg::Imu imu = imu_of(stamp_ns - 10'000'000 * (1 - i));
      if (hostile) attacker_.attack(imu);
      if (watch_.passes(imu)) watch_.call("imu", [&] { slam_->add(inertial::to_sample(imu)); });
    }
    msg::Odometry wheels = wheels_of(stamp_ns);
    if (hostile) attacker_.attack(wheels);
    if (watch_.passes(wheels)) watch_.call("wheels", [&] { slam_->add(to_sample(wheels)); });
  }

  /// What the next services would get.
  void check(const SlamOutput& output) {
    const msg::TrackingResult result = make_result(output.result);
    ++frames_;
    tracked_ += msg::is_measured(result.state) ? 1 : 0;
    keyframes_ = std::max<std::uint64_t>(keyframes_, result.keyframes);
    if (is_plausible(result) && output.result.T_world_camera.matrix().allFinite()) return;
    if (broken_++ == 0)
      std::fprintf(stderr, "message %llu: slam would publish a pose that is not finite, state %s\n",
                   static_cast<unsigned long long>(watch_.messages()), msg::to_string(output.result.state));
  }

  rtd::testing::RedWatch& watch_;
  rtd::testing::Attacker attacker_;
  FeatureWorld world_;
  std::vector<std::unique_ptr<msg::FeatureFrame>> views_;
  std::unique_ptr<SlamSystem> slam_;
  std::unique_ptr<msg::FeatureFrame> message_ = std::make_unique<msg::FeatureFrame>();
  std::uint64_t seq_ = 0, broken_ = 0, frames_ = 0, tracked_ = 0, keyframes_ = 0;
};

}  // namespace
}  // namespace rtd::slam

int main(int argc, char** argv) {
  rtd::testing::RedWatch watch("red_slam", 4000, argc, argv);
  return rtd::slam::Attack(watch).run();
}
