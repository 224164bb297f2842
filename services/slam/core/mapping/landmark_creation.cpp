// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/mapping/mapping_steps.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/se3.hpp"
#include "common/vision/features.hpp"
#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/map/tiles.hpp"

namespace rtd::slam {
namespace {

constexpr double kMaxRatio = 0.8;
constexpr double kMaxChi2Line = 3.84;  // 95 %, 1 degree of freedom
/// Fewer tiles without depth are holes of the depth image. What lies beyond the range is taken to be this much farther.
constexpr std::size_t kFewestTilesBeyond = 6;
constexpr double kBeyondRange = 4.0 / 3;
constexpr std::ptrdiff_t kEnoughKnown = 400;  ///< landmarks: with so many, the rotation is well held
/// Shares of the features that have depth: of a sensor that is not blind; of a view that is known well enough by it.
constexpr double kApartFromHoles = 0.25, kMostOfTheView = 0.5;

/// Whether the sensor measured the depth of at least this share of the features.
bool measures_depth(const Frame& frame, double share) {
  const auto with_depth = std::count_if(frame.features.begin(), frame.features.end(),
                                        [](const msg::Feature& feature) { return feature.depth_m > 0; });
  return static_cast<double>(with_depth) >= share * static_cast<double>(frame.features.size());
}

/// A keyframe with what the search needs at hand.
struct PosedKeyframe {
  KeyframeId id;
  const Frame& frame;
  Eigen::Isometry3d T_world_camera, T_camera_world;
  const std::vector<LandmarkId>& landmarks;
  bool has_depth;  ///< of most things that are near

  explicit PosedKeyframe(const Keyframe& keyframe)
      : id(keyframe.id),
        frame(*keyframe.frame),
        T_world_camera(keyframe.T_world_camera),
        T_camera_world(keyframe.T_world_camera.inverse()),
        landmarks(keyframe.landmarks),
        has_depth(measures_depth(*keyframe.frame, kApartFromHoles)) {}

