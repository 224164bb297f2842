// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/file.h>

#include <chrono>
#include <filesystem>
#include <string>
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

/// How the folders of rings in shared memory begin.
inline constexpr char kRingsPrefix[] = "rtd_rings_";
/// Names the folder of BusOptions::rings: `rtd run` sets it for its services.
inline constexpr char kRingsVariable[] = "RTD_RINGS";

/// The folder in which writers of frames have their rings and readers look for them: `asked`, else one for this user.
/// Made where there is none. Another user can neither enter it nor put a ring there. Empty when it cannot be made or is
/// not for this user alone, as when another user was faster: then frames go without rings.
std::string ring_folder(const std::string& asked);

/// A new folder of rings for the services that this process starts: in their environment, and removed at the end.
/// Without shared memory there is none, and they use that of this user.
class RingsOfRun {
 public:
  RingsOfRun();
  ~RingsOfRun();
  RingsOfRun(const RingsOfRun&) = delete;
  RingsOfRun& operator=(const RingsOfRun&) = delete;

 private:
  std::string folder_;
};

}  // namespace rtd::bus
