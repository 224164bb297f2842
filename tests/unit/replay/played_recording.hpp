// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/writer.hpp"

namespace rtd::replay {

inline constexpr std::int64_t kMillisecond = 1'000'000;

struct RecordedPiece {
  std::string topic;
  std::int64_t log_ns = 0;
  std::string payload;
};

/// A recording in memory and its reader.
class PlayedRecording {
 public:
  explicit PlayedRecording(const std::vector<RecordedPiece>& pieces, std::uint64_t chunk_size = 200)
      : bytes_(file_of(pieces, chunk_size)), source_(bytes_), reader_(source_) {}
  mcap::IndexedReader& reader() { return reader_; }

 private:
  static io::Bytes file_of(const std::vector<RecordedPiece>& pieces, std::uint64_t chunk_size) {
    io::MemorySink sink;
    mcap::WriterOptions options;
    options.chunk_size = chunk_size;
    mcap::Writer writer(sink, options);
    std::map<std::string, mcap::ChannelId> channels;
    for (const RecordedPiece& piece : pieces) {
      if (!channels.contains(piece.topic))
        channels[piece.topic] = writer.add(mcap::Channel{0, 0, piece.topic, "cdr", {}});
      const auto time = static_cast<mcap::Timestamp>(piece.log_ns);
      writer.write(mcap::Message{channels.at(piece.topic), 0, time, time, io::bytes_of(piece.payload)});
    }
    writer.close();
    return sink.bytes();
  }

  io::Bytes bytes_;
  io::MemorySource source_;
  mcap::IndexedReader reader_;
};

inline std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// `count` messages of one topic, 10 ms apart from 1 s on; the payload is the number.
inline std::vector<RecordedPiece> numbered(int count, const std::string& topic = "/frame") {
  std::vector<RecordedPiece> pieces;
  for (int i = 0; i < count; ++i) pieces.push_back({topic, (1000 + 10 * i) * kMillisecond, std::to_string(i)});
  return pieces;
}

}  // namespace rtd::replay
