// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/matcher.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "common/vision/features.hpp"
#include "services/slam/core/map/frame.hpp"

namespace rtd::slam {
namespace {

constexpr int kFar = 257;  // more than any Hamming distance

struct Nearest {
  int hamming = kFar, second = kFar;
  int octave = -1, second_octave = -1;
  std::uint32_t feature = 0;

  void offer(int distance, int candidate_octave, std::uint32_t candidate) {
    if (distance < hamming) {
      second = hamming;
      second_octave = octave;
      hamming = distance;
      octave = candidate_octave;
      feature = candidate;
    } else if (distance < second) {
      second = distance;
      second_octave = candidate_octave;
    }
  }
  /// Distinct: the runner-up of the same octave is clearly worse (of another octave it may be the same corner).
  bool distinct(double max_ratio) const { return octave != second_octave || hamming <= max_ratio * second; }
};

bool depth_agrees(const msg::Feature& feature, const SearchPoint& point, double disparity_px_m) {
  if (feature.depth_m <= 0) return true;
  return std::abs(disparity_px_m * (1.0 / feature.depth_m - point.inverse_depth_per_m)) <= point.window.radius_px;
}

Nearest find_nearest(const Frame& frame, const SearchPoint& point, const std::vector<char>& taken,
                     double disparity_px_m) {
  Nearest nearest;
  frame.grid.for_each(point.window, [&](std::uint32_t i) {
    const msg::Feature& feature = frame.features[i];
    if ((!taken.empty() && taken[i] != 0) || !depth_agrees(feature, point, disparity_px_m)) return;
    nearest.offer(vision::hamming_distance(feature.descriptor, *point.descriptor), feature.octave, i);
  });
  return nearest;
}

}  // namespace

std::vector<Match> keep_consistent_rotation(const std::vector<Match>& matches, std::span<const float> change_rad) {
  constexpr int kBins = 30, kKeptBins = 3;
  constexpr double kTwoPi = 2 * std::numbers::pi;
  std::array<int, kBins> counts{};
  std::vector<int> bins;
  bins.reserve(matches.size());
  for (const float change : change_rad) {
    const double turn = change / kTwoPi - std::floor(change / kTwoPi);
    bins.push_back(static_cast<int>(turn * kBins) % kBins);
    ++counts[static_cast<std::size_t>(bins.back())];
  }
  std::array<int, kBins> order{};
  for (int i = 0; i < kBins; ++i) order[static_cast<std::size_t>(i)] = i;
  const auto count_of = [&](int bin) { return counts[static_cast<std::size_t>(bin)]; };
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return count_of(a) != count_of(b) ? count_of(a) > count_of(b) : a < b; });
  std::array<bool, kBins> kept{};
  for (int rank = 0; rank < kKeptBins; ++rank) {
    const int bin = order[static_cast<std::size_t>(rank)];
    kept[static_cast<std::size_t>(bin)] = 10 * count_of(bin) >= count_of(order[0]);
  }
  std::vector<Match> consistent;
  consistent.reserve(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (kept[static_cast<std::size_t>(bins[i])]) consistent.push_back(matches[i]);
  }
  return consistent;
}

std::vector<Match> match_projected(const Frame& frame, std::span<const SearchPoint> points,
                                   const std::vector<char>& taken, const MatchRules& rules) {
  constexpr std::uint32_t kUnowned = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> owner(frame.features.size(), kUnowned);
  std::vector<int> owner_hamming(frame.features.size(), kFar);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Nearest nearest = find_nearest(frame, points[i], taken, rules.disparity_px_m);
    if (nearest.hamming > rules.max_hamming || !nearest.distinct(rules.max_ratio)) continue;
    if (nearest.hamming >= owner_hamming[nearest.feature]) continue;
    owner[nearest.feature] = i;
    owner_hamming[nearest.feature] = nearest.hamming;
  }
  std::vector<Match> matches;
  std::vector<float> change_rad;
  matches.reserve(owner.size());
  change_rad.reserve(owner.size());
  for (std::uint32_t feature = 0; feature < owner.size(); ++feature) {
    if (owner[feature] == kUnowned) continue;
    const SearchPoint& point = points[owner[feature]];
    matches.push_back({feature, point.tag, owner_hamming[feature]});
    change_rad.push_back(frame.features[feature].angle_rad - point.angle_rad);
  }
  return rules.rotation == RotationCheck::kOn ? keep_consistent_rotation(matches, change_rad) : matches;
}

