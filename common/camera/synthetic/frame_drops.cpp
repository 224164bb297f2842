// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/frame_drops.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr std::uint64_t kBlock = 100;

}  // namespace

FrameDrops::FrameDrops(double share, std::uint64_t seed)
    : lost_(static_cast<std::uint64_t>(std::lround(share * static_cast<double>(kBlock)))), seed_(seed ^ 0xD209ULL) {}

/// Those of a block that arrive, ascending: the first of a shuffled row.
std::vector<std::uint64_t> FrameDrops::arriving_in(std::uint64_t block) const {
  std::vector<std::uint64_t> row(kBlock);
  std::iota(row.begin(), row.end(), 0);
  SeededRandom random(seed_ ^ (block * 0x9E3779B97F4A7C15ULL));
  for (std::uint64_t last = kBlock - 1; last > 0; --last) std::swap(row[last], row[random.next() % (last + 1)]);
  row.resize(kBlock - lost_);
  std::sort(row.begin(), row.end());
  return row;
}

std::uint64_t FrameDrops::exposure_of(std::uint64_t frame) const {
  if (lost_ == 0) return frame;
  const std::uint64_t arriving = kBlock - lost_, block = frame / arriving;
  return block * kBlock + arriving_in(block)[frame % arriving];
}

std::uint64_t FrameDrops::arrived_before(std::uint64_t exposure) const {
  if (lost_ == 0) return exposure;
  const std::uint64_t block = exposure / kBlock;
  const std::vector<std::uint64_t> arriving = arriving_in(block);
  const auto next = std::lower_bound(arriving.begin(), arriving.end(), exposure % kBlock);
  return block * (kBlock - lost_) + static_cast<std::uint64_t>(next - arriving.begin());
}

}  // namespace rtd::camera::synthetic
