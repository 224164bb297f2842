// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/sample_keeper.hpp"

#include <algorithm>
#include <utility>

namespace rtd::launcher {
namespace {

constexpr std::uint64_t kStrideOfUnknownLength = 4;

}  // namespace

SampleKeeper::SampleKeeper(std::uint64_t wanted, std::uint64_t total)
    : wanted_(std::max<std::uint64_t>(wanted, 1)), stride_(kStrideOfUnknownLength) {
  expect_total(total);
}

void SampleKeeper::expect_total(std::uint64_t total) {
  if (total > 0 && kept_.empty()) stride_ = (total + wanted_ - 1) / wanted_;
}

void SampleKeeper::add_image(std::uint64_t seq, std::vector<std::uint8_t> jpeg) {
  if (!wants(seq)) return;
  eval::SampleFrame& sample = kept_[seq];
  sample.seq = seq;
  sample.jpeg = std::move(jpeg);
  thin_out();
}

void SampleKeeper::add_features(const msg::FeatureFrame& features) {
  if (!wants(features.seq)) return;
  eval::SampleFrame& sample = kept_[features.seq];
  sample.seq = features.seq;
  sample.features = eval::judged({features.features.data(), std::min<std::size_t>(features.count, msg::kMaxFeatures)});
  thin_out();
}

void SampleKeeper::thin_out() {
  while (kept_.size() >= 2 * wanted_) {
    stride_ *= 2;
    for (auto sample = kept_.begin(); sample != kept_.end();) {
      sample = wants(sample->first) ? std::next(sample) : kept_.erase(sample);
    }
  }
}

std::vector<eval::SampleFrame> SampleKeeper::samples() const {
  std::vector<eval::SampleFrame> complete;
  for (const auto& [seq, sample] : kept_) {
    if (!sample.jpeg.empty() && !sample.features.empty()) complete.push_back(sample);
  }
  if (complete.size() <= wanted_) return complete;
  std::vector<eval::SampleFrame> result;
  for (std::uint64_t i = 0; i < wanted_; ++i) result.push_back(std::move(complete[i * complete.size() / wanted_]));
  return result;
}

}  // namespace rtd::launcher
