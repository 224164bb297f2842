// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/movers_publisher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::filter {
namespace {

using geometry::RowMajor6d;

std::array<double, 3> to_array(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

msg::Mover to_message(const WorldMover& mover) {
  msg::Mover message{mover.id,
                     mover.class_name,
                     to_array(mover.extent_world.center()),
                     to_array(mover.extent_world.sizes()),
                     to_array(mover.velocity_world_m_s),
                     static_cast<float>(mover.static_probability),
                     static_cast<float>(mover.unseen_s),
                     {}};
  Eigen::Map<RowMajor6d>(message.covariance.data()) = mover.covariance;
  return message;
}

msg::Point to_point(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

/// What has no class is at least known to move.
std::string name_of(const WorldMover& mover) {
  return mover.class_name.empty() ? "unknown" : mover.class_name;
}

msg::Detection3D to_detection(const WorldMover& mover, const msg::Header& header) {
  constexpr double kAnyAngle_rad2 = std::numbers::pi * std::numbers::pi / 3;  // variance of an angle of any value
  msg::Detection3D detection;
  detection.header = header;
  detection.id = std::to_string(mover.id);
  const Eigen::Vector3d size_m = mover.extent_world.sizes();
  detection.bbox = {{to_point(mover.extent_world.center()), {}}, {size_m.x(), size_m.y(), size_m.z()}};
  msg::ObjectHypothesisWithPose& result = detection.results.emplace_back();
  result.hypothesis = {name_of(mover), mover.score};
  result.pose.pose = detection.bbox.center;
  RowMajor6d covariance = kAnyAngle_rad2 * RowMajor6d::Identity();
  covariance.topLeftCorner<3, 3>() = mover.covariance.topLeftCorner<3, 3>();
  Eigen::Map<RowMajor6d>(result.pose.covariance.data()) = covariance;
  return detection;
}

constexpr std::int32_t kArrow = 0, kCube = 1, kText = 9;  // visualization_msgs/Marker

msg::Marker new_marker(const WorldMover& mover, const msg::Header& header, const char* name, std::int32_t type) {
  constexpr std::uint32_t kLifetimeNs = 300'000'000;
  const float moves = static_cast<float>(1 - mover.static_probability);
  msg::Marker marker;
  marker.header = header;
  marker.ns = name;
  marker.id = static_cast<std::int32_t>(mover.id & 0x7fffffff);
  marker.type = type;
  marker.pose.position = to_point(mover.extent_world.center());
  marker.color = {moves, 1 - moves, 0.1F, mover.unseen_s > 0 ? 0.2F : 0.5F};
  marker.lifetime = {0, kLifetimeNs};
  return marker;
}

void add_markers(const WorldMover& mover, bool rests, const msg::Header& header, std::vector<msg::Marker>& markers) {
  constexpr double kText_m = 0.15;
  const Eigen::Vector3d middle = mover.extent_world.center(), size_m = mover.extent_world.sizes();
  msg::Marker& box = markers.emplace_back(new_marker(mover, header, "box", kCube));
  box.scale = {size_m.x(), size_m.y(), size_m.z()};
  msg::Marker& text = markers.emplace_back(new_marker(mover, header, "name", kText));
  text.text = fmt::format("{} {}", name_of(mover), mover.id);
  text.scale.z = kText_m;
  text.color.a = 1;
  if (rests) return;
  text.text += fmt::format("  {:.1f} m/s", mover.velocity_world_m_s.norm());
  msg::Marker& arrow = markers.emplace_back(new_marker(mover, header, "velocity", kArrow));
  arrow.pose.position = {};
  arrow.points = {to_point(middle), to_point(middle + mover.velocity_world_m_s)};
  arrow.scale = {0.04, 0.08, 0.1};  // m: shaft, head, length of the head
  arrow.color.a = 1;
}

}  // namespace

msg::Detection3DArray make_boxes(const std::vector<WorldMover>& movers, std::int64_t stamp_ns,
                                 const std::string& map_frame) {
  msg::Detection3DArray boxes{{msg::to_time(stamp_ns), map_frame}, {}};
  for (const WorldMover& mover : movers) boxes.detections.push_back(to_detection(mover, boxes.header));
  return boxes;
}

msg::MarkerArray make_markers(const std::vector<WorldMover>& movers, const std::vector<bool>& rest,
                              const msg::Header& header) {
  msg::MarkerArray markers;
  for (std::size_t i = 0; i < movers.size(); ++i) add_markers(movers[i], rest[i], header, markers.markers);
  return markers;
}

MoversPublisher::MoversPublisher(bus::Bus& bus, std::string map_frame)
    : writer_(bus.writer(bus::topics::kMovers)),
      boxes_(bus.writer(bus::topics::kMoverBoxes)),
      markers_(bus.writer(bus::topics::kMoverMarkers)),
      map_frame_(std::move(map_frame)) {}

void MoversPublisher::add(std::uint64_t seq, std::int64_t stamp_ns, std::vector<ObjectSighting> sightings) {
  waiting_.push_back({seq, stamp_ns, std::move(sightings)});
  if (waiting_.size() > kMaxWaiting) waiting_.pop_front();
}

void MoversPublisher::on_result(const msg::TrackingResult& result) {
  while (!waiting_.empty() && waiting_.front().seq < result.seq) waiting_.pop_front();
  if (waiting_.empty() || waiting_.front().seq != result.seq) return;
  const Waiting frame = std::move(waiting_.front());
  waiting_.pop_front();
  if (!msg::is_measured(result.state)) return;  // what is in view now may be known again when the camera is
  if (std::exchange(map_, result.map_id) != result.map_id) movers_.clear();  // another map is `map`: all has moved
  const std::vector<WorldMover> movers =
      movers_.place(frame.stamp_ns, msg::to_isometry(result.T_world_camera), frame.sightings);
  msg::Movers message{frame.seq, frame.stamp_ns, {}};
  for (const WorldMover& mover : movers) message.movers.push_back(to_message(mover));
  if (writer_.matched() > 0 && msg::is_measured_in_map(result)) writer_.write(message);
  if (boxes_.matched() > 0) boxes_.write(make_boxes(movers, frame.stamp_ns, map_frame_));
  if (markers_.matched() > 0)
    markers_.write(make_markers(movers, trails_.rest(message), {msg::to_time(frame.stamp_ns), map_frame_}));
}

void MoversPublisher::clear() {
  waiting_.clear();
  movers_.clear();
  trails_ = {};
}

}  // namespace rtd::filter
