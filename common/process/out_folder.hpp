// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/io/fd_writing.hpp"

namespace rtd::process {

/// A folder that one program has for itself as long as this exists: a second run must not delete the results of the
/// first. Held by flock(2) on a file in it, ".rtd.lock", which stays and names the process; the kernel ends the lock of
/// a process that dies. Child programs do not inherit it.
class FolderLock {
 public:
  /// The folder exists. Throws io::IoError: another process has it (the message names its id and the fix), or it cannot
  /// be written.
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  io::Descriptor file_;
};

/// Makes the folder of --out if there is none. Throws service::ConfigError.
void make_out_folder(const std::string& folder);

/// Makes the folder of --out and takes it for this process. Throws service::ConfigError: it cannot be made, or another
/// process has it.
FolderLock take_out_folder(const std::string& folder);

}  // namespace rtd::process
