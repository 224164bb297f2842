// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/launcher/core/run/record_builder.hpp"

namespace rtd::launcher {

/// The frames of a run in memory, where tests look at them.
class FrameList final : public FrameStore {
 public:
  bool append(const run_record::FrameRecord& frame) override {
    if (frames.size() >= room) return false;
    frames.push_back(frame);
    return true;
  }
  std::vector<run_record::FrameRecord> read() override { return frames; }

  std::vector<run_record::FrameRecord> frames;
  std::size_t room = SIZE_MAX;
};

}  // namespace rtd::launcher
