// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/msg/features.hpp"
#include "services/evaluation/record/run_record.hpp"

namespace rtd::launcher {

/// Keeps about `wanted` frames, evenly spread over a source whose length need not be known: every stride-th frame is
/// kept, and whenever twice the wanted number is reached, the stride doubles and every second kept frame is dropped. So
/// few images are encoded, and memory stays bounded in an endless run. Not thread-safe.
class SampleKeeper {
 public:
  /// total: length of the source in frames, 0 = unknown.
  explicit SampleKeeper(std::uint64_t wanted = 12, std::uint64_t total = 0);

  /// A length that became known during the run, before the first frame.
  void expect_total(std::uint64_t total);
  /// True when frame `seq` is one to keep.
  bool wants(std::uint64_t seq) const { return seq % stride_ == 0; }
  void add_image(std::uint64_t seq, std::vector<std::uint8_t> jpeg);
  void add_features(const msg::FeatureFrame& features);

  /// The kept frames that have both image and features, by seq, at most `wanted`.
  std::vector<eval::SampleFrame> samples() const;

 private:
  void thin_out();

  std::uint64_t wanted_, stride_;
  std::map<std::uint64_t, eval::SampleFrame> kept_;
};

}  // namespace rtd::launcher
