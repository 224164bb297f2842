// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/rosbag1/bag_file.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>

#include "common/io/byte_sink.hpp"
#include "common/io/recording_forms.hpp"

namespace rtd::rosbag1 {

RecordHeader::RecordHeader(Bytes bytes) {
  ros::ByteCursor cursor(bytes);
  while (cursor.remaining() > 0) {
    const Bytes entry = cursor.take(cursor.read<std::uint32_t>());
    const auto equals = std::find(entry.begin(), entry.end(), '=');
    if (equals == entry.end()) throw ros::WireError("a record's field has no '='");
    const auto name_length = static_cast<std::size_t>(equals - entry.begin());
    fields_[ros::to_text(entry.first(name_length))] = entry.subspan(name_length + 1);
  }
}

std::optional<Op> RecordHeader::op() const {
  const auto found = fields_.find("op");
  if (found == fields_.end() || found->second.size() != 1) return std::nullopt;
  return static_cast<Op>(found->second.front());
}

std::int64_t RecordHeader::time_ns(const std::string& name) const {
  ros::ByteCursor cursor(field(name));
  return read_time_ns(cursor);
}

std::string RecordHeader::text(const std::string& name) const {
  const auto found = fields_.find(name);
  return found == fields_.end() ? std::string() : ros::to_text(found->second);
}

Bytes RecordHeader::field(const std::string& name) const {
  const auto found = fields_.find(name);
  if (found == fields_.end()) throw ros::WireError("a record lacks its field '" + name + "'");
  return found->second;
}

namespace {

constexpr std::string_view kMagic = io::kBagOfAnyVersion, kVersionLine = io::kBagVersionLine;
constexpr std::uint64_t kMaxHeaderBytes = 1U << 20U;
constexpr std::uint64_t kLengthBytes = 4;

using Content = std::vector<std::uint8_t>;

constexpr std::size_t kFirstGuess = std::size_t{4} << 20U;

/// Room for more output: what is claimed, but doubling from kFirstGuess on.
void grow(Content& content, std::size_t size) {
  content.resize(std::min(size, std::max(kFirstGuess, 2 * content.size())));
}

void check_size(std::size_t found, std::size_t size) {
  if (found == size) return;
  throw ros::WireError("a chunk holds " + std::to_string(found) + " bytes but claims " + std::to_string(size));
}

Content decompress_bz2(Content& data, std::size_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> guard(&stream, BZ2_bzDecompressEnd);
  stream.next_in = reinterpret_cast<char*>(data.data());
  stream.avail_in = static_cast<unsigned>(data.size());
  Content content;
  std::size_t found = 0;
  for (int status = BZ_OK; status != BZ_STREAM_END;) {
    if (found == content.size()) grow(content, size);
    stream.next_out = reinterpret_cast<char*>(content.data() + found);
    stream.avail_out = static_cast<unsigned>(content.size() - found);
    const std::size_t room = stream.avail_out, left = stream.avail_in;
    status = BZ2_bzDecompress(&stream);
    found += room - stream.avail_out;
    if (status != BZ_OK && status != BZ_STREAM_END) throw ros::WireError("a bz2 chunk is damaged");
    const bool stuck = stream.avail_out == room && stream.avail_in == left;
    if (stuck && status != BZ_STREAM_END) throw ros::WireError("a bz2 chunk ends early or is longer than it claims");
  }
  check_size(found, size);
  return content;
}

Content decompress_lz4(const Content& data, std::size_t size) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> guard(context, LZ4F_freeDecompressionContext);
  Content content;
  std::size_t found = 0, used = 0;
  for (std::size_t hint = 1; hint != 0;) {
    if (found == content.size()) grow(content, size);
    std::size_t produced = content.size() - found, consumed = data.size() - used;
    hint = LZ4F_decompress(context, content.data() + found, &produced, data.data() + used, &consumed, nullptr);
    if (LZ4F_isError(hint) != 0)
      throw ros::WireError(std::string("an lz4 chunk is damaged: ") + LZ4F_getErrorName(hint));
    found += produced;
    used += consumed;
    if (hint != 0 && produced == 0 && consumed == 0) {
      throw ros::WireError("an lz4 chunk ends early or is longer than it claims");
    }
  }
  check_size(found, size);
  return content;
}

}  // namespace

BagFile::BagFile(std::filesystem::path path) : path_(std::move(path)) {
  try {
    file_ = std::make_unique<io::FileSource>(path_);
  } catch (const io::IoError& error) {
    throw BagError(error.what());
  }
  const std::vector<std::uint8_t> start = read(0, std::min<std::uint64_t>(size(), kVersionLine.size()));
  const std::string line(start.begin(), start.end());
  if (line == kVersionLine) {
    first_record_ = kVersionLine.size();
    return;
  }
  if (line.rfind(kMagic, 0) != 0) throw BagError(path_.string() + " is not a ROS bag: it does not begin with #ROSBAG");
  throw BagError(path_.string() + " is a bag of version " +
                 line.substr(kMagic.size(), line.find('\n') - kMagic.size()) +
                 ", only 2.0 can be read; convert it with: rosbag fix OLD.bag NEW.bag");
}

RecordPlace BagFile::record_at(std::uint64_t position) {
  const auto length_at = [this](std::uint64_t at) {
    const std::vector<std::uint8_t> bytes = read(at, kLengthBytes);
    return std::uint64_t{ros::ByteCursor(bytes).read<std::uint32_t>()};
  };
  RecordPlace place;
  const std::uint64_t header_bytes = length_at(position);
  if (header_bytes > kMaxHeaderBytes) {
    throw error_at(position, "a record's header claims " + std::to_string(header_bytes) + " bytes");
  }
  place.header = read(position + kLengthBytes, header_bytes);
  place.data_bytes = length_at(position + kLengthBytes + header_bytes);
  place.data_begin = position + 2 * kLengthBytes + header_bytes;
  if (place.end() > size()) {
    throw error_at(position, "a record claims " + std::to_string(place.data_bytes) + " bytes, the file has " +
                                 std::to_string(size() - place.data_begin) + " more");
  }
  return place;
}

std::vector<std::uint8_t> BagFile::read(std::uint64_t position, std::uint64_t bytes) {
  if (bytes > kMaxChunkBytes) throw error_at(position, std::to_string(bytes) + " bytes in one piece are too many");
  if (position > size() || bytes > size() - position)
    throw error_at(position, "the file ends in the middle of a record");
  std::vector<std::uint8_t> content(bytes);
  if (file_->read(position, std::as_writable_bytes(std::span(content))) != bytes)
    throw error_at(position, "reading fails");
  return content;
}

BagError BagFile::error_at(std::uint64_t position, const std::string& cause) const {
  return BagError(path_.string() + ", byte " + std::to_string(position) + ": " + cause);
}

Content decompress(const std::string& compression, Content data, std::size_t size) {
  if (compression == "none") {
    check_size(data.size(), size);
    return data;
  }
  if (compression == "bz2") return decompress_bz2(data, size);
  if (compression == "lz4") return decompress_lz4(data, size);
  throw ros::WireError("unknown compression '" + compression + "'; known: none, bz2, lz4");
}

}  // namespace rtd::rosbag1
