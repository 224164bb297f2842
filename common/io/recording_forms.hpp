// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

/// By what the forms of recordings are recognised: how a file begins, and how its name ends.
namespace rtd::io {

inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::string_view kBagVersionLine = "#ROSBAG V2.0\n";
inline constexpr std::string_view kBagMagic = kBagVersionLine.substr(0, kBagVersionLine.size() - 1);
inline constexpr std::string_view kBagOfAnyVersion = kBagVersionLine.substr(0, kBagVersionLine.find('2'));
inline constexpr std::string_view kDb3Magic = "SQLite format 3";    ///< a database of rosbag2
inline constexpr std::string_view kZstdMagic = "\x28\xb5\x2f\xfd";  ///< a frame of zstd
inline constexpr std::size_t kMagicBytes = 16;                      ///< enough of a file to recognise each

inline constexpr const char *kMcapExtension = ".mcap", *kBagExtension = ".bag", *kDb3Extension = ".db3";
inline constexpr std::array<const char*, 2> kPackedExtensions = {".zstd", ".zst"};  ///< of rosbag2, of the program zstd

/// FILE.mcap, FILE.bag or FILE.db3.
inline bool is_recording_name(const std::filesystem::path& file) {
  const std::filesystem::path extension = file.extension();
  return extension == kMcapExtension || extension == kBagExtension || extension == kDb3Extension;
}

/// FILE.zstd or FILE.zst.
inline bool is_packed_name(const std::filesystem::path& file) {
  return std::ranges::any_of(kPackedExtensions, [&](const char* packed) { return file.extension() == packed; });
}

}  // namespace rtd::io
