// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "common/io/unpacked.hpp"
#include "common/rosbag1/bag_file.hpp"

namespace rtd::rosbag1 {

/// Who published what.
struct Connection {
  std::string topic, type, md5sum, definition;
};

/// One message in the file.
struct MessagePlace {
  std::int64_t time_ns = 0;  ///< when it was recorded; its own stamp is in its header
  std::uint32_t connection = 0, chunk = 0, offset = 0;
};

/// A topic; several publishers share it.
struct Topic {
  std::string name, type;
  std::uint64_t messages = 0;
};

/// Reads a ROS 1 bag, format 2.0 (wiki.ros.org/Bags/Format/2.0). Opening walks over the records without decompressing;
/// index and chunk infos at the end are not needed, so a bag that was never closed or was cut reads like any other: a
/// chunk without its index records is decompressed and searched. Not thread-safe.
class BagReader {
 public:
  /// Throws BagError: no bag, other version, encrypted, unreadable. Damage further on is listed by damages().
  explicit BagReader(const std::filesystem::path& path);

  /// In the order of their names.
  std::vector<Topic> topics() const;
  const std::map<std::uint32_t, Connection>& connections() const { return connections_; }
  /// The messages of these topics, oldest first; at one time in the order of the file.
  std::vector<MessagePlace> messages(const std::vector<std::string>& topics);
  /// The bytes of a message, valid until the next call; each message at most once after messages(). Throws BagError for
  /// a damaged chunk or a place that holds no message of its connection.
  Bytes read(const MessagePlace& message);
  /// What could not be used, one line each; empty for a sound bag. More than a hundred are not listed.
  const std::vector<std::string>& damages() const { return damages_; }
  /// The bag was closed by its writer.
  bool indexed() const { return indexed_; }

 private:
  enum class Index { kAbsent, kSound, kDamaged };
  struct Chunk {
    std::uint64_t begin = 0, bytes = 0, size = 0;  ///< data in the file; size once decompressed
    std::string compression;
    Index index = Index::kAbsent;
    bool refused = false;  ///< it unpacks to too much
  };

  void walk();
  void take_noting(const RecordPlace& place);
  void take(const RecordPlace& place);
  void check_bag_header(const RecordHeader& header) const;
  void take_index(const RecordHeader& header, Bytes entries);
  void distrust_index();
  std::uint32_t last_chunk() const { return static_cast<std::uint32_t>(chunks_.size() - 1); }
  void take_connection(const RecordHeader& header, Bytes data);
  void search_unindexed();
  void search(std::uint32_t chunk, bool messages);
  const std::vector<std::uint8_t>& load(std::uint32_t chunk);
  void take_unread(std::uint64_t bytes);
  void note(const std::string& damage);

  BagFile file_;
  io::UnpackLimit unpack_limit_;
  std::vector<Chunk> chunks_;
  std::vector<MessagePlace> messages_;
  std::map<std::uint32_t, Connection> connections_;
  std::map<std::uint32_t, std::vector<std::uint8_t>> loaded_;  ///< contents of the chunks last used
  std::deque<std::uint32_t> loading_order_;                    ///< of them, the oldest first
  std::uint64_t loaded_bytes_ = 0;
  std::uint64_t described_bytes_ = 0;  ///< definitions
  std::uint64_t unpacked_bytes_ = 0;   ///< of all chunks
  std::uint64_t unread_bytes_ = 0;     ///< of them, since messages(): messages do not overlap
  std::vector<std::string> damages_;
  bool indexed_ = false;
  bool complete_ = true;  ///< connections follow the last chunk: its index was not cut
};

}  // namespace rtd::rosbag1
