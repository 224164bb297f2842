// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/static_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <ostream>
#include <unordered_map>

#include "common/geometry/ply.hpp"
#include "common/msg/stamps.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::dense {
namespace {

constexpr std::uint64_t kMovingEvery = 7;  // one moving point in so many is kept

using Cell = Eigen::Array3i;
struct CellHash {
  std::size_t operator()(const Cell& c) const {
    return static_cast<std::size_t>(c.x()) * 73856093U ^ static_cast<std::size_t>(c.y()) * 19349663U ^
           static_cast<std::size_t>(c.z()) * 83492791U;
  }
};
struct CellEqual {
  bool operator()(const Cell& a, const Cell& b) const { return (a == b).all(); }
};

void add(CloudPoint& mean, const CloudPoint& point) {
  mean.weight += point.weight;
  const float share = mean.weight > 0 ? point.weight / mean.weight : 1.0F;
  mean.p_world += share * (point.p_world - mean.p_world);
  for (std::size_t i = 0; i < 3; ++i) mean.bgr[i] += share * (point.bgr[i] - mean.bgr[i]);
}

VoxelMap::Limits limits(const DenseConfig& config) {
  return {config.fusion.voxel_m, static_cast<std::size_t>(config.fusion.max_voxels),
          static_cast<float>(config.fusion.max_weight), static_cast<std::int16_t>(config.carving.max_evidence)};
}

bool usable(const Eigen::Isometry3d& T) {
  return T.matrix().allFinite() && std::abs(T.linear().determinant() - 1) < 1e-3;
}

bool usable(const vision::RgbdImage& image, const DynamicMask& mask) {
  const auto& p = image.camera.parameters();
  return image.depth.type() == CV_16UC1 && image.color_bgr.type() == CV_8UC3 && image.depth.cols == p.width &&
         image.depth.rows == p.height && image.color_bgr.size() == image.depth.size() && image.depth_scale_m > 0 &&
         p.fx > 0 && p.fy > 0 && mask.columns > 0 && mask.rows > 0 &&
         mask.cells.size() == static_cast<std::size_t>(mask.columns) * static_cast<std::size_t>(mask.rows);
}

}  // namespace

std::vector<CloudPoint> merge_by_cell(const std::vector<CloudPoint>& points, double cell_m) {
  std::unordered_map<Cell, std::size_t, CellHash, CellEqual> place;
  std::vector<CloudPoint> merged;
  for (const CloudPoint& point : points) {
    const Cell cell = (point.p_world / static_cast<float>(cell_m)).array().floor().cast<int>();
    const auto [slot, fresh] = place.emplace(cell, merged.size());
    if (fresh) merged.emplace_back();
    add(merged[slot->second], point);
  }
  return merged;
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
}

void write_ply(std::ostream& out, const std::vector<CloudPoint>& points) {
  geometry::write_ply_header(out, geometry::PlyFormat::kBinaryLittleEndian, "RTD-SLAM static map, world frame, metres",
                             points.size(),
                             {{"float", "x"},
                              {"float", "y"},
                              {"float", "z"},
                              {"uchar", "red"},
                              {"uchar", "green"},
                              {"uchar", "blue"},
                              {"float", "weight"}});
  for (const CloudPoint& point : points) {
    std::array<char, 19> vertex{};
    const std::array<char, 3> rgb{static_cast<char>(to_byte(point.bgr[2])), static_cast<char>(to_byte(point.bgr[1])),
                                  static_cast<char>(to_byte(point.bgr[0]))};
    std::memcpy(vertex.data(), point.p_world.data(), 12);
    std::memcpy(vertex.data() + 12, rgb.data(), 3);
    std::memcpy(vertex.data() + 15, &point.weight, 4);
    out.write(vertex.data(), vertex.size());
  }
}

