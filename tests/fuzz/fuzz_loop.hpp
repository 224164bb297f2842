// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

#include "common/mcap/codec.hpp"
#include "tests/fuzz/mcap/allocation_watch.hpp"

namespace rtd::testing {

/// The main loop of a fuzz driver, `DRIVER [INPUTS [SEED]]`. `make` makes an input of a random generator; `test` says
/// why an input is a failure, empty when it is none: the first one is written to `failed_path` and ends the loop with
/// exit code 1; `all_well` says what it has counted.
template <class Make, class Test, class AllWell>
int run_fuzz(int argc, char** argv, const char* failed_path, const Make& make, const Test& test,
             const AllWell& all_well) {
  const std::uint64_t inputs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 5000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::mt19937_64 random(seed);
  watch_allocations();
  for (std::uint64_t i = 0; i < inputs; ++i) {
    const io::Bytes input = make(random);
    peak_allocation();
    const std::string failure = test(input, random);
    if (failure.empty()) continue;
    std::ofstream(failed_path, std::ios::binary)
        .write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
    std::fprintf(stderr, "input %llu of seed %llu: %s\n", static_cast<unsigned long long>(i),
                 static_cast<unsigned long long>(seed), failure.c_str());
    return 1;
  }
  std::printf("%llu inputs, all well (%s)\n", static_cast<unsigned long long>(inputs), all_well().c_str());
  return 0;
}

}  // namespace rtd::testing
