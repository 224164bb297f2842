// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

namespace rtd::dense {

using AnchorId = std::uint32_t;
inline constexpr AnchorId kNoAnchor = ~AnchorId{0};

/// One point of the fused surface: the weighted mean of what fell into a voxel.
struct Voxel {
  Eigen::Vector3f p_world = Eigen::Vector3f::Zero();  ///< m
  float weight = 0;                                   ///< in points seen at 1 m
  std::array<float, 3> bgr{};
  AnchorId anchor = kNoAnchor;   ///< the keyframe that it moves with
  std::uint32_t last_frame = 0;  ///< in which it was seen
  std::uint16_t sightings = 0;   ///< frames that saw it
  std::int16_t evidence = 0;     ///< sightings less the frames that looked through it, bounded above
  std::uint64_t key = 0;         ///< of the cell that it stands for
};

/// One measured point.
struct Sample {
  Eigen::Vector3f p_world;
  Eigen::Vector3f direction;  ///< from the camera, unit length
  float gate_m = 0;           ///< a surface so near along the ray is the same surface
  float weight = 0;
  std::array<std::uint8_t, 3> bgr{};
};

/// Numbers by the cell that they stand for. Cells lie together in blocks of 8 x 8 x 8, so that those of neighbouring
/// pixels and those along a ray are found in memory that was just read: with a hash of single cells half of the time of
/// a fusion is waiting for memory. One thread.
class CellIndex {
 public:
  using Index = std::uint32_t;
  static constexpr Index kNone = ~Index{0};
  static constexpr int kBits = 21;  ///< of a key per axis: 41 km at 2 cm

  /// kNone for a cell without a number.
  Index find(std::uint64_t key) const;
  void set(std::uint64_t key, Index number);
  void erase(std::uint64_t key);
  void clear();

 private:
  struct Block {
    std::array<Index, 512> cells;
    int filled = 0;
  };
  struct Mix {
    std::size_t operator()(std::uint64_t key) const { return (key ^ (key >> 29)) * 0x9e3779b97f4a7c15ULL >> 16; }
  };
  Block* block_of(std::uint64_t key) const;

  std::unordered_map<std::uint64_t, std::unique_ptr<Block>, Mix> blocks_;
  mutable std::uint64_t newest_key_ = ~std::uint64_t{0};  ///< the block that was asked for last, there or not
  mutable Block* newest_ = nullptr;
};

/// A hash of voxels with running means; bounded. docs/theory/dense_map.md Eq. (1)-(3). Deterministic in the order of
/// calls. One thread.
class VoxelMap {
 public:
  struct Limits {
    double voxel_m = 0.02;
    std::size_t max_voxels = 1'500'000;
    float max_weight = 100;
    std::int16_t max_evidence = 5;
  };
  explicit VoxelMap(const Limits& limits) : limits_(limits) {}

  /// Joins the heaviest voxel along the ray within the gate, else the one of its own cell, else makes a new one. False
  /// when that is refused: the map is full or the point lies out of bounds.
  bool add(const Sample& sample, std::uint32_t frame, AnchorId anchor);
  /// Removes the voxels for which `gone` is true; it may change them.
  std::size_t remove_if(const std::function<bool(Voxel&)>& gone);
  /// Moves every voxel by `motion_of` its anchor (nullptr: it stays); voxels that meet become one.
  void move(const std::function<const Eigen::Isometry3f*(AnchorId)>& motion_of);
  /// Gives the voxels of one anchor to another.
  void reanchor(AnchorId from, AnchorId to);
  void clear();

  const std::vector<Voxel>& voxels() const { return voxels_; }
  /// The voxel of the cell around a point, nullptr when there is none.
  const Voxel* at(const Eigen::Vector3f& p_world) const;
  bool full() const { return voxels_.size() >= limits_.max_voxels; }
  double voxel_m() const { return limits_.voxel_m; }

 private:
  using Index = CellIndex::Index;
  static constexpr std::uint64_t kOutside = ~std::uint64_t{0};
  std::uint64_t key_of(const Eigen::Vector3f& p_world) const;
  Voxel* find(std::uint64_t key) { return const_cast<Voxel*>(std::as_const(*this).find(key)); }
  const Voxel* find(std::uint64_t key) const;
  Voxel* surface_along_ray(const Sample& sample, std::uint64_t own_key);
  void merge(Voxel& into, const Voxel& other) const;

  Limits limits_;
  std::vector<Voxel> voxels_;
  CellIndex index_;
};

}  // namespace rtd::dense