std::optional<KeyframePoses::Removed> KeyframePoses::update(const msg::KeyframeEvent& event) {
  const AnchorId id = event.keyframe_id;
  if (event.kind == msg::KeyframeEventKind::kRemoved) {
    const auto found = keyframes_.find(id);
    if (found == keyframes_.end()) return std::nullopt;
    const std::int64_t stamp_ns = found->second.stamp_ns;
    keyframes_.erase(found);
    by_time_.erase({stamp_ns, id});
    const AnchorId follows = nearest_in_time(stamp_ns);
    if (newest_ == id) newest_ = follows;
    return Removed{id, follows};
  }
  const Eigen::Isometry3d T_world_keyframe = msg::to_isometry(event.T_world_camera);
  if (!T_world_keyframe.matrix().allFinite()) return std::nullopt;
  if (keyframes_.size() >= kMax && !keyframes_.contains(id)) return std::nullopt;
  const auto [keyframe, created] =
      keyframes_.try_emplace(id, Poses{event.stamp_ns, T_world_keyframe, T_world_keyframe});
  keyframe->second.T_world_keyframe = T_world_keyframe;
  if (created) by_time_.emplace(event.stamp_ns, id);
  if (created && (newest_ == kNoAnchor || event.stamp_ns >= keyframes_.at(newest_).stamp_ns)) newest_ = id;
  return std::nullopt;
}

const Eigen::Isometry3d* KeyframePoses::pose(AnchorId keyframe) const {
  const auto found = keyframes_.find(keyframe);
  return found == keyframes_.end() ? nullptr : &found->second.T_world_keyframe;
}

std::map<AnchorId, Eigen::Isometry3f> KeyframePoses::take_motions() {
  std::map<AnchorId, Eigen::Isometry3f> motions;
  for (auto& [id, keyframe] : keyframes_) {
    if (keyframe.T_world_keyframe.matrix() == keyframe.T_world_applied.matrix()) continue;
    motions.emplace(id, (keyframe.T_world_keyframe * keyframe.T_world_applied.inverse()).cast<float>());
    keyframe.T_world_applied = keyframe.T_world_keyframe;
  }
  return motions;
}

/// Of several as near, the one with the lowest number.
AnchorId KeyframePoses::nearest_in_time(std::int64_t stamp_ns) const {
  if (by_time_.empty()) return kNoAnchor;
  const auto later = by_time_.lower_bound({stamp_ns, 0});
  if (later == by_time_.begin()) return later->second;
  const auto earlier = by_time_.lower_bound({std::prev(later)->first, 0});
  if (later == by_time_.end()) return earlier->second;
  const std::int64_t ahead_ns = msg::minus_ns(later->first, stamp_ns),
                     behind_ns = msg::minus_ns(stamp_ns, earlier->first);
  if (ahead_ns == behind_ns) return std::min(later->second, earlier->second);
  return ahead_ns < behind_ns ? later->second : earlier->second;
}

StaticMap::StaticMap(const DenseConfig& config) : config_(config), map_(limits(config)) {}

void StaticMap::update(const msg::KeyframeEvent& event) {
  const auto removed = keyframes_.update(event);
  if (!removed) return;
  follow_corrections();
  map_.reanchor(removed->keyframe, removed->follows);
}

FusionReport StaticMap::integrate(const vision::RgbdImage& image, const DynamicMask& mask,
                                  const Eigen::Isometry3d& T_world_camera) {
  FusionReport report;
  if (!usable(T_world_camera)) report.outcome = FusionReport::Outcome::kBadPose;
  if (!usable(image, mask)) report.outcome = FusionReport::Outcome::kBadImage;
  if (report.outcome != FusionReport::Outcome::kFused) return report;
  follow_corrections();
  table_.fit(image.camera);
  const DynamicMask wide = grow(mask, config_.fusion.mask_grow_cells);
  const DepthView view(image, wide, table_, config_.fusion);
  ++frame_;
  report.carved = carve(view, T_world_camera.inverse().cast<float>());
  fuse(view, T_world_camera.cast<float>(), report);
  return report;
}

void StaticMap::follow_corrections() {
  const std::map<AnchorId, Eigen::Isometry3f> motions = keyframes_.take_motions();
  if (motions.empty()) return;
  map_.move([&motions](AnchorId anchor) {
    const auto found = motions.find(anchor);
    return found == motions.end() ? nullptr : &found->second;
  });
  for (MovingPoint& moving : moving_) {
    const auto found = motions.find(moving.anchor);
    if (found != motions.end()) moving.point.p_world = found->second * moving.point.p_world;
  }
}

