// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "services/slam/keyframe_sender.hpp"
#include "services/slam/map_publisher.hpp"
#include "tests/support/atlas_robot.hpp"
#include "tests/support/inbox.hpp"

namespace rtd::test_support {

/// The part of a robot's slam that reports its map on a bus, while it walks through a world.
class AtlasBusRobot {
 public:
  AtlasBusRobot(const bus::Bus& bus, const std::string& name, const FeatureWorld& world, std::uint64_t first_seq)
      : bus_(bus.of_robot(name)),
        submaps_reader_(bus_->reader<msg::Submap>(
            bus::topics::kSubmap,
            [inbox = submaps](std::shared_ptr<const msg::Submap> submap) { inbox.take(std::move(submap)); })),
        publisher_(
            *bus_, [this] { return view(); }, std::chrono::milliseconds(20)),
        sender_(*bus_, unlimited(), slam_, publisher_),
        world_(world),
        next_(first_seq) {}

  void walk(int frames) {
    for (int i = 0; i < frames; ++i) poses.push_back(slam_.process(*world_.view(next_++)).result.T_world_camera);
  }
  /// As a correction by its slam does.
  void move_map(double x_m) { moved_m_ = x_m; }
  void ask_where() { sender_.send(query_of(*world_.view(next_))); }

  Inbox<msg::Submap> submaps;
  std::vector<Eigen::Isometry3d> poses;  ///< T_map_camera of each frame

 private:
  static slam::ServiceConfig unlimited() {
    slam::ServiceConfig config;
    config.atlas.bytes_per_s = 1'000'000'000;
    return config;
  }

  slam::MapView view() const {
    slam::MapView view = slam_.map_view();
    for (slam::KeyframeView& keyframe : view.keyframes) keyframe.T_world_camera.translation().x() += moved_m_;
    return view;
  }

  std::atomic<double> moved_m_ = 0;
  slam::SlamSystem slam_{settled(), slam::MappingMode::kSynchronous, frozen_clock};
  std::shared_ptr<bus::Bus> bus_;
  bus::Reader<msg::Submap> submaps_reader_;
  slam::MapPublisher publisher_;
  slam::KeyframeSender sender_;
  const FeatureWorld& world_;
  std::uint64_t next_;
};

}  // namespace rtd::test_support
