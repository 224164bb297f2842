// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace rtd::camera {

/// What to do with a file that holds frames in a form that is not read: archives, recordings of other programs. Empty
/// for every other name.
std::string advice_for_file(const std::filesystem::path& file);

/// The same for the first such file in a folder, by name.
std::string advice_for_folder(const std::filesystem::path& folder);

}  // namespace rtd::camera
