// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/trajectory_diff.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace rtd::recordings {
namespace {

using Json = nlohmann::ordered_json;

double seconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

/// Exactly zero for equal poses: rounding must not make them differ.
PoseDifference difference(const geometry::StampedPose& a, const geometry::StampedPose& b) {
  PoseDifference result{a.stamp_ns, 0, 0};
  if (a.T_world_body.matrix() == b.T_world_body.matrix()) return result;
  result.translation_m = (a.T_world_body.translation() - b.T_world_body.translation()).norm();
  const Eigen::Quaterniond turn(a.T_world_body.linear().transpose() * b.T_world_body.linear());
  result.rotation_deg = 2 * std::atan2(turn.vec().norm(), std::abs(turn.w())) * 180 / std::numbers::pi;
  return result;
}

void count(TrajectoryDiff& result, const PoseDifference& pair, const PoseTolerance& tolerance) {
  ++result.pairs;
  if (pair.translation_m <= tolerance.translation_m && pair.rotation_deg <= tolerance.rotation_deg) return;
  ++result.differing;
  if (!result.first) result.first = result.largest_translation = result.largest_rotation = pair;
  if (pair.translation_m > result.largest_translation->translation_m) result.largest_translation = pair;
  if (pair.rotation_deg > result.largest_rotation->rotation_deg) result.largest_rotation = pair;
}

std::string row(const char* name, const std::optional<PoseDifference>& at) {
  if (!at) return "";
  return fmt::format("{:<20} {:.9f}  {:.6g} m  {:.6g} deg\n", name, seconds(at->stamp_ns), at->translation_m,
                     at->rotation_deg);
}

std::string missing_row(const char* name, const std::vector<std::int64_t>& stamps_ns) {
  if (stamps_ns.empty()) return "";
  return fmt::format("{:<20} {} poses, {:.9f} to {:.9f}\n", name, stamps_ns.size(), seconds(stamps_ns.front()),
                     seconds(stamps_ns.back()));
}

Json json_of(const std::optional<PoseDifference>& at) {
  if (!at) return nullptr;
  return {{"stamp_ns", at->stamp_ns}, {"translation_m", at->translation_m}, {"rotation_deg", at->rotation_deg}};
}

}  // namespace

TrajectoryDiff diff(const geometry::Trajectory& a, const geometry::Trajectory& b, const PoseTolerance& tolerance) {
  TrajectoryDiff result;
  result.poses_a = a.size();
  result.poses_b = b.size();
  const std::int64_t together_ns = std::llround(tolerance.stamp_s * 1e9);
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (std::abs(a[i].stamp_ns - b[k].stamp_ns) <= together_ns) {
      count(result, difference(a[i++], b[k++]), tolerance);
    } else if (a[i].stamp_ns < b[k].stamp_ns) {
      result.only_a_ns.push_back(a[i++].stamp_ns);
    } else {
      result.only_b_ns.push_back(b[k++].stamp_ns);
    }
  }
  for (; i < a.size(); ++i) result.only_a_ns.push_back(a[i].stamp_ns);
  for (; k < b.size(); ++k) result.only_b_ns.push_back(b[k].stamp_ns);
  return result;
}

std::string to_text(const TrajectoryDiff& diff) {
  const std::string verdict = diff.equal() ? "equal" : fmt::format("{} of {} pairs differ", diff.differing, diff.pairs);
  return fmt::format("{:<20} {} in A, {} in B: {}\n", "poses", diff.poses_a, diff.poses_b, verdict) +
         row("first difference", diff.first) + row("largest translation", diff.largest_translation) +
         row("largest rotation", diff.largest_rotation) + missing_row("only in A", diff.only_a_ns) +
         missing_row("only in B", diff.only_b_ns);
}

Json to_json(const TrajectoryDiff& diff) {
  return {{"kind", "trajectories"},
          {"equal", diff.equal()},
          {"poses_a", diff.poses_a},
          {"poses_b", diff.poses_b},
          {"pairs", diff.pairs},
          {"differing", diff.differing},
          {"first", json_of(diff.first)},
          {"largest_translation", json_of(diff.largest_translation)},
          {"largest_rotation", json_of(diff.largest_rotation)},
          {"only_a_ns", diff.only_a_ns},
          {"only_b_ns", diff.only_b_ns}};
}

}  // namespace rtd::recordings
