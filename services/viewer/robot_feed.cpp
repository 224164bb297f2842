// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/robot_feed.hpp"

#include <algorithm>

#include "common/bus/robot.hpp"
#include "common/msg/fields.hpp"
#include "common/msg/stamps.hpp"
#include "common/ros2/schema_texts.hpp"
#include "common/service/log.hpp"
#include "services/viewer/core/page_messages.hpp"

namespace rtd::viewer {
namespace {

/// When a pose was ready, ms since 1970: known on the same host only, else now.
double finished_ms(const msg::TrackingResult& result) {
  const double age_ms = 1e-6 * static_cast<double>(msg::minus_ns(service::monotonic_ns(), result.finished_ns));
  constexpr double kOldest_ms = 10'000;
  return wall_clock_ms() - (age_ms >= 0 && age_ms < kOldest_ms ? age_ms : 0);
}

/// Topics below "rt/" may be those of a camera driver that a robot with a name reads; an atlas serves several robots.
bool is_of_unnamed_robot(const std::string& wire_name) {
  const bool own = bus::split_robot(wire_name).robot.empty() && bus::topic_of_robot(wire_name, "a") != wire_name;
  return own && !wire_name.starts_with("rt/") && wire_name != bus::topics::kStatus.name &&
         wire_name != bus::topics::kAtlas.name && wire_name != ros2::kSchemasTopic;
}

/// Of a message in memory, nearly.
template <class T>
std::size_t bytes_of(const T& value) {
  std::size_t bytes = sizeof(T);
  if constexpr (msg::Message<T>) {
    msg::for_each_field(value, [&](const char*, const auto& field) { bytes += bytes_of(field) - sizeof(field); });
  } else if constexpr (requires { value.capacity(); }) {
    using Element = typename T::value_type;
    bytes += value.size() * sizeof(Element);
    if constexpr (msg::Message<Element>)
      for (const Element& element : value) bytes += bytes_of(element) - sizeof(Element);
  }
  return bytes;
}

}  // namespace

std::set<std::string> shown_robots(const std::vector<std::string>& wire_names) {
  std::set<std::string> robots = bus::robots_in(wire_names);
  if (std::ranges::any_of(wire_names, is_of_unnamed_robot)) robots.insert("");
  return robots;
}

RobotFeed::RobotFeed(std::shared_ptr<bus::Bus> bus, RobotMirror& mirror, Dispatcher dispatcher)
    : bus_(std::move(bus)), mirror_(mirror), dispatcher_(std::move(dispatcher)) {
  using namespace bus::topics;
  read(tracking_, kTracking, true,
       [](RobotMirror& to, const msg::TrackingResult& result) { to.add(result, finished_ms(result)); });
  read(keyframes_, kKeyframes, true, [](RobotMirror& to, const msg::KeyframeEvent& event) { to.map().add(event); });
  read(status_, kStatus, true,
       [](RobotMirror& to, const msg::ServiceStatus& status) { to.add(status, service::monotonic_ns()); });
}

/// Opens or closes a reader. `take` runs in the viewer's thread.
template <class T>
void RobotFeed::read(bus::Reader<T>& reader, const bus::Topic<T>& topic, bool wanted, auto take) {
  if (wanted == static_cast<bool>(reader)) return;
  if (!wanted) {
    reader = {};
    return;
  }
  try {
    reader = bus_->reader(topic, [this, take](std::shared_ptr<const T> message) {
      const std::size_t bytes = bytes_of(*message);
      dispatcher_.deliver([&mirror = mirror_, take, message = std::move(message)] { take(mirror, *message); }, bytes);
    });
  } catch (const bus::BusError& error) {
    SPDLOG_WARN("event=not_read topic={} cause=\"{}\"", topic.name, error.what());
  }
}

void RobotFeed::set_options(const PageOptions& wanted) {
  if (wanted == options_) return;
  options_ = wanted;
  using namespace bus::topics;
  read(map_, kMap, wanted.points, [](RobotMirror& to, const msg::MapUpdate& update) { to.map().add(update); });
  read(movers_, kMovers, true, [](RobotMirror& to, const msg::Movers& movers) { to.add(movers); });
  read(truth_, kGroundTruth, true, [](RobotMirror& to, const msg::PoseStamped& pose) {
    const msg::Point& position = pose.pose.position;
    to.add_truth(to_ns(pose.header.stamp), {position.x, position.y, position.z});
  });
  read(images_, kColorJpeg, wanted.image, [](RobotMirror& to, const msg::CompressedImage& image) { to.add(image); });
  read(features_, kFeatures, wanted.features, [](RobotMirror& to, const msg::FeatureFrame& frame) { to.add(frame); });
  read(detections_, kDetections, wanted.image,
       [](RobotMirror& to, const msg::Detection2DArray& detections) { to.add(detections); });
  read(masks_, kDynamicMask, wanted.mask, [](RobotMirror& to, const msg::Image& mask) { to.add(mask); });
  read(people_, kPersonMasks, wanted.people, [](RobotMirror& to, const msg::Image& masks) { to.add_people(masks); });
  read(dense_, kDensePoints, wanted.dense,
       [](RobotMirror& to, const msg::PointCloud2& cloud) { to.add(CloudKind::kStatic, cloud); });
  read(moving_, kMovingPoints, wanted.moving,
       [](RobotMirror& to, const msg::PointCloud2& cloud) { to.add(CloudKind::kMoving, cloud); });
  read(depths_, kDepthJpeg, wanted.depth,
       [](RobotMirror& to, const msg::CompressedImage& picture) { to.add_depth(picture); });
  read(plan_, kOccupancyGrid, wanted.plan, [](RobotMirror& to, const msg::OccupancyGrid& plan) { to.add(plan); });
}

}  // namespace rtd::viewer
