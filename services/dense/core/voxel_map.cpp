// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/voxel_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rtd::dense {
namespace {

constexpr int kBits = 21;  // per axis: 41 km at 2 cm
constexpr int kMaxSteps = 3;

}  // namespace

/// kOutside for points that are not finite or farther from the origin than the key can express.
std::uint64_t VoxelMap::key_of(const Eigen::Vector3f& p_world) const {
  constexpr double kHalf = 1 << (kBits - 1);
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(static_cast<double>(p_world[axis]) / limits_.voxel_m) + kHalf;
    if (!(cell >= 0 && cell < 2 * kHalf)) return kOutside;
    key = key << kBits | static_cast<std::uint64_t>(cell);
  }
  return key;
}

Voxel* VoxelMap::find(std::uint64_t key) {
  const auto found = index_.find(key);
  return found == index_.end() ? nullptr : &voxels_[found->second];
}

const Voxel* VoxelMap::at(const Eigen::Vector3f& p_world) const {
  const auto found = index_.find(key_of(p_world));
  return found == index_.end() ? nullptr : &voxels_[found->second];
}

/// Noise is along the ray: without this, a surface would become as thick as the noise and no mean would reduce it.
Voxel* VoxelMap::surface_along_ray(const Sample& sample, std::uint64_t own_key) {
  Voxel* best = find(own_key);
  const auto voxel_m = static_cast<float>(limits_.voxel_m);
  const int steps = std::min(kMaxSteps, static_cast<int>(std::ceil(sample.gate_m / voxel_m)));
  for (int step = -steps; step <= steps; ++step) {
    if (step == 0) continue;
    Voxel* other = find(key_of(sample.p_world + static_cast<float>(step) * voxel_m * sample.direction));
    if (other == nullptr || (best != nullptr && other->weight <= best->weight)) continue;
    if (std::abs((other->p_world - sample.p_world).dot(sample.direction)) <= sample.gate_m) best = other;
  }
  return best;
}

bool VoxelMap::add(const Sample& sample, std::uint32_t frame, AnchorId anchor) {
  const std::uint64_t key = key_of(sample.p_world);
  if (key == kOutside) return false;
  Voxel* voxel = surface_along_ray(sample, key);
  if (voxel == nullptr) {
    if (full()) return false;
    index_.emplace(key, static_cast<Index>(voxels_.size()));
    voxel = &voxels_.emplace_back();
    voxel->key = key;
    voxel->anchor = anchor;
  }
  const float share = sample.weight / (voxel->weight + sample.weight);
  voxel->p_world += share * (sample.p_world - voxel->p_world);
  for (std::size_t i = 0; i < 3; ++i) voxel->bgr[i] += share * (static_cast<float>(sample.bgr[i]) - voxel->bgr[i]);
  voxel->weight = std::min(limits_.max_weight, voxel->weight + sample.weight);
  if (voxel->sightings == 0 || voxel->last_frame != frame) {
    voxel->last_frame = frame;
    if (voxel->sightings < UINT16_MAX) ++voxel->sightings;
    voxel->evidence = std::min<std::int16_t>(limits_.max_evidence, static_cast<std::int16_t>(voxel->evidence + 1));
  }
  return true;
}

std::size_t VoxelMap::remove_if(const std::function<bool(Voxel&)>& gone) {
  const std::size_t before = voxels_.size();
  for (std::size_t i = 0; i < voxels_.size();) {
    if (!gone(voxels_[i])) {
      ++i;
      continue;
    }
    index_.erase(voxels_[i].key);
    if (i + 1 < voxels_.size()) {
      voxels_[i] = voxels_.back();
      index_[voxels_[i].key] = static_cast<Index>(i);
    }
    voxels_.pop_back();
  }
  return before - voxels_.size();
}

void VoxelMap::merge(Voxel& into, const Voxel& other) const {
  const float share = other.weight / (into.weight + other.weight);
  into.p_world += share * (other.p_world - into.p_world);
  for (std::size_t i = 0; i < 3; ++i) into.bgr[i] += share * (other.bgr[i] - into.bgr[i]);
  into.weight = std::min(limits_.max_weight, into.weight + other.weight);
  into.sightings = std::max(into.sightings, other.sightings);
  into.evidence = std::max(into.evidence, other.evidence);
  into.last_frame = std::max(into.last_frame, other.last_frame);
}

/// First all leave their cells, then all arrive: none meets one that is about to leave.
void VoxelMap::move(const std::function<const Eigen::Isometry3f*(AnchorId)>& motion_of) {
  std::vector<Index> arriving;
  for (Index i = 0; i < voxels_.size(); ++i) {
    Voxel& voxel = voxels_[i];
    const Eigen::Isometry3f* motion = motion_of(voxel.anchor);
    if (motion == nullptr) continue;
    voxel.p_world = *motion * voxel.p_world;
    const std::uint64_t key = key_of(voxel.p_world);
    if (key == voxel.key) continue;
    index_.erase(voxel.key);
    voxel.key = key;
    arriving.push_back(i);
  }
  std::vector<char> absorbed(voxels_.size(), 0);
  for (const Index i : arriving) {
    const bool outside = voxels_[i].key == kOutside;
    const auto [place, free] = outside ? std::pair(index_.end(), false) : index_.emplace(voxels_[i].key, i);
    if (free) continue;
    if (!outside) merge(voxels_[place->second], voxels_[i]);
    absorbed[i] = 1;
  }
  if (std::find(absorbed.begin(), absorbed.end(), 1) == absorbed.end()) return;
  std::vector<Voxel> kept;
  kept.reserve(voxels_.size());
  for (Index i = 0; i < voxels_.size(); ++i) {
    if (absorbed[i] != 0) continue;
    index_[voxels_[i].key] = static_cast<Index>(kept.size());
    kept.push_back(voxels_[i]);
  }
  voxels_ = std::move(kept);
}

void VoxelMap::reanchor(AnchorId from, AnchorId to) {
  for (Voxel& voxel : voxels_) {
    if (voxel.anchor == from) voxel.anchor = to;
  }
}

void VoxelMap::clear() {
  voxels_.clear();
  index_.clear();
}

}  // namespace rtd::dense
