// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace rtd::occupancy {

/// Cells of space in blocks of 16 x 16 x 16, each with a value that is T{} until it is set. Cell i covers
/// [i, i + 1) * cell along each axis. Bounded by the number of blocks. One thread.
template <class T>
class CellBlocks {
 public:
  static constexpr int kBits = 4, kSide = 1 << kBits, kCells = kSide * kSide * kSide;
  static constexpr int kFarthest = (1 << 20) - 1;  ///< of a block along an axis
  using Block = std::array<T, kCells>;

  static int index(int x, int y, int z) {
    constexpr int kMask = kSide - 1;
    return (((z & kMask) << kBits | (y & kMask)) << kBits) | (x & kMask);
  }
  const Block* find(const Eigen::Vector3i& block) const {
    const auto found = blocks_.find(key(block));
    return found == blocks_.end() ? nullptr : &found->second;
  }
  Block* find(const Eigen::Vector3i& block) { return const_cast<Block*>(std::as_const(*this).find(block)); }
  /// Makes it if need be; nullptr when there are `most` blocks already or it is out of bounds.
  Block* at(const Eigen::Vector3i& block, std::size_t most = SIZE_MAX) {
    if (Block* known = find(block)) return known;
    if (blocks_.size() >= most || (block.array().abs() > kFarthest).any()) return nullptr;
    return &blocks_.try_emplace(key(block)).first->second;
  }
  T value(const Eigen::Vector3i& cell) const {
    const Block* block = find(block_of(cell));
    return block == nullptr ? T{} : (*block)[static_cast<std::size_t>(index(cell.x(), cell.y(), cell.z()))];
  }
  /// To be changed; nullptr when there is no room for it.
  T* cell(const Eigen::Vector3i& at_cell, std::size_t most = SIZE_MAX) {
    Block* block = at(block_of(at_cell), most);
    return block == nullptr ? nullptr
                            : &(*block)[static_cast<std::size_t>(index(at_cell.x(), at_cell.y(), at_cell.z()))];
  }
  /// False when there is no room for it.
  bool set(const Eigen::Vector3i& at_cell, T value, std::size_t most = SIZE_MAX) {
    T* const place = cell(at_cell, most);
    if (place != nullptr) *place = value;
    return place != nullptr;
  }
  /// Calls visit(cell, value) for each cell whose value is not T{}, in no particular order.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const auto& [key, block] : blocks_) {
      const Eigen::Vector3i first = kSide * block_at(key);
      for (int i = 0; i < kCells; ++i) {
        const T& value = block[static_cast<std::size_t>(i)];
        if (value == T{}) continue;
        visit(Eigen::Vector3i(first + Eigen::Vector3i(i % kSide, i / kSide % kSide, i / kSide / kSide)), value);
      }
    }
  }
  std::size_t blocks() const { return blocks_.size(); }
  void clear() { blocks_.clear(); }

  static Eigen::Vector3i block_of(const Eigen::Vector3i& cell) {
    return {cell.x() >> kBits, cell.y() >> kBits, cell.z() >> kBits};
  }

 private:
  static std::uint64_t key(const Eigen::Vector3i& block) {
    const auto part = [](int at) { return static_cast<std::uint64_t>(at + (1 << 20)) & 0x1FFFFF; };
    return part(block.x()) | part(block.y()) << 21 | part(block.z()) << 42;
  }
  static Eigen::Vector3i block_at(std::uint64_t key) {
    const auto part = [key](int shift) { return static_cast<int>(key >> shift & 0x1FFFFF) - (1 << 20); };
    return {part(0), part(21), part(42)};
  }
  struct Mix {
    std::size_t operator()(std::uint64_t key) const { return std::rotl(key * 0x9e3779b97f4a7c15ULL, 24); }
  };
  std::unordered_map<std::uint64_t, Block, Mix> blocks_;
};

/// What is known of a cell.
enum class Space : std::uint8_t { kUnknown, kFree, kOccupied };

/// A voxel map. Frame `grid`: z up, origin and, where the map has z up too, axes of the map.
struct Volume {
  double cell_m = 0.05;
  CellBlocks<Space> cells;
};

}  // namespace rtd::occupancy