  std::vector<std::uint32_t> free_features() const {
    std::vector<std::uint32_t> free;
    for (std::uint32_t i = 0; i < landmarks.size(); ++i) {
      if (landmarks[i] == kNoLandmark) free.push_back(i);
    }
    return free;
  }
};

/// Fundamental matrix: x_1^T F x_2 = 0 for homogeneous pixels, docs/theory/mapping.md Eq. (4).
Eigen::Matrix3d fundamental(const PosedKeyframe& view1, const PosedKeyframe& view2) {
  const auto inverse_intrinsics = [](const vision::RgbdProjection& c) {
    Eigen::Matrix3d K_inverse;
    K_inverse << 1 / c.fx, 0, -c.cx / c.fx, 0, 1 / c.fy, -c.cy / c.fy, 0, 0, 1;
    return K_inverse;
  };
  const Eigen::Isometry3d T_1_2 = view1.T_camera_world * view2.T_world_camera;
  return inverse_intrinsics(view1.frame.camera).transpose() * geometry::skew(T_1_2.translation()) * T_1_2.linear() *
         inverse_intrinsics(view2.frame.camera);
}

/// The feature of `view2` among `free2` that lies on the epipolar line of feature1 and looks like it.
std::optional<std::uint32_t> search_epipolar(const PosedKeyframe& view1, std::uint32_t feature1,
                                             const PosedKeyframe& view2, const std::vector<std::uint32_t>& free2,
                                             const Eigen::Matrix3d& F_1_2) {
  const msg::Feature& f1 = view1.frame.features[feature1];
  const Eigen::Vector3d line = F_1_2.transpose() * Eigen::Vector3d(f1.u_px, f1.v_px, 1);
  const double line_norm2 = line.head<2>().squaredNorm();
  constexpr int kMaxHamming = 50;
  int best = kMaxHamming + 1, second = 257;
  std::optional<std::uint32_t> found;
  for (const std::uint32_t feature2 : free2) {
    const msg::Feature& f2 = view2.frame.features[feature2];
    const double distance = line.x() * f2.u_px + line.y() * f2.v_px + line.z();
    const double sigma = sigma_px(f2.octave);
    if (distance * distance > kMaxChi2Line * sigma * sigma * line_norm2) continue;
    const int hamming = vision::hamming_distance(f1.descriptor, f2.descriptor);
    if (hamming < best) {
      second = found ? best : second;
      best = hamming;
      found = feature2;
    } else {
      second = std::min(second, hamming);
    }
  }
  if (!found || best > kMaxRatio * second) return std::nullopt;
  return found;
}

/// Cosine of the parallax that a stereo pair would have which measures this depth as well as the sensor does.
double depth_parallax_cosine(const Frame& frame, const msg::Feature& feature) {
  if (feature.depth_m <= 0) return 2.0;  // worse than any ray parallax
  const double baseline_m = frame.camera.disparity_px_m / frame.camera.fx;
  return std::cos(2 * std::atan2(baseline_m / 2, feature.depth_m));
}

/// Triangulated or unprojected, whichever has the larger parallax.
std::optional<Eigen::Vector3d> locate(const PosedKeyframe& view1, std::uint32_t feature1, const PosedKeyframe& view2,
                                      std::uint32_t feature2) {
  constexpr double kMaxCosineWithoutDepth = 0.9998;  // 1.15 degrees
  const Eigen::Vector2d n1 = view1.frame.normalized(feature1), n2 = view2.frame.normalized(feature2);
  const Eigen::Vector3d ray1 = view1.T_world_camera.linear() * n1.homogeneous(),
                        ray2 = view2.T_world_camera.linear() * n2.homogeneous();
  const double ray_cosine = ray1.dot(ray2) / (ray1.norm() * ray2.norm());
  const double depth_cosine1 = depth_parallax_cosine(view1.frame, view1.frame.features[feature1]);
  const double depth_cosine2 = depth_parallax_cosine(view2.frame, view2.frame.features[feature2]);
  const double depth_cosine = std::min(depth_cosine1, depth_cosine2);
  const bool any_depth = depth_cosine < 2.0;
  if (ray_cosine > 0 && ray_cosine < depth_cosine && (any_depth || ray_cosine < kMaxCosineWithoutDepth)) {
    return triangulate(view1.T_camera_world, n1, view2.T_camera_world, n2);
  }
  if (!any_depth) return std::nullopt;
  if (depth_cosine1 <= depth_cosine2) return view1.T_world_camera * view1.frame.unproject(feature1);
  return view2.T_world_camera * view2.frame.unproject(feature2);
}

bool fits(const PosedKeyframe& view, std::uint32_t feature, const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p_camera = view.T_camera_world * p_world;
  if (p_camera.z() < vision::kMinProjectionDepth_m) return false;
  const auto measured = view.frame.measurement(feature);
  const double sigma = sigma_px(view.frame.features[feature].octave);
  const double chi2 = (vision::rgbd_residual(view.frame.camera, p_camera, measured) / sigma).squaredNorm();
  return chi2 <= (measured.has_depth() ? kMaxChi2Rgbd : kMaxChi2Pixel);
}

/// The ratio of distances must be the ratio of octaves within one and a half steps.
bool scale_agrees(const PosedKeyframe& view1, std::uint32_t feature1, const PosedKeyframe& view2,
                  std::uint32_t feature2, const Eigen::Vector3d& p_world) {
  constexpr double kSlack = 1.5 * kScaleFactor;
  const double distance1 = (p_world - view1.T_world_camera.translation()).norm();
  const double distance2 = (p_world - view2.T_world_camera.translation()).norm();
  if (distance1 <= 0 || distance2 <= 0) return false;
  const double ratio = distance2 / distance1;
  const double octave_ratio =
      sigma_px(view1.frame.features[feature1].octave) / sigma_px(view2.frame.features[feature2].octave);
  return ratio * kSlack >= octave_ratio && ratio <= octave_ratio * kSlack;
}

/// Whether this view should have measured the depth of a point, and did not: two features that only look alike meet
/// anywhere along their rays, mostly nearer than what a depth sensor leaves out.
bool misses_depth(const PosedKeyframe& view, std::uint32_t feature, const Eigen::Vector3d& p_world,
                  double close_depth_m) {
  return view.has_depth && !view.frame.measurement(feature).has_depth() &&
         (view.T_camera_world * p_world).z() < close_depth_m;
}

void create_with_neighbour(Map& map, KeyframeId keyframe, KeyframeId neighbour, double close_depth_m,
                           std::vector<LandmarkId>& created) {
  const PosedKeyframe view1(*map.find_keyframe(keyframe)), view2(*map.find_keyframe(neighbour));
  const double min_baseline_m = view1.frame.camera.disparity_px_m / view1.frame.camera.fx;
  if ((view1.T_world_camera.translation() - view2.T_world_camera.translation()).norm() < min_baseline_m) return;
  const Eigen::Matrix3d F_1_2 = fundamental(view1, view2);
  const std::vector<std::uint32_t> free1 = view1.free_features(), free2 = view2.free_features();
  for (const std::uint32_t feature1 : free1) {
    const auto feature2 = search_epipolar(view1, feature1, view2, free2, F_1_2);
    if (!feature2 || view2.landmarks[*feature2] != kNoLandmark) continue;
    const auto p_world = locate(view1, feature1, view2, *feature2);
    if (!p_world || !fits(view1, feature1, *p_world) || !fits(view2, *feature2, *p_world)) continue;
    if (!scale_agrees(view1, feature1, view2, *feature2, *p_world)) continue;
    if (misses_depth(view1, feature1, *p_world, close_depth_m) &&
        misses_depth(view2, *feature2, *p_world, close_depth_m)) {
      continue;
    }
    const LandmarkId landmark = map.add_landmark(*p_world, {keyframe, feature1});
    map.add_observation(landmark, {neighbour, *feature2});
    map.refresh_landmark(landmark);
    created.push_back(landmark);
  }
}

/// Where features have no depth, but for one in six.
Tiles tiles_beyond_range(const Frame& frame) {
  constexpr int kWithout = 5;
  std::array<int, kTiles> with{}, without{};
  for (const msg::Feature& f : frame.features) ++(f.depth_m > 0 ? with : without)[tile_of(frame, f.u_px, f.v_px)];
  Tiles tiles;
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    tiles.set(tile, without[tile] > 0 && without[tile] >= kWithout * with[tile]);
  }
  return tiles;
}

/// As far as the sensor sees: farther than most of the features.
double depth_range_m(const Frame& frame) {
  constexpr double kLeast_m = 4;
  std::vector<float> depths;
  for (const msg::Feature& feature : frame.features) {
    if (feature.depth_m > 0) depths.push_back(feature.depth_m);
  }
  if (depths.empty()) return kLeast_m;
  const auto far = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() * 95 / 100);
  std::nth_element(depths.begin(), far, depths.end());
  return std::max<double>(kLeast_m, *far);
}

}  // namespace

