// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/source_log.hpp"

namespace rtd::camera {

void log_opened(const SourceInfo& info) {
  const auto& camera = info.camera.parameters();
  SPDLOG_INFO("event=source_opened uri={} frames={} width={} height={} fx={} fps={}", info.uri, info.frames,
              camera.width, camera.height, camera.fx, info.fps);
  for (const std::string& note : info.notes) SPDLOG_INFO("event=source_note text=\"{}\"", note);
  for (const std::string& remark : info.remarks) SPDLOG_WARN("event=source_remark cause=\"{}\"", remark);
}

void log_skipped(const ReadItem& item, service::RateLimit& limit) {
  for (const SkippedInput& skipped : item.skipped) {
    if (!limit.pass()) continue;
    SPDLOG_WARN("event=input_skipped reason={} total={} detail=\"{}\"", to_string(skipped.reason),
                item.counters.skipped_total(), skipped.detail);
  }
}

void log_timeline(const service::PaceDecision& decision, std::uint64_t frame, double max_gap_s) {
  if (decision.cut_gap_ns > 0) {
    SPDLOG_WARN("event=gap_cut frame={} cut_s={:.3f} played_s={:g}", frame,
                static_cast<double>(decision.cut_gap_ns) * 1e-9, max_gap_s);
  }
  if (decision.shifted_ns > 0) {
    SPDLOG_WARN("event=timeline_shifted frame={} by_s={:.3f} cause=\"the source is slower than its stamps\"", frame,
                static_cast<double>(decision.shifted_ns) * 1e-9);
  }
}

}  // namespace rtd::camera
