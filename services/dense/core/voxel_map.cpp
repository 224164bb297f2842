// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/voxel_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rtd::dense {
namespace {

constexpr int kBits = CellIndex::kBits;
constexpr int kMaxSteps = 3;
constexpr std::uint64_t kInBlock = std::uint64_t{7} << (2 * kBits) | std::uint64_t{7} << kBits | 7U;

std::size_t place_in_block(std::uint64_t key) {
  return (key >> (2 * kBits) & 7U) << 6U | (key >> kBits & 7U) << 3U | (key & 7U);
}

}  // namespace

CellIndex::Block* CellIndex::block_of(std::uint64_t key) const {
  const std::uint64_t block_key = key & ~kInBlock;
  if (block_key == newest_key_) return newest_;
  const auto found = blocks_.find(block_key);
  newest_key_ = block_key;
  newest_ = found == blocks_.end() ? nullptr : found->second.get();
  return newest_;
}

CellIndex::Index CellIndex::find(std::uint64_t key) const {
  const Block* block = block_of(key);
  return block == nullptr ? kNone : block->cells[place_in_block(key)];
}

void CellIndex::set(std::uint64_t key, Index number) {
  Block* block = block_of(key);
  if (block == nullptr) {
    block = newest_ = (blocks_[newest_key_] = std::make_unique<Block>()).get();
    block->cells.fill(kNone);
  }
  Index& cell = block->cells[place_in_block(key)];
  if (cell == kNone) ++block->filled;
  cell = number;
}

void CellIndex::erase(std::uint64_t key) {
  Block* block = block_of(key);
  if (block == nullptr || block->cells[place_in_block(key)] == kNone) return;
  block->cells[place_in_block(key)] = kNone;
  if (--block->filled > 0) return;
  blocks_.erase(newest_key_);
  newest_ = nullptr;
}

void CellIndex::clear() {
  blocks_.clear();
  newest_ = nullptr;
}

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

const Voxel* VoxelMap::find(std::uint64_t key) const {
  const Index found = index_.find(key);
  return found == CellIndex::kNone ? nullptr : &voxels_[found];
}

const Voxel* VoxelMap::at(const Eigen::Vector3f& p_world) const {
  return find(key_of(p_world));
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
    index_.set(key, static_cast<Index>(voxels_.size()));
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
      index_.set(voxels_[i].key, static_cast<Index>(i));
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
    Voxel* there = outside ? nullptr : find(voxels_[i].key);
    if (!outside && there == nullptr) {
      index_.set(voxels_[i].key, i);
      continue;
    }
    if (there != nullptr) merge(*there, voxels_[i]);
    absorbed[i] = 1;
  }
  if (std::find(absorbed.begin(), absorbed.end(), 1) == absorbed.end()) return;
  std::vector<Voxel> kept;
  kept.reserve(voxels_.size());
  for (Index i = 0; i < voxels_.size(); ++i) {
    if (absorbed[i] != 0) continue;
    index_.set(voxels_[i].key, static_cast<Index>(kept.size()));
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
