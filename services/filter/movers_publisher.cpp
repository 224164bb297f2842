// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/movers_publisher.hpp"

#include <utility>

#include "common/msg/transform_eigen.hpp"

namespace rtd::filter {
namespace {

std::array<double, 3> to_array(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

msg::Mover to_message(const WorldMover& mover) {
  return {mover.id,
          mover.class_name,
          to_array(mover.extent_world.center()),
          to_array(mover.extent_world.sizes()),
          to_array(mover.velocity_world_m_s),
          static_cast<float>(mover.static_probability)};
}

}  // namespace

void MoversPublisher::add(std::uint64_t seq, std::int64_t stamp_ns, std::vector<ObjectSighting> sightings) {
  waiting_.push_back({seq, stamp_ns, std::move(sightings)});
  if (waiting_.size() > kMaxWaiting) waiting_.pop_front();
}

void MoversPublisher::on_result(const msg::TrackingResult& result) {
  while (!waiting_.empty() && waiting_.front().seq < result.seq) waiting_.pop_front();
  if (waiting_.empty() || waiting_.front().seq != result.seq) return;
  const Waiting frame = std::move(waiting_.front());
  waiting_.pop_front();
  if (!msg::is_measured_in_map(result)) return movers_.clear();
  msg::Movers message{frame.seq, frame.stamp_ns, {}};
  for (const WorldMover& mover :
       movers_.place(frame.stamp_ns, msg::to_isometry(result.T_world_camera), frame.sightings)) {
    message.movers.push_back(to_message(mover));
  }
  writer_.write(message);
}

void MoversPublisher::clear() {
  waiting_.clear();
  movers_.clear();
}

}  // namespace rtd::filter
