// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace rtd {

/// A DDS domain that no other test has while this process lives, and the one after it, so that tests can run at the
/// same time: 1 to 60. Up to 101 a domain's ports (7400 + 250 N) lie below those that Linux lends to any program, which
/// would now and then be taken already.
inline std::uint32_t test_domain() {
  constexpr std::uint32_t kPairs = 30;
  static const std::uint32_t domain = [] {
    const auto first = static_cast<std::uint32_t>(getpid());
    const std::string locks = std::filesystem::temp_directory_path() / "rtd_test_domain_";
    for (std::uint32_t i = 0; i < kPairs; ++i) {
      const std::uint32_t free = 1 + 2 * ((first + i) % kPairs);
      const int file = open((locks + std::to_string(free)).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return free;  // until the process ends
      if (file >= 0) close(file);
    }
    return 1 + 2 * (first % kPairs);
  }();
  return domain;
}

}  // namespace rtd
