// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/io/byte_source.hpp"
#include "common/mcap/records.hpp"

/// Where records begin and end in a file, also in a damaged one.
namespace rtd::mcap {

/// The part of a source that a reader has in memory: views inside it cost no read.
class SourceWindow {
 public:
  explicit SourceWindow(const io::ByteSource& source) : source_(source) {}

  std::uint64_t size() const { return source_.size(); }
  /// The bytes [offset, offset + length), until the next view(); empty when the source does not have or give them.
  /// Allocates `length` bytes at most (64 KiB at least): the caller bounds it.
  std::optional<ByteView> view(std::uint64_t offset, std::uint64_t length);
  /// Copies bytes without moving the window; false when the source does not have or give them.
  bool peek(std::uint64_t offset, std::span<std::byte> into) const;

 private:
  bool has(std::uint64_t offset, std::uint64_t length) const { return offset <= size() && length <= size() - offset; }

  const io::ByteSource& source_;
  Buffer buffer_;
  std::uint64_t start_ = 0;
  ByteView bytes_;
};

/// A record in a file before its content is looked at; its length may reach beyond the end of the file.
struct Frame {
  Opcode opcode{};
  std::uint64_t offset = 0;  ///< of the opcode
  std::uint64_t length = 0;  ///< of the content

  std::uint64_t content() const { return offset + 9; }
  std::uint64_t left_in_file(std::uint64_t file_size) const { return file_size - content(); }
  bool fits(std::uint64_t file_size) const { return length <= left_in_file(file_size); }
  std::uint64_t end() const { return content() + length; }
};

/// "Chunk"; "record of type 0x85" for one that the format does not know.
std::string name_of(Opcode opcode);
bool is_known(Opcode opcode);

/// Empty when fewer than 9 bytes are left or readable.
std::optional<Frame> frame_at(const SourceWindow& file, std::uint64_t offset);

/// True at the end of the file, at the closing magic and where two records in a row have a known type and a length that
/// is possible (below 4 GiB); the second may be cut by the end of the file. Random bytes pass with less than 1e-9.
bool begins_record(const SourceWindow& file, std::uint64_t offset);

/// The first place at or behind `from` that begins a record that can occur alone: Chunk, Attachment, Metadata,
/// DataEnd, Footer and, with `loose_messages`, Schema, Channel and Message, which also occur inside chunks.
std::optional<std::uint64_t> find_record(SourceWindow& file, std::uint64_t from, bool loose_messages);

}  // namespace rtd::mcap
