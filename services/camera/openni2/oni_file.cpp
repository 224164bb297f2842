// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/openni2/oni_file.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::camera {
namespace {

constexpr std::uint64_t kFileHeaderBytes = 24, kRecordHeaderBytes = 28;
constexpr std::uint32_t kRecordMagic = 0x0052494E;         // "NIR\0"
constexpr std::uint32_t kMaxFieldBytes = 1600 * 1200 * 3;  // the player's buffer for a record
constexpr std::uint32_t kMaxImageBytes = kMaxFieldBytes;   // and for an image
constexpr std::uint32_t kImage = 10, kEnd = 11;            // types of records

struct RecordHeader {
  std::uint32_t magic = 0, type = 0, node = 0, field_bytes = 0, payload_bytes = 0;
  /// `field_bytes` counts this header, too.
  std::uint64_t bytes() const { return std::uint64_t{field_bytes} + payload_bytes; }
};

class OniWalk {
 public:
  OniWalk(std::istream& file, const std::string& name) : file_(file), name_(name) {
    file_.seekg(0, std::ios::end);
    size_ = static_cast<std::uint64_t>(std::max<std::streamoff>(file_.tellg(), 0));
  }

  OniCheck run() {
    check_header();
    std::uint64_t at = kFileHeaderBytes;
    while (const auto record = record_at(at)) {
      check_record(*record, at);
      if (size_ - at < record->bytes()) {
        result_.cut = true;
        break;
      }
      ++result_.records;
      if (record->type == kImage) ++result_.frames;
      if (record->type == kEnd) return result_;
      at += record->bytes();
    }
    if (result_.records == 0) fail(kFileHeaderBytes, "the file has no complete record");
    return result_;
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, const std::string& cause) const {
    throw OniFileError(name_ + " is not an .oni file that OpenNI2 can play: byte " + std::to_string(at) + ": " + cause +
                       "; record it again, or copy it again from where it was recorded");
  }

  template <std::size_t kBytes>
  std::array<std::uint8_t, kBytes> read(std::uint64_t at) {
    std::array<std::uint8_t, kBytes> bytes{};
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(at));
    file_.read(reinterpret_cast<char*>(bytes.data()), kBytes);
    if (!file_) fail(at, "the file cannot be read");
    return bytes;
  }

  void check_header() {
    if (size_ < kFileHeaderBytes) fail(0, "a header of 24 bytes is expected, the file has " + std::to_string(size_));
    const auto bytes = read<kFileHeaderBytes>(0);
    if (ros::to_text(ros::Bytes(bytes).first(4)) != "NI10") fail(0, "it does not begin with NI10");
    if (bytes[4] != 1)
      fail(4, "version " + std::to_string(bytes[4]) + "." + std::to_string(bytes[5]) + ", only 1.x can be played");
  }

  /// Empty at the end of the file.
  std::optional<RecordHeader> record_at(std::uint64_t at) {
    if (size_ - at < kRecordHeaderBytes) {
      result_.cut = size_ != at;
      return std::nullopt;
    }
    const auto bytes = read<kRecordHeaderBytes>(at);
    ros::ByteCursor cursor(bytes);
    RecordHeader record;
    for (std::uint32_t* field : {&record.magic, &record.type, &record.node, &record.field_bytes, &record.payload_bytes})
      *field = cursor.read<std::uint32_t>();
    return record;
  }

  void check_record(const RecordHeader& record, std::uint64_t at) const {
    if (record.magic != kRecordMagic) fail(at, "a record is expected, it has another magic");
    if (record.field_bytes < kRecordHeaderBytes || record.field_bytes > kMaxFieldBytes)
      fail(at, "the fields of a record claim " + std::to_string(record.field_bytes) + " bytes, allowed: 28 to " +
                   std::to_string(kMaxFieldBytes));
    if (record.type == kImage && record.payload_bytes > kMaxImageBytes)
      fail(at, "an image claims " + std::to_string(record.payload_bytes) + " bytes, at most " +
                   std::to_string(kMaxImageBytes) + " can be played");
    if (record.type != kImage && size_ - at < record.field_bytes)
      fail(at, "a record claims " + std::to_string(record.field_bytes) + " bytes, the file has " +
                   std::to_string(size_ - at) + " more");
  }

  std::istream& file_;
  const std::string& name_;
  std::uint64_t size_ = 0;
  OniCheck result_;
};

}  // namespace

OniCheck check_oni(std::istream& file, const std::string& name) {
  return OniWalk(file, name).run();
}

void require_oni_file(const std::filesystem::path& path) {
  if (std::error_code none; !std::filesystem::exists(path, none)) return;
  try {
    io::InputStream file(path);
    check_oni(file, path.string());
  } catch (const io::IoError& error) {
    throw OniFileError(error.what());
  }
}

}  // namespace rtd::camera
