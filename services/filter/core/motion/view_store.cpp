// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/view_store.hpp"

#include <algorithm>
#include <array>

#include "common/geometry/se3.hpp"

namespace rtd::filter {
namespace {

constexpr std::int64_t kPastStepNs = 250'000'000;
constexpr double kNewWorldM = 0.25, kNewWorldRad = 0.25;    // slam and the filter differ by more: another world
constexpr double kCorrectedM = 0.05, kCorrectedRad = 0.05;  // a keyframe moved by more: slam has corrected its map
constexpr double kSameWayRad = 0.5;                         // a keyframe worth comparing with
constexpr std::array<std::int64_t, 4> kAgesNs{100'000'000, 270'000'000, 550'000'000, 1'000'000'000};

auto find_seq(std::deque<View>& views, std::uint64_t seq) {
  return std::find_if(views.begin(), views.end(), [seq](const View& view) { return view.seq == seq; });
}

}  // namespace

void ViewStore::add(View view) {
  recent_.push_back(std::move(view));
  const auto outdated = [this] {
    return recent_.size() > kMinRecent && msg::minus_ns(recent_.back().stamp_ns, recent_.front().stamp_ns) > kRecentNs;
  };
  while (recent_.size() > kMaxRecent || outdated()) retire_oldest();
}

void ViewStore::retire_oldest() {
  View& oldest = recent_.front();
  if (oldest.settled && (past_.empty() || msg::minus_ns(oldest.stamp_ns, past_.back().stamp_ns) >= kPastStepNs)) {
    past_.push_back(std::move(oldest));
    if (past_.size() > kMaxPast) past_.pop_front();
  }
  recent_.pop_front();
}

void ViewStore::clear() {
  recent_.clear();
  past_.clear();
  keyframes_.clear();
}

bool ViewStore::correct(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) {
  const auto found = find_seq(recent_, seq);
  if (found == recent_.end()) return true;
  const Eigen::Isometry3d T_new_old = T_world_camera * found->T_world_camera.inverse();
  const Eigen::Isometry3d T_camera_change = found->T_world_camera.inverse() * T_world_camera;
  found->T_world_camera = T_world_camera;
  found->posed_by_slam = true;
  for (auto later = found + 1; later != recent_.end(); ++later) {
    if (!later->posed_by_slam) later->T_world_camera = geometry::normalized(T_new_old * later->T_world_camera);
  }
  if (T_camera_change.translation().norm() < kNewWorldM && geometry::rotation_angle_rad(T_camera_change) < kNewWorldRad)
    return true;
  forget_before(seq);
  return false;
}

void ViewStore::forget_before(std::uint64_t seq) {
  while (recent_.size() > 1 && recent_.front().seq < seq) recent_.pop_front();
  past_.clear();
  keyframes_.clear();
}

bool ViewStore::mark_keyframe(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) {
  const auto found = find_seq(recent_, seq);
  bool corrected = false;
  if (found != recent_.end() && found->posed_by_slam) {
    const Eigen::Isometry3d T_old_new = found->T_world_camera.inverse() * T_world_camera;
    corrected = T_old_new.translation().norm() > kCorrectedM || geometry::rotation_angle_rad(T_old_new) > kCorrectedRad;
    if (corrected) move_along(T_world_camera * found->T_world_camera.inverse());
  }
  if (const auto known = find_seq(keyframes_, seq); known != keyframes_.end()) {
    known->T_world_camera = T_world_camera;
  } else if (found != recent_.end()) {
    keyframes_.push_back(*found);
    keyframes_.back().T_world_camera = T_world_camera;
    if (keyframes_.size() > kMaxKeyframes) keyframes_.pop_front();
  }
  return !corrected;
}

void ViewStore::move_along(const Eigen::Isometry3d& T_new_old) {
  for (std::deque<View>* views : {&recent_, &past_}) {
    for (View& view : *views) view.T_world_camera = geometry::normalized(T_new_old * view.T_world_camera);
  }
}

void ViewStore::forget_keyframe(std::uint64_t seq) {
  std::erase_if(keyframes_, [seq](const View& view) { return view.seq == seq; });
}

const View* ViewStore::at(std::int64_t stamp_ns) const {
  const auto found =
      std::find_if(recent_.rbegin(), recent_.rend(), [&](const View& view) { return view.stamp_ns == stamp_ns; });
  return found == recent_.rend() ? nullptr : &*found;
}

const View& ViewStore::of_age(std::int64_t now_ns, std::int64_t age_ns) const {
  const std::int64_t then_ns = msg::minus_ns(now_ns, age_ns);
  return *std::min_element(recent_.begin(), recent_.end(), [&](const View& a, const View& b) {
    if (a.settled != b.settled) return a.settled;
    return msg::apart_ns(then_ns, a.stamp_ns) < msg::apart_ns(then_ns, b.stamp_ns);
  });
}

const View& ViewStore::long_ago(std::int64_t now_ns, std::int64_t age_ns) const {
  const std::int64_t then_ns = msg::minus_ns(now_ns, age_ns);
  const auto off_by = [&](const View& view) { return msg::apart_ns(then_ns, view.stamp_ns); };
  const View* best = &of_age(now_ns, age_ns);
  for (const View& view : past_) {
    if (off_by(view) < off_by(*best)) best = &view;
  }
  return *best;
}

std::vector<const View*> ViewStore::references(std::int64_t now_ns, const Eigen::Isometry3d& T_world_camera,
                                               const ReferenceLimits& limits) const {
  std::vector<const View*> chosen;
  if (recent_.empty()) return chosen;
  for (const std::int64_t age_ns : kAgesNs) {
    const View* view = &of_age(now_ns, age_ns);
    if (chosen.size() < limits.count && std::find(chosen.begin(), chosen.end(), view) == chosen.end())
      chosen.push_back(view);
  }
  for (const View* keyframe : near_keyframes(T_world_camera, {kMaxKeyframes, limits.max_baseline_m})) {
    if (chosen.size() < limits.count && keyframe->seq < recent_.front().seq) chosen.push_back(keyframe);
  }
  return chosen;
}

std::vector<const View*> ViewStore::near_keyframes(const Eigen::Isometry3d& T_world_camera,
                                                   const ReferenceLimits& limits) const {
  std::vector<std::pair<double, const View*>> near;
  for (const View& keyframe : keyframes_) {
    const Eigen::Isometry3d T_camera_keyframe = T_world_camera.inverse() * keyframe.T_world_camera;
    const double distance_m = T_camera_keyframe.translation().norm();
    const double angle_rad = geometry::rotation_angle_rad(T_camera_keyframe);
    if (distance_m < limits.max_baseline_m && angle_rad < kSameWayRad)
      near.emplace_back(distance_m / limits.max_baseline_m + angle_rad / kSameWayRad, &keyframe);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const View*> chosen;
  for (const auto& [cost, keyframe] : near) {
    if (chosen.size() < limits.count) chosen.push_back(keyframe);
  }
  return chosen;
}

Eigen::Isometry3d ViewStore::predict_pose(std::int64_t stamp_ns) const {
  constexpr std::int64_t kLongGapNs = 500'000'000;
  const View* before = second_newest();
  const Eigen::Isometry3d& T_world_newest = newest().T_world_camera;
  if (before == nullptr) return T_world_newest;
  const std::int64_t known_ns = msg::minus_ns(newest().stamp_ns, before->stamp_ns);
  const std::int64_t ahead_ns = msg::minus_ns(stamp_ns, newest().stamp_ns);
  if (known_ns <= 0 || known_ns > kLongGapNs || ahead_ns > kLongGapNs) return T_world_newest;
  const geometry::Vector6d step = geometry::se3_log(before->T_world_camera.inverse() * T_world_newest);
  const double steps = static_cast<double>(ahead_ns) / static_cast<double>(known_ns);
  return geometry::normalized(T_world_newest * geometry::se3_exp(steps * step));
}

}  // namespace rtd::filter