std::vector<std::uint32_t> select_close_features(const Frame& frame, const std::vector<LandmarkId>& landmarks,
                                                 double close_depth_m) {
  constexpr std::size_t kMinNearest = 100;
  std::vector<std::pair<float, std::uint32_t>> by_depth;
  by_depth.reserve(frame.features.size());
  for (std::uint32_t i = 0; i < frame.features.size(); ++i) {
    if (frame.features[i].depth_m > 0) by_depth.emplace_back(frame.features[i].depth_m, i);
  }
  std::sort(by_depth.begin(), by_depth.end());
  std::vector<std::uint32_t> selected;
  selected.reserve(by_depth.size());
  for (std::size_t rank = 0; rank < by_depth.size(); ++rank) {
    const auto [depth_m, feature] = by_depth[rank];
    if (depth_m > close_depth_m && rank >= kMinNearest) break;
    if (landmarks[feature] == kNoLandmark) selected.push_back(feature);
  }
  return selected;
}

std::vector<LandmarkId> create_from_depth(Map& map, KeyframeId id, double close_depth_m) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  std::vector<LandmarkId> created;
  for (const std::uint32_t feature : select_close_features(*keyframe.frame, keyframe.landmarks, close_depth_m)) {
    const Eigen::Vector3d p_world = keyframe.T_world_camera * keyframe.frame->unproject(feature);
    created.push_back(map.add_landmark(p_world, {id, feature}));
    map.refresh_landmark(created.back());
  }
  return created;
}

std::vector<LandmarkId> create_beyond_range(Map& map, KeyframeId id) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  const Frame& frame = *keyframe.frame;
  const auto known = std::ranges::count_if(keyframe.landmarks, [](LandmarkId l) { return l != kNoLandmark; });
  if (known >= kEnoughKnown || measures_depth(frame, kMostOfTheView)) return {};
  const Tiles beyond = tiles_beyond_range(frame);
  if (beyond.count() < kFewestTilesBeyond) return {};
  std::vector<LandmarkId> created;
  const double assumed_m = kBeyondRange * depth_range_m(frame);
  for (std::uint32_t i = 0; i < frame.features.size(); ++i) {
    const msg::Feature& f = frame.features[i];
    if (f.depth_m > 0 || keyframe.landmarks[i] != kNoLandmark || !beyond.test(tile_of(frame, f.u_px, f.v_px))) continue;
    const Eigen::Vector3d p_camera = assumed_m * frame.normalized(i).homogeneous();
    created.push_back(map.add_landmark(keyframe.T_world_camera * p_camera, {id, i}));
    map.refresh_landmark(created.back());
  }
  return created;
}

std::vector<LandmarkId> create_by_triangulation(Map& map, KeyframeId keyframe, int neighbours, double close_depth_m) {
  std::vector<LandmarkId> created;
  for (const KeyframeId neighbour : map.best_covisible(keyframe, static_cast<std::size_t>(neighbours))) {
    create_with_neighbour(map, keyframe, neighbour, close_depth_m, created);
  }
  return created;
}

std::optional<Eigen::Vector3d> triangulate(const Eigen::Isometry3d& T_camera_world_1, const Eigen::Vector2d& n1,
                                           const Eigen::Isometry3d& T_camera_world_2, const Eigen::Vector2d& n2) {
  const Eigen::Matrix<double, 3, 4> P1 = T_camera_world_1.matrix().topRows<3>(),
                                    P2 = T_camera_world_2.matrix().topRows<3>();
  Eigen::Matrix4d A;
  A.row(0) = n1.x() * P1.row(2) - P1.row(0);
  A.row(1) = n1.y() * P1.row(2) - P1.row(1);
  A.row(2) = n2.x() * P2.row(2) - P2.row(0);
  A.row(3) = n2.y() * P2.row(2) - P2.row(1);
  const Eigen::Vector4d p = Eigen::JacobiSVD<Eigen::Matrix4d>(A, Eigen::ComputeFullV).matrixV().col(3);
  if (std::abs(p.w()) < 1e-9 * p.head<3>().norm()) return std::nullopt;
  return p.head<3>() / p.w();
}

}  // namespace rtd::slam
