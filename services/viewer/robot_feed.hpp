// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/viewer/core/page_hub.hpp"
#include "services/viewer/dispatcher.hpp"

namespace rtd::viewer {

/// CLOCK_REALTIME, ms since 1970, as a page's clock.
inline double wall_clock_ms() {
  return 1e-6 * static_cast<double>(service::realtime_ns());
}

/// The robots that a page lists when the domain has these topics: all with a name, and "" when services without one
/// have more than a heartbeat, as this viewer and a detector for several robots have.
std::set<std::string> shown_robots(const std::vector<std::string>& wire_names);

/// Reads the topics of one robot into its mirror. Poses, keyframes and heartbeats always; what is large or costs its
/// publisher work, only while a page wants it. The readers' threads only post.
class RobotFeed {
 public:
  /// `mirror` outlives the feed.
  RobotFeed(std::shared_ptr<bus::Bus> bus, RobotMirror& mirror, Dispatcher dispatcher);

  /// What is read now besides poses, keyframes and heartbeats.
  void set_options(const PageOptions& wanted);
  RobotMirror& mirror() { return mirror_; }

 private:
  template <class T>
  void read(bus::Reader<T>& reader, const bus::Topic<T>& topic, bool wanted, auto take);

  const std::shared_ptr<bus::Bus> bus_;
  RobotMirror& mirror_;
  const Dispatcher dispatcher_;
  std::optional<PageOptions> options_;
  bus::Reader<msg::TrackingResult> tracking_;
  bus::Reader<msg::KeyframeEvent> keyframes_;
  bus::Reader<msg::ServiceStatus> status_;
  bus::Reader<msg::MapUpdate> map_;
  bus::Reader<msg::Movers> movers_;
  bus::Reader<msg::PoseStamped> truth_;
  bus::Reader<msg::CompressedImage> images_, depths_;
  bus::Reader<msg::FeatureFrame> features_;
  bus::Reader<msg::Detection2DArray> detections_;
  bus::Reader<msg::Image> masks_, people_;
  bus::Reader<msg::PointCloud2> dense_, moving_;
  bus::Reader<msg::OccupancyGrid> plan_;
};

}  // namespace rtd::viewer
