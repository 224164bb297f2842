// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <ctime>
#include <memory>
#include <span>
#include <string>

#include "common/msg/atlas.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/atlas/core/atlas.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/core/store/map_store.hpp"
#include "services/slam/keyframe_sender.hpp"
#include "services/slam/map_publisher.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::test_support {

/// A frame whose place is asked for.
inline msg::KeyframeFeatures query_of(const msg::FeatureFrame& message) {
  return slam::make_features(*slam::make_frame(message, slam::SlamConfig().sensor).frame);
}

inline slam::MapContents map_of(const msg::Submap& submap) {
  return slam::read_map(io::MemorySource(std::as_bytes(std::span(submap.file))));
}

/// What the slam of a robot sends to an atlas: what changed in its map, and what it is asked for.
class AtlasTeller {
 public:
  AtlasTeller(std::string name, slam::SlamSystem& slam) : name_(std::move(name)), slam_(slam) {}
  const std::string& name() const { return name_; }

  void report(atlas::Atlas& atlas) {
    const slam::MapView view = slam_.map_view();
    const slam::MapNews news = changes_.update(view);
    for (msg::MapUpdate& update : slam::make_map_updates(view, news)) {
      update.session_ns = session_ns;
      update.revision = ++revision_;
      atlas.follow(name_, update, view.keyframes.back().stamp_ns + clock_behind_ns);
    }
    for (const std::uint32_t id : atlas.missing(name_, 100).keyframe_ids) {
      msg::KeyframeFeatures features =
          slam_.read_map([&](const slam::Map& map) { return slam::make_features(map, *map.find_keyframe(id), true); });
      features.session_ns = session_ns;
      bytes_sent += 128 + sizeof(msg::KeyframeFeature) * features.features.size();
      const std::clock_t start = std::clock();
      if (atlas.add(name_, features)) ++keyframes_taken;
      add_s.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    const std::clock_t start = std::clock();
    if (atlas.straighten()) straighten_s.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  /// As for a reader that is new.
  void forget_reported() {
    changes_.forget();
    ++session_ns;
  }

  std::int64_t session_ns = 1;
  std::int64_t clock_behind_ns = 0;  ///< of the robot
  std::size_t bytes_sent = 0;        ///< of features
  int keyframes_taken = 0;
  std::vector<double> add_s, straighten_s;  ///< what the atlas took for each, CPU

 private:
  std::string name_;
  slam::SlamSystem& slam_;
  slam::MapChanges changes_;
  std::uint64_t revision_ = 0;
};

/// A robot that walks through a FeatureWorld.
class AtlasRobot {
 public:
  AtlasRobot(std::string name, const FeatureWorld& world, std::uint64_t first_seq)
      : world_(world), first_(first_seq), slam_(make_slam()), teller_(std::move(name), slam_) {}

  /// The true pose of its map's frame in that of the world, for a robot that began with a map of its own.
  Eigen::Isometry3d T_world_map() const { return FeatureWorld::T_world_camera(first_) * T_map_first_.inverse(); }
  /// In the world, of the camera at one of its stamps.
  Eigen::Isometry3d T_world_camera(std::int64_t stamp_ns) const {
    constexpr double kPeriodNs = 33'333'333;
    const auto since_ns = static_cast<double>(stamp_ns - FeatureWorld::stamp_ns(0)) - static_cast<double>(first_);
    return FeatureWorld::T_world_camera(static_cast<std::uint64_t>(std::llround(since_ns / kPeriodNs)));
  }
  const std::string& name() const { return teller_.name(); }
  slam::SlamSystem& slam() { return slam_; }
  AtlasTeller& teller() { return teller_; }

  /// `frames` more, reported to the atlas twice a second.
  void walk(int frames, atlas::Atlas& atlas) {
    for (int i = 0; i < frames; ++i) {
      const std::uint64_t seq = first_ + seen_++;
      const auto frame = world_.view(seq);
      frame->stamp_ns += static_cast<std::int64_t>(first_) - teller_.clock_behind_ns;  // robots have their own clocks
      const slam::SlamOutput output = slam_.process(*frame);
      if (seen_ == 1) T_map_first_ = output.result.T_world_camera;
      if (seen_ % 15 == 0) teller_.report(atlas);
    }
  }

 private:
  static slam::SlamSystem make_slam() {
    slam::SlamConfig config = settled();
    config.sensor.calibration_error = 0;
    return {config, slam::MappingMode::kSynchronous, frozen_clock};
  }

  const FeatureWorld& world_;
  std::uint64_t first_, seen_ = 0;
  slam::SlamSystem slam_;
  AtlasTeller teller_;
  Eigen::Isometry3d T_map_first_ = Eigen::Isometry3d::Identity();
};

inline const msg::AtlasRobot& robot_in(const msg::AtlasState& state, const std::string& name) {
  for (const msg::AtlasRobot& robot : state.robots)
    if (robot.name == name) return robot;
  throw std::out_of_range(name);
}

}  // namespace rtd::test_support
