// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/map_mirror.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::viewer {
namespace {

bool is_finite(const msg::Transform& transform) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::ranges::all_of(transform.translation_m, finite) && std::ranges::all_of(transform.rotation_xyzw, finite);
}

}  // namespace

void MapMirror::reset() {
  keyframes_.clear();
  for (ChangeLog<std::uint32_t>* log : {&poses_, &points_, &edges_}) log->clear();
  loop_edges_.clear();
  trajectory_.clear();
  point_count_ = edge_count_ = 0;
  next_event_ = 0;
  ++loop_revision_;
  ++epoch_;
}

void MapMirror::add(const msg::MapUpdate& update) {
  if (session_ns_ != 0 && update.session_ns != session_ns_) reset();
  session_ns_ = update.session_ns;
  for (const msg::MapKeyframe& keyframe : update.keyframes) {
    if ((keyframe.content & msg::kMapRemoved) != 0) {
      remove(keyframe.keyframe_id);
      continue;
    }
    if (!move(keyframe.keyframe_id, keyframe.map_id, keyframe.T_world_camera)) continue;
    MirroredKeyframe& mirrored = keyframes_.at(keyframe.keyframe_id);
    if ((keyframe.content & msg::kMapPoints) != 0) {
      set_points(mirrored, keyframe.points_m);
      points_.touch(keyframe.keyframe_id);
    }
    if ((keyframe.content & msg::kMapEdges) != 0) {
      set_edges(mirrored, keyframe.covisible);
      edges_.touch(keyframe.keyframe_id);
    }
  }
  if (update.loop_edges == loop_edges_) return;
  if (update.loop_edges.size() > limits_.edges) {
    ++left_out_;
    return;
  }
  loop_edges_ = update.loop_edges;
  ++loop_revision_;
}

void MapMirror::add(const msg::KeyframeEvent& event) {
  if (event.event_index < next_event_) reset();  // slam was restarted
  next_event_ = event.event_index + 1;
  if (event.kind == msg::KeyframeEventKind::kRemoved) {
    remove(event.keyframe_id);
  } else {
    const auto known = keyframes_.find(event.keyframe_id);
    move(event.keyframe_id, known == keyframes_.end() ? 0 : known->second.map_id, event.T_world_camera);
  }
}

bool MapMirror::move(std::uint32_t id, std::uint32_t map_id, const msg::Transform& T_world_camera) {
  if (!is_finite(T_world_camera)) return false;
  if (keyframes_.size() >= limits_.keyframes && !keyframes_.contains(id)) {
    ++left_out_;
    return false;
  }
  const auto [place, added] = keyframes_.try_emplace(id);
  MirroredKeyframe& keyframe = place->second;
  const Eigen::Isometry3f pose = msg::to_isometry(T_world_camera).cast<float>();
  constexpr float kVisible = 1e-5F;  // m and rad
  if (!added && !keyframe.removed && keyframe.map_id == map_id && keyframe.T_world_camera.isApprox(pose, kVisible))
    return true;
  keyframe.map_id = map_id;
  keyframe.removed = false;
  keyframe.T_world_camera = pose;
  poses_.touch(id);
  return true;
}

void MapMirror::remove(std::uint32_t id) {
  const auto known = keyframes_.find(id);
  if (known == keyframes_.end() || known->second.removed) return;
  known->second.removed = true;
  set_points(known->second, {});
  set_edges(known->second, {});
  poses_.touch(id);
}

void MapMirror::set_points(MirroredKeyframe& keyframe, const std::vector<float>& points_m) {
  point_count_ -= keyframe.points_m.size();
  keyframe.points_m = {};  // gives the memory back, too
  const std::size_t room = std::min(points_m.size() / 3, limits_.points - point_count_);
  left_out_ += points_m.size() / 3 - room;
  keyframe.points_m.reserve(room);
  for (std::size_t first = 0; first < 3 * room; first += 3) {
    const Eigen::Vector3f point(points_m[first], points_m[first + 1], points_m[first + 2]);
    if (point.allFinite()) keyframe.points_m.push_back(point);
  }
  point_count_ += keyframe.points_m.size();
}

void MapMirror::set_edges(MirroredKeyframe& keyframe, const std::vector<std::uint32_t>& covisible) {
  edge_count_ -= keyframe.covisible.size();
  const std::size_t room = std::min(covisible.size(), limits_.edges - edge_count_);
  left_out_ += covisible.size() - room;
  keyframe.covisible.assign(covisible.begin(), covisible.begin() + static_cast<std::ptrdiff_t>(room));
  edge_count_ += room;
}

void MapMirror::add_position(const msg::TrackingResult& result) {
  const Eigen::Vector3d position_m(result.T_world_camera.translation_m.data());
  if (result.map_id != 0 || !position_m.allFinite()) return;
  if (trajectory_.size() >= limits_.trajectory) {
    ++left_out_;
    return;
  }
  const Eigen::Map<const geometry::Matrix6d> covariance(result.covariance.data());
  TrajectoryPoint point{.position_m = position_m.cast<float>(),
                        .stamp_ns = result.stamp_ns,
                        .sigma_m = static_cast<float>(geometry::largest_sigma(covariance.topLeftCorner<3, 3>())),
                        .state = result.state};
  for (auto newest = keyframes_.rbegin(); newest != keyframes_.rend(); ++newest) {
    if (newest->second.removed || newest->second.map_id != 0) continue;
    point.keyframe = newest->first;
    point.position_m = newest->second.T_world_camera.inverse() * point.position_m;
    break;
  }
  trajectory_.push_back(point);
}

}  // namespace rtd::viewer
