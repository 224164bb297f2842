// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Gives each reader of files the inputs that take it longest: fuzz_worst_cases [bytes of each] [part of a name]. What
/// must hold: no crash, at most 2 s of processor time up to 1 MB and in proportion for more, at most 512 MiB. Prints
/// what each took; exit code 1 when one took more. The time is that of the reader's process alone, so that other
/// processes count little.
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <new>

#include "tests/fuzz/worst/worst_case.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::worst {
namespace {

constexpr double kSlower = test_support::kSanitized ? 20 : 1;

struct Cost {
  double cpu_s = 0, peak_mib = 0;
  bool ended = false;
};

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

[[noreturn]] void run(const Case& one, double most_s) {
  const rlimit limit{static_cast<rlim_t>(most_s) + 1, static_cast<rlim_t>(most_s) + 1};
  setrlimit(RLIMIT_CPU, &limit);
  try {
    one.read();
  } catch (const std::bad_alloc&) {
    _exit(1);
  } catch (const std::exception&) {
  }
  _exit(0);
}

/// What this process holds, and a fork of it from its beginning.
double resident_mib() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

Cost cost_of(const Case& one, double most_s) {
  malloc_trim(0);  // what was freed here would be free memory there
  const double before_mib = resident_mib();
  const pid_t child = fork();
  if (child == 0) run(one, most_s);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime),
          std::max(0.0, static_cast<double>(usage.ru_maxrss) / 1024 - before_mib),
          WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

std::vector<Case> all(std::size_t bytes, const std::filesystem::path& folder) {
  std::vector<Case> cases = images(bytes);
  for (std::vector<Case>& more : std::vector{texts(bytes, folder), recordings(bytes, folder), models(bytes, folder)})
    std::ranges::move(more, std::back_inserter(cases));
  return cases;
}

int check(std::size_t bytes, const std::string& wanted, const std::filesystem::path& folder) {
  constexpr double kMost_MiB = 512;
  const double most_s = 2 * kSlower * std::max(1.0, static_cast<double>(bytes) / 1e6);
  int failed = 0;
  for (const Case& one : all(bytes, folder)) {
    if (one.name.find(wanted) == std::string::npos) continue;
    const Cost cost = cost_of(one, most_s);
    const bool well = cost.ended && cost.cpu_s <= most_s && (test_support::kSanitized || cost.peak_mib <= kMost_MiB);
    std::printf("%-60s %6.2f s %6.0f MiB%s\n", one.name.c_str(), cost.cpu_s, cost.peak_mib,
                well ? "" : (cost.ended ? "  TOO MUCH" : "  DID NOT END WELL"));
    std::fflush(stdout);
    failed += well ? 0 : 1;
  }
  return failed;
}

}  // namespace

std::filesystem::path file_of(const std::filesystem::path& folder, const std::string& name,
                              const std::string& content) {
  static int count = 0;
  const std::filesystem::path own = folder / std::to_string(count++);
  std::filesystem::create_directories(own);
  std::ofstream(own / name, std::ios::binary) << content;
  return own / name;
}

std::string repeated(const std::string& part, std::size_t bytes) {
  std::string text;
  while (text.size() < bytes) text += part;
  return text;
}

}  // namespace rtd::worst

int main(int argc, char** argv) {
  const std::size_t bytes = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 150'000;
  const rtd::test::TemporaryFolder folder;
  const int failed = rtd::worst::check(bytes, argc > 2 ? argv[2] : "", folder);
  return failed == 0 ? 0 : 1;
}
