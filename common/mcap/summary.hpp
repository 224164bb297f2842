// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mcap/chunk_content.hpp"
#include "common/mcap/framing.hpp"

namespace rtd::mcap {

/// A message outside of chunks.
struct LooseMessage {
  Timestamp log_time = 0;
  std::uint64_t offset = 0;
  ChannelId channel_id = 0;
};

/// What is in a file and where, from its summary or from reading it all.
struct Summary {
  Header header;
  std::map<SchemaId, Schema> schemas;
  std::map<ChannelId, Channel> channels;
  std::optional<Statistics> statistics;   ///< always there after a scan
  std::vector<ChunkIndex> chunk_indexes;  ///< in file order
  std::vector<AttachmentIndex> attachment_indexes;
  std::vector<MetadataIndex> metadata_indexes;
  std::vector<LooseMessage> loose_messages;  ///< only after a scan
  bool scanned = false;                      ///< there was no usable summary
};

/// The summary at the end of a file when it is whole (CRC) and its chunk indexes point at chunks; else empty, with the
/// reason as a problem.
std::optional<Summary> read_summary(const io::ByteSource& source, const ReaderOptions& options, Problems& problems);

/// Reads the whole file. Chunks that cannot be opened are reported and not in the result.
Summary scan(const io::ByteSource& source, const ReaderOptions& options, Problems& problems);

}  // namespace rtd::mcap
