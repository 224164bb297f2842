// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <stdexcept>
#include <string>

namespace rtd::camera {

/// A file is no .oni file that can be given to OpenNI2; what() names it, the byte and the cause.
class OniFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What the walk over an .oni file has found.
struct OniCheck {
  std::uint64_t records = 0;
  std::uint64_t frames = 0;  ///< records of images, of all streams
  bool cut = false;          ///< the last record is not complete: the recorder was killed or the disk was full
};

/// Checks the frame of an .oni file, whose content OpenNI2's library reads without much doubt: magic "NI10", version
/// 1.x, and a chain of records from the header to the end record or the end of the file, each with its magic, fields
/// and image of a size that the library's buffers hold. Only the last record may be cut. What the records contain is
/// left to the library. Reads 28 bytes of each record. Throws OniFileError. `name` is for the messages.
OniCheck check_oni(std::istream& file, const std::string& name);

/// The same of a file; one that does not exist is left to the library.
void require_oni_file(const std::filesystem::path& path);

}  // namespace rtd::camera
