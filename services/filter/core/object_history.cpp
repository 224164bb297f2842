// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/object_history.hpp"

#include <algorithm>
#include <iterator>

namespace rtd::filter {
namespace {

/// Cells of both over cells of either.
double overlap(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  const std::size_t either = a.size() + b.size() - both.size();
  return either == 0 ? 0.0 : static_cast<double>(both.size()) / static_cast<double>(either);
}

}  // namespace

ObjectMotion judge_motion(const SceneObject& object, const DynamicRegions& regions, const DepthEvidence& evidence) {
  constexpr double kMovingShare = 0.2, kRestingShare = 0.3, kTolerated = 0.05;
  if (!regions.trusted || object.cells.empty()) return ObjectMotion::kUnknown;
  int dynamic = 0, consistent = 0;
  for (const int cell : object.cells) {
    dynamic += regions.frames_left[static_cast<std::size_t>(cell)] > 0 ? 1 : 0;
    consistent += evidence.consistent[static_cast<std::size_t>(cell)] > 0 ? 1 : 0;
  }
  const auto cells = static_cast<double>(object.cells.size());
  if (dynamic >= kMovingShare * cells) return ObjectMotion::kMoving;
  if (dynamic <= kTolerated * cells && consistent >= kRestingShare * cells) return ObjectMotion::kResting;
  return ObjectMotion::kUnknown;
}

const ObjectHistory::Known* ObjectHistory::same_object(const SceneObject& object) const {
  constexpr double kMinOverlap = 0.3;
  const Known* best = nullptr;
  double most = kMinOverlap;
  for (const Known& known : known_) {
    if (known.object.level != object.level) continue;
    const double share = overlap(known.object.cells, object.cells);
    if (share >= most) {
      most = share;
      best = &known;
    }
  }
  return best;
}

std::vector<double> ObjectHistory::update(const std::vector<SceneObject>& objects,
                                          const std::vector<ObjectMotion>& motions, std::int64_t stamp_ns) {
  std::vector<double> resting_s(objects.size(), 0.0);
  std::vector<Known> now;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Known* before = same_object(objects[i]);
    const bool rested = before != nullptr && before->motion == ObjectMotion::kResting;
    now.push_back({objects[i], motions[i], rested ? before->resting_since_ns : stamp_ns});
    if (motions[i] == ObjectMotion::kResting)
      resting_s[i] = 1e-9 * static_cast<double>(stamp_ns - now.back().resting_since_ns);
  }
  known_ = std::move(now);
  return resting_s;
}

}  // namespace rtd::filter
