// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What the edge of the bus costs for each message: bench_message_screen.
#include "common/bus/message_screen.hpp"

#include <benchmark/benchmark.h>

#include "tests/unit/bus/message_walk.hpp"

namespace rtd::bus {
namespace {

template <class T>
void screen(benchmark::State& state) {
  const auto message = walk::plausible_message<T>();
  if constexpr (std::is_same_v<T, msg::FeatureFrame>) message->count = msg::kMaxFeatures;
  MessageScreen screen(MessageTraits<T>::kId);
  for (auto _ : state) benchmark::DoNotOptimize(screen.implausible_field(message.get(), {}));
  if (screen.implausible_field(message.get(), {})) state.SkipWithError("not plausible");
}

BENCHMARK(screen<msg::FeatureFrame>);
BENCHMARK(screen<msg::RgbdFrame>);
BENCHMARK(screen<msg::RgbdFrame1920>);
BENCHMARK(screen<msg::TrackingResult>);
BENCHMARK(screen<msg::ServiceStatus>);

}  // namespace
}  // namespace rtd::bus

BENCHMARK_MAIN();
