// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/store/block_io.hpp"

#include <algorithm>
#include <array>

#include "common/io/bytes.hpp"

namespace rtd::slam::map_format {
namespace {

constexpr std::size_t kCrcBytes = 4;

/// Empty for an unknown one.
std::string name_of(BlockTag tag) {
  constexpr std::array kKnown = {BlockTag::kHead,    BlockTag::kLandmarks, BlockTag::kKeyframes,
                                 BlockTag::kRemoved, BlockTag::kLoops,     BlockTag::kEnd};
  if (std::ranges::count(kKnown, tag) == 0) return {};
  io::Bytes letters;
  FieldWriter{letters}(static_cast<std::uint32_t>(tag));
  return {reinterpret_cast<const char*>(letters.data()), letters.size()};
}

/// The preamble, which is the same in every version, names the version that wrote the rest.
void check_preamble(io::ByteView preamble) {
  const io::ByteView described = preamble.first(kPreambleBytes - kCrcBytes);
  if (io::load<std::uint32_t>(preamble.data() + described.size()) != io::crc32(described))
    fail_damaged(0, "the checksum of the file's beginning does not fit");
  const auto version = io::load<std::uint32_t>(preamble.data() + kMagic.size());
  if (version == kVersion) return;
  throw MapFileError(MapFileDefect::kVersion,
                     "the map file has version " + std::to_string(version) + " of the format, this program reads " +
                         "version " + std::to_string(kVersion) + ": " +
                         (version > kVersion ? "use the newer program that wrote it, or map again"
                                             : "map again, or use the older program that wrote it"));
}

}  // namespace

void fail_damaged(std::uint64_t offset, const std::string& cause) {
  throw MapFileError(MapFileDefect::kDamaged, "the map file is damaged at byte " + std::to_string(offset) + ": " +
                                                  cause + "; use a copy or the last checkpoint, or map again");
}

BlockWriter::BlockWriter(io::ByteSink& sink) : sink_(sink) {
  io::Bytes preamble(io::bytes_of(kMagic).begin(), io::bytes_of(kMagic).end());
  FieldWriter write(preamble);
  write(kVersion);
  write(io::crc32(preamble));
  sink_.append({preamble});
}

void BlockWriter::write(BlockTag tag, io::ByteView payload) {
  io::Bytes head, crc;
  FieldWriter{head}(static_cast<std::uint32_t>(tag), static_cast<std::uint32_t>(payload.size()));
  FieldWriter{crc}(io::crc32(payload, io::crc32(head)));
  sink_.append({head, payload, crc});
  ++blocks_;
}

void BlockWriter::end() {
  io::Bytes payload;
  FieldWriter{payload}(blocks_, sink_.position());
  write(BlockTag::kEnd, payload);
}

BlockReader::BlockReader(const io::ByteSource& source) : source_(source) {
  const std::size_t begins_with = static_cast<std::size_t>(std::min<std::uint64_t>(source.size(), kMagic.size()));
  const io::ByteView begin = read(begins_with, "beginning");
  if (!std::ranges::equal(begin, io::bytes_of(kMagic).first(begin.size())) || source.size() == 0)
    throw MapFileError(MapFileDefect::kNotAMap, source.size() == 0
                                                    ? "the file is empty"
                                                    : "this is not a map file: it does not begin with RTDMAP");
  position_ = 0;
  check_preamble(read(kPreambleBytes, "beginning"));
}

io::ByteView BlockReader::read(std::size_t size, const char* what) {
  if (size > source_.size() - position_)
    fail_damaged(position_, "the file ends inside its " + std::string(what) + " (" + std::to_string(source_.size()) +
                                " bytes): it was cut");
  if (buffer_.size() < size) buffer_.resize(size);
  const std::span<std::byte> bytes(buffer_.data(), size);
  if (source_.read(position_, bytes) != size) fail_damaged(position_, "its bytes cannot be read from the disk");
  position_ += size;
  return bytes;
}

Block BlockReader::next() {
  const std::uint64_t offset = position_;
  const io::ByteView head = read(kBlockHeadBytes, "blocks");
  const auto tag = static_cast<BlockTag>(io::load<std::uint32_t>(head.data()));
  const auto size = io::load<std::uint32_t>(head.data() + 4);
  const std::uint32_t head_crc = io::crc32(head);
  const std::string name = name_of(tag);
  if (name.empty()) fail_damaged(offset, "a block of an unknown kind");
  if (size > kMaxBlockBytes) fail_damaged(offset, "block " + name + " of " + std::to_string(size) + " bytes");
  const io::ByteView rest = read(size + kCrcBytes, "blocks");
  const io::ByteView payload = rest.first(size);
  if (io::load<std::uint32_t>(rest.data() + size) != io::crc32(payload, head_crc))
    fail_damaged(offset, "the checksum of block " + name + " does not fit");
  ++blocks_;
  return {tag, offset, payload};
}

void BlockReader::check_end(const Block& last) const {
  std::uint32_t blocks = 0;
  std::uint64_t offset = 0;
  if (last.tag != BlockTag::kEnd) fail_damaged(last.offset, "block ENDS is missing");
  FieldReader read(last.payload);
  read(blocks, offset);
  if (blocks + 1 != blocks_ || offset != last.offset || read.left() != 0)
    fail_damaged(last.offset, "blocks are missing or repeated");
  if (position_ != source_.size()) fail_damaged(position_, "something follows the end of the map");
}

}  // namespace rtd::slam::map_format
