// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"

/// What the services of a run send.
namespace rtd::launcher {

inline constexpr std::int64_t kMs = 1'000'000;

inline msg::TrackingResult result_of(std::uint64_t seq, msg::TrackingState state = msg::TrackingState::kOk) {
  msg::TrackingResult result{};
  result.seq = seq;
  result.stamp_ns = static_cast<std::int64_t>(seq) * 33 * kMs;
  result.published_ns = result.stamp_ns;
  result.finished_ns = result.published_ns + 20 * kMs;
  result.state = state;
  result.inliers = static_cast<std::uint32_t>(100 + seq);
  return result;
}

inline std::unique_ptr<msg::FeatureFrame> features_of(std::uint64_t seq, std::uint32_t count = 3) {
  auto features = std::make_unique<msg::FeatureFrame>();
  features->seq = seq;
  features->count = count;
  features->objects = static_cast<std::uint32_t>(seq) + 1;
  features->stage_ms[msg::kStageExtract] = 7.0F;
  return features;
}

inline msg::ServiceStatus status_of(const std::string& service, std::int64_t pid, std::vector<msg::Metric> metrics) {
  msg::ServiceStatus status;
  status.service = service;
  status.pid = pid;
  status.metrics = std::move(metrics);
  return status;
}

}  // namespace rtd::launcher
