// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/red/red_watch.hpp"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <limits>

#include "tests/support/sanitizers.hpp"

namespace rtd::testing {
namespace {

constexpr double kMaxOfCall_s = 1;
constexpr std::uint64_t kMaxGrowthKib = 64 * 1024;

/// Of all threads: a busy computer does not make it longer.
double computing_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The most memory that the process has had since the last reset_peak().
std::uint64_t peak_kib() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    std::uint64_t kib = 0;
    if (word == "VmHWM:" && status >> kib) return kib;
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace

RedWatch::RedWatch(const char* name, std::uint64_t messages, int argc, char** argv)
    : name_(name),
      wanted_(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : messages),
      seed_(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1) {}

void RedWatch::call(const char* what, const std::function<void()>& core) {
  ++calls_;
  const double begin_s = computing_s();
  try {
    core();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: message %llu of seed %llu: %s threw: %s\n", name_.c_str(),
                 static_cast<unsigned long long>(messages_), static_cast<unsigned long long>(seed_), what,
                 error.what());
    std::exit(1);
  }
  const double took_s = computing_s() - begin_s;
  if (took_s <= longest_s_) return;
  longest_s_ = took_s;
  longest_ = std::string(what) + " of message " + std::to_string(messages_);
}

void RedWatch::settled() {
  reset_peak();
  settled_kib_ = peak_kib();
}

int RedWatch::finish() {
  const std::uint64_t peak = peak_kib(), growth_kib = peak > settled_kib_ ? peak - settled_kib_ : 0;
  std::printf(
      "%s: %llu messages of seed %llu, %llu passed the edge, %llu calls, longest %.3f s (%s), %.1f MiB more than the "
      "%.1f MiB of before\n",
      name_.c_str(), static_cast<unsigned long long>(messages_), static_cast<unsigned long long>(seed_),
      static_cast<unsigned long long>(passed_), static_cast<unsigned long long>(calls_), longest_s_, longest_.c_str(),
      static_cast<double>(growth_kib) / 1024, static_cast<double>(settled_kib_) / 1024);
  const bool reached = 3 * passed_ >= messages_;
  const bool quick = test_support::kSanitized || longest_s_ <= kMaxOfCall_s;
  const bool bounded = test_support::kSanitized || growth_kib <= kMaxGrowthKib;
  if (!reached) std::fprintf(stderr, "less than a third of the messages reached the core\n");
  if (!quick) std::fprintf(stderr, "a call took longer than %.0f s\n", kMaxOfCall_s);
  if (!bounded) std::fprintf(stderr, "the memory grew by more than %llu MiB\n", kMaxGrowthKib / 1024ULL);
  return reached && quick && bounded ? 0 : 1;
}

}  // namespace rtd::testing
