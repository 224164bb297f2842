// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "services/slam/core/map/landmark.hpp"
#include "services/slam/core/map/paged_index.hpp"

namespace rtd::slam {

/// The landmarks of a map by id, in blocks whose places are used again: memory follows the landmarks that live. A
/// landmark stays where it is while it lives.
class LandmarkStore {
 public:
  /// Takes a landmark in; `id` must not be in use.
  Landmark& emplace(LandmarkId id, Landmark landmark);
  void erase(LandmarkId id);

  /// Null when unknown.
  const Landmark* find(LandmarkId id) const {
    const Slot slot = slots_.find(id);
    return slot == kNoSlot ? nullptr : &blocks_[slot / kBlockLandmarks][slot % kBlockLandmarks];
  }
  Landmark* find(LandmarkId id) {
    const Slot slot = slots_.find(id);
    return slot == kNoSlot ? nullptr : &blocks_[slot / kBlockLandmarks][slot % kBlockLandmarks];
  }
  /// Throws std::out_of_range when unknown.
  Landmark& at(LandmarkId id);
  std::size_t size() const { return size_; }
  std::vector<LandmarkId> ids() const;  ///< ascending

 private:
  using Slot = std::uint32_t;
  static constexpr Slot kNoSlot = std::numeric_limits<Slot>::max();
  static constexpr std::size_t kBlockLandmarks = 256;

  PagedIndex<Slot, kNoSlot> slots_;
  std::vector<std::unique_ptr<Landmark[]>> blocks_;
  std::vector<Slot> free_;
  std::size_t size_ = 0;
};

}  // namespace rtd::slam