std::vector<Match> match_by_descriptor(const Frame& frame, const Frame& other,
                                       std::span<const std::uint32_t> other_features, const MatchRules& rules) {
  std::vector<Nearest> from_other(other_features.size()), from_frame(frame.features.size());
  for (std::uint32_t i = 0; i < other_features.size(); ++i) {
    const msg::Descriptor& descriptor = other.features[other_features[i]].descriptor;
    for (std::uint32_t j = 0; j < frame.features.size(); ++j) {
      const int hamming = vision::hamming_distance(descriptor, frame.features[j].descriptor);
      from_other[i].offer(hamming, 0, j);
      from_frame[j].offer(hamming, 0, i);
    }
  }
  std::vector<Match> matches;
  std::vector<float> change_rad;
  for (std::uint32_t i = 0; i < other_features.size(); ++i) {
    const Nearest& nearest = from_other[i];
    if (nearest.hamming > rules.max_hamming || !nearest.distinct(rules.max_ratio)) continue;
    if (from_frame[nearest.feature].feature != i) continue;
    matches.push_back({nearest.feature, other_features[i], nearest.hamming});
    change_rad.push_back(frame.features[nearest.feature].angle_rad - other.features[other_features[i]].angle_rad);
  }
  return rules.rotation == RotationCheck::kOn ? keep_consistent_rotation(matches, change_rad) : matches;
}

std::optional<Projection> project(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                                  const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p_camera = T_camera_world * p_world;
  if (p_camera.z() < vision::kMinProjectionDepth_m) return std::nullopt;
  const Eigen::Vector2d pixel(frame.camera.fx * p_camera.x() / p_camera.z() + frame.camera.cx,
                              frame.camera.fy * p_camera.y() / p_camera.z() + frame.camera.cy);
  if (!frame.contains(pixel)) return std::nullopt;
  return Projection{pixel, p_camera.z()};
}

std::optional<PredictedView> predict_view(const Frame& frame, const Eigen::Isometry3d& T_world_camera,
                                          const Eigen::Isometry3d& T_camera_world, const LandmarkView& landmark) {
  constexpr double kRangeSlack = 1.2;  // one octave
  const auto projection = project(frame, T_camera_world, landmark.position);
  if (!projection) return std::nullopt;
  const Eigen::Vector3d ray = landmark.position - T_world_camera.translation();
  const double distance_m = ray.norm();
  if (distance_m * kRangeSlack < landmark.min_distance_m || distance_m > landmark.max_distance_m * kRangeSlack) {
    return std::nullopt;
  }
  const double view_cosine = ray.dot(landmark.normal) / distance_m;
  if (view_cosine < kMinViewCosine) return std::nullopt;
  return PredictedView{*projection, predict_octave(landmark.max_distance_m, distance_m), view_cosine};
}

SearchPoint make_search_point(const PredictedView& view, double radius_px, const msg::Descriptor& descriptor,
                              std::uint32_t tag) {
  const auto radius = static_cast<float>(radius_px * sigma_px(view.octave));
  return {{static_cast<float>(view.projection.pixel.x()), static_cast<float>(view.projection.pixel.y()), radius,
           view.octave - 1, view.octave},
          static_cast<float>(1.0 / view.projection.z_m),
          &descriptor,
          0.0F,
          tag};
}

}  // namespace rtd::slam
