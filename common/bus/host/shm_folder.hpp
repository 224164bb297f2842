// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/file.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "common/bus/host/shm_names.hpp"
#include "common/io/fd_writing.hpp"

namespace rtd::bus {

/// The folder of shared memory, with one process at a time that chooses a name in it or removes what was left there.
/// Nothing of the lock stays, and that of a killed process ends. Anyone may hold it: who has waited for `patience`
/// goes without.
class ShmFolder {
 public:
  ShmFolder(const std::filesystem::path& path, std::chrono::milliseconds patience)
      : folder_(open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + patience;
    while (!locked_ && folder_.get() >= 0) {
      locked_ = flock(folder_.get(), LOCK_EX | LOCK_NB) == 0;
      if (locked_ || Clock::now() >= end) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  bool locked() const { return locked_; }
  const io::Descriptor& descriptor() const { return folder_; }

 private:
  io::Descriptor folder_;
  bool locked_ = false;
};

}  // namespace rtd::bus
