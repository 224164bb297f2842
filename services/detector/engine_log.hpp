// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "common/service/log.hpp"
#include "services/detector/core/engine_guard.hpp"

namespace rtd::detector {

/// Logs what happens to the engine: that it was verified, why the CPU takes its place, that the memory of its device
/// holds fewer images. Each of these once, also when several guards report. Not thread-safe.
class EngineLog {
 public:
  explicit EngineLog(std::string asked) : asked_(std::move(asked)) {}

  void report(const EngineGuard& guard) {
    const std::string& device = guard.detector().device();
    if (guard.verified() == EngineGuard::kVerifiedImages && !std::exchange(verified_, true))
      SPDLOG_INFO("event=engine_verified images={} device=\"{}\"", guard.verified(), device);
    const std::string before = std::exchange(device_, device);
    const bool fell_back = !guard.fallback().empty();
    if (fell_back && guard.fallback() != fallback_) {
      fallback_ = guard.fallback();
      SPDLOG_WARN("event=engine_fallback asked={} device=\"{}\" cause=\"{}\"", asked_, device, fallback_);
    } else if (fallback_.empty() && !before.empty() && device != before) {
      SPDLOG_WARN("event=engine_changed device=\"{}\"", device);
    }
  }

 private:
  const std::string asked_;
  std::string device_, fallback_;
  bool verified_ = false;
};

}  // namespace rtd::detector
