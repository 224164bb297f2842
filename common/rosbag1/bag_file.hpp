// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/io/byte_source.hpp"
#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::rosbag1 {

using ros::Bytes;

/// The values of the field "op".
enum class Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// Seconds and nanoseconds, 4 bytes each.
inline std::int64_t read_time_ns(ros::ByteCursor& cursor) {
  const auto sec = cursor.read<std::uint32_t>();
  return std::int64_t{sec} * 1'000'000'000 + cursor.read<std::uint32_t>();
}

/// The header of a record: "name=value" fields, each behind its length.
class RecordHeader {
 public:
  /// Throws ros::WireError for fields that do not fill the bytes.
  explicit RecordHeader(Bytes bytes);

  std::optional<Op> op() const;
  /// A number or time of the record. Throws ros::WireError when the field is absent or of another size.
  template <class T>
  T number(const std::string& name) const {
    ros::ByteCursor cursor(field(name));
    const T value = cursor.read<T>();
    if (cursor.remaining() != 0) throw ros::WireError("field '" + name + "' has the wrong size");
    return value;
  }
  std::int64_t time_ns(const std::string& name) const;
  /// Empty when the field is absent.
  std::string text(const std::string& name) const;

 private:
  Bytes field(const std::string& name) const;
  std::map<std::string, Bytes, std::less<>> fields_;
};

/// A bag that cannot be used, or a piece of it; what() names file, place, cause and fix.
class BagError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Larger chunks and index records are refused: rosbag writes 0.75 MiB by default.
inline constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{256} << 20U;

/// The content of a chunk. `compression`: none, bz2 or lz4 (LZ4 frame format). `size` is what the chunk claims; memory
/// is taken as content appears, so that a false claim costs nothing. Throws ros::WireError: unknown compression (naming
/// it and those known), damaged data, another size than claimed.
std::vector<std::uint8_t> decompress(const std::string& compression, std::vector<std::uint8_t> data, std::size_t size);

/// Where a record lies in the file.
struct RecordPlace {
  std::vector<std::uint8_t> header;
  std::uint64_t data_begin = 0, data_bytes = 0;
  std::uint64_t end() const { return data_begin + data_bytes; }
};

/// Reads pieces of a file. Each length is checked against the size of the file before memory is allocated for it.
class BagFile {
 public:
  /// Throws BagError: file that cannot be read, no bag, a bag of another version.
  explicit BagFile(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return file_->size(); }
  std::uint64_t first_record() const { return first_record_; }

  /// The record at `position`, its data not yet read. Throws BagError when it does not fit into the file.
  RecordPlace record_at(std::uint64_t position);
  /// Throws BagError when the bytes are not there or more than kMaxChunkBytes.
  std::vector<std::uint8_t> read(std::uint64_t position, std::uint64_t bytes);

 private:
  BagError error_at(std::uint64_t position, const std::string& cause) const;
  std::filesystem::path path_;
  std::unique_ptr<io::FileSource> file_;
  std::uint64_t first_record_ = 0;
};

}  // namespace rtd::rosbag1
