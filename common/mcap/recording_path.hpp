// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace rtd::mcap {

/// The file that a person means: the path itself or, where it is a folder as recorders make them, the .mcap file in it.
/// Throws IoError (byte_sink.hpp): no such file in the folder, or several parts of a recording that was split.
std::filesystem::path recording_path(const std::filesystem::path& path);

}  // namespace rtd::mcap
