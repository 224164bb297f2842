// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet/fleet_pipeline.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <vector>

namespace rtd::detector {
namespace {

TEST(WorkerPool, runs_each_part_of_each_job_once) {
  for (const int threads : {1, 2, 5}) {
    WorkerPool pool(threads);
    for (std::size_t parts = 0; parts < 200; ++parts) {
      std::vector<std::atomic<int>> runs(parts);
      pool.for_each(parts, [&](std::size_t part) { ++runs[part]; });
      EXPECT_TRUE(std::ranges::all_of(runs, [](const auto& count) { return count == 1; })) << parts;
    }
  }
}

TEST(WorkerPool, works_on_several_parts_at_a_time) {
  WorkerPool pool(3);
  std::atomic<int> waiting{0};
  pool.for_each(3, [&](std::size_t) {
    ++waiting;
    while (waiting < 3) std::this_thread::yield();  // ends only when all three are at work
  });
  EXPECT_EQ(waiting, 3);
}

}  // namespace
}  // namespace rtd::detector
