// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/chunk_content.hpp"

#include <algorithm>

#include "common/mcap/compression.hpp"
#include "common/mcap/crc32.hpp"
#include "common/mcap/decode.hpp"
#include "common/mcap/encode.hpp"

namespace rtd::mcap {

std::string hex(std::uint32_t value) {
  std::string text = "0x00000000";
  for (std::size_t i = text.size(); i > 2; value /= 16) text[--i] = "0123456789abcdef"[value % 16];
  return text;
}

ChunkContent open_chunk(const Chunk& chunk, const ReaderOptions& options, Decompressor& decompress, Buffer& scratch) {
  const std::optional<Compression> compression = compression_of(chunk.compression);
  if (!compression)
    return {{}, ProblemKind::kUnknownCompression, "its compression \"" + chunk.compression + "\" is not known"};
  const std::uint64_t possible = largest_uncompressed_size(*compression, chunk.records.size());
  const std::uint64_t most = std::min(options.max_record_bytes, possible);
  if (chunk.uncompressed_size > most)
    return {{},
            ProblemKind::kTooLarge,
            "it claims " + std::to_string(chunk.uncompressed_size) + " bytes uncompressed; " +
                (most == possible ? "its " + std::to_string(chunk.records.size()) + " bytes cannot become more than "
                                  : std::string("the reader's limit is ")) +
                std::to_string(most)};
  ChunkContent content;
  content.records = decompress(*compression, chunk.records, chunk.uncompressed_size, scratch, content.what);
  if (!content.records) {
    content.fault = ProblemKind::kDamagedRecord;
  } else if (options.check_crcs && chunk.uncompressed_crc != 0) {
    const std::uint32_t found = crc32(*content.records);
    if (found == chunk.uncompressed_crc) return content;
    return {{},
            ProblemKind::kCrcMismatch,
            "the CRC of its content is " + hex(found) + ", it says " + hex(chunk.uncompressed_crc)};
  }
  return content;
}

std::optional<InnerRecord> RecordCursor::next() {
  if (cut_ || left() == 0) return std::nullopt;
  const ByteView rest = records_.subspan(position_);
  if (rest.size() < kFrameBytes || load<std::uint64_t>(rest.data() + 1) > rest.size() - kFrameBytes) {
    cut_ = true;
    return std::nullopt;
  }
  const auto length = load<std::uint64_t>(rest.data() + 1);
  const InnerRecord record{static_cast<Opcode>(rest[0]), position_, rest.subspan(kFrameBytes, length)};
  position_ += kFrameBytes + length;
  return record;
}

}  // namespace rtd::mcap
