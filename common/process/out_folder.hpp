// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/io/folder_lock.hpp"

namespace rtd::process {

/// Makes the folder of --out if there is none. Throws service::ConfigError.
void make_out_folder(const std::string& folder);

/// Makes the folder of --out and takes it for this process. Throws service::ConfigError: it cannot be made, or another
/// process has it.
io::FolderLock take_out_folder(const std::string& folder);

}  // namespace rtd::process
