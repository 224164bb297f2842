// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/landmark.hpp"

#include <stdexcept>
#include <string>

namespace rtd::slam {

Landmark& LandmarkStore::emplace(LandmarkId id, Landmark landmark) {
  if (free_.empty()) {
    const auto first = static_cast<Slot>(blocks_.size() * kBlockLandmarks);
    blocks_.push_back(std::make_unique<Landmark[]>(kBlockLandmarks));
    for (std::size_t i = kBlockLandmarks; i-- > 0;) free_.push_back(first + static_cast<Slot>(i));
  }
  const Slot slot = free_.back();
  free_.pop_back();
  slots_.add(id, slot);
  ++size_;
  return blocks_[slot / kBlockLandmarks][slot % kBlockLandmarks] = std::move(landmark);
}

void LandmarkStore::erase(LandmarkId id) {
  at(id) = Landmark{};  // frees its observations
  free_.push_back(slots_.find(id));
  slots_.erase(id);
  --size_;
}

Landmark& LandmarkStore::at(LandmarkId id) {
  if (Landmark* landmark = find(id)) return *landmark;
  throw std::out_of_range("landmark " + std::to_string(id) + " is not in the map");
}

std::vector<LandmarkId> LandmarkStore::ids() const {
  std::vector<LandmarkId> ids;
  ids.reserve(size_);
  slots_.for_each_id([&](LandmarkId id) { ids.push_back(id); });
  return ids;
}

}  // namespace rtd::slam
