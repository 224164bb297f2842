// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/io/fd_writing.hpp"

namespace rtd::io {

/// A folder that one program has for itself as long as this exists: a second run must not delete the results of the
/// first. Held by flock(2) on a file in it, ".rtd.lock", which stays and names the process; the kernel ends the lock of
/// a process that dies. Child programs do not inherit it.
class FolderLock {
 public:
  /// The folder exists. Throws IoError: another process has it (the message names its id and the fix), or it cannot be
  /// written.
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  Descriptor file_;
};

}  // namespace rtd::io
