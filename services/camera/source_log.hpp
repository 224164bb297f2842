// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/camera/frame_source.hpp"
#include "common/service/log.hpp"
#include "common/service/pacer.hpp"
#include "services/camera/core/read_ahead.hpp"

namespace rtd::camera {

/// What the log says of a source: its size and camera, what it was taken for, what is wrong with it.
void log_opened(const SourceInfo& info);

/// What it left out; as often as `limit` lets pass.
void log_skipped(const ReadItem& item, service::RateLimit& limit);

/// Pauses that were cut to `max_gap_s`, and a source slower than its stamps.
void log_timeline(const service::PaceDecision& decision, std::uint64_t frame, double max_gap_s);

}  // namespace rtd::camera