std::vector<CloudPoint> StaticMap::moving() {
  follow_corrections();
  std::vector<CloudPoint> points;
  for (const MovingPoint& moving : moving_) points.push_back(moving.point);
  return points;
}

/// Eq. (4): a voxel nearer than what is measured behind it has gone. That also holds at pixels of moving objects.
std::uint64_t StaticMap::carve(const DepthView& view, const Eigen::Isometry3f& T_camera_world) {
  const auto& limits = config_.carving;
  const auto min_m = static_cast<float>(config_.fusion.min_depth_m);
  return map_.remove_if([&](Voxel& voxel) {
    const Eigen::Vector3f p_camera = T_camera_world * voxel.p_world;
    if (p_camera.z() < min_m) return false;
    const int pixel = view.table().raw_pixel(view.table().project(p_camera));
    const float behind_m = pixel < 0 ? 0.0F : view.nearest_around_m(pixel);
    const float margin_m =
        std::max(static_cast<float>(limits.margin_m), static_cast<float>(limits.sigmas) * sigma_m(behind_m));
    if (behind_m - p_camera.z() <= margin_m) return false;
    --voxel.evidence;
    return voxel.evidence <= -limits.frames;
  });
}

/// Eq. (1)-(3).
void StaticMap::fuse(const DepthView& view, const Eigen::Isometry3f& T_world_camera, FusionReport& report) {
  const int stride = config_.fusion.stride_px, width = view.table().width();
  const std::uint8_t allowed = config_.fusion.unknown_is_static ? DynamicMask::kUnknown : DynamicMask::kStatic;
  const float sigma_1m = sigma_m(1.0F);
  const AnchorId anchor = keyframes_.newest();
  for (int row = 1; row < view.table().height(); row += stride) {
    const auto* color = view.image().color_bgr.ptr<std::array<std::uint8_t, 3>>(row);
    for (int column = 1; column < width; column += stride) {
      const int pixel = row * width + column;
      const float depth_m = view.depth_m(pixel);
      if (depth_m <= 0 || !view.on_surface(column, row)) continue;
      if (const std::uint8_t motion = view.motion(pixel); motion > allowed) {
        ++report.masked;
        const bool kept = motion == DynamicMask::kDynamic && report.masked % kMovingEvery == 0;
        if (kept) keep_moving(T_world_camera * (depth_m * view.table().ray(pixel)), color[column], anchor);
        continue;
      }
      const Eigen::Vector3f ray = view.table().ray(pixel);
      const float length = ray.norm(), ratio = sigma_1m / sigma_m(depth_m);
      const Sample sample{T_world_camera * (depth_m * ray), T_world_camera.linear() * (ray / length),
                          static_cast<float>(config_.fusion.gate_sigmas) * sigma_m(depth_m) * length, ratio * ratio,
                          color[column]};
      ++(map_.add(sample, frame_, anchor) ? report.fused : report.refused);
    }
  }
}

void StaticMap::keep_moving(const Eigen::Vector3f& p_world, const std::array<std::uint8_t, 3>& bgr, AnchorId anchor) {
  if (moving_.size() >= kMovingKept) moving_.pop_front();
  moving_.push_back(
      {{p_world, {static_cast<float>(bgr[0]), static_cast<float>(bgr[1]), static_cast<float>(bgr[2])}}, anchor});
}

bool StaticMap::believed(const Voxel& voxel) const {
  return voxel.sightings >= config_.carving.min_sightings && voxel.evidence > 0;
}

std::vector<CloudPoint> StaticMap::cloud(std::size_t max_points) {
  std::vector<CloudPoint> points;
  for_each_believed([&](const Voxel& voxel) { points.push_back({voxel.p_world, voxel.bgr, voxel.weight}); });
  double cell_m = map_.voxel_m();
  points = merge_by_cell(points, cell_m);
  while (points.size() > max_points) points = merge_by_cell(points, cell_m *= 1.5);
  return points;
}

void StaticMap::clear() {
  map_.clear();
  moving_.clear();
  keyframes_.clear();
}

}  // namespace rtd::dense
