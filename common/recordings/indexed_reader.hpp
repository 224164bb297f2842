// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/recordings/reader.hpp"
#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::recordings {

/// What the file says about messages of one topic and type, word for word.
struct StoredChannel {
  std::string topic, type;
  std::string encoding;  ///< of the messages: "cdr", "ros1", ...
  std::string schema_encoding, schema_text;
  std::map<std::string, std::string> metadata;
};

/// A message where it lies, until the next use of its reader.
struct StoredMessage {
  std::int64_t channel = 0;  ///< key of channels()
  std::int64_t recorded_ns = 0;
  ros::Bytes bytes;
};

/// A file that knows the places of all its messages: a ROS 1 bag or a database of rosbag2, read where it lies.
class IndexedReader : public Reader {
 public:
  /// All, whatever their encoding.
  const std::map<std::int64_t, StoredChannel>& channels() const { return channels_; }
  /// Begins to play all channels; returns how many messages there are.
  virtual std::size_t play_all() = 0;
  virtual std::optional<StoredMessage> next_stored() = 0;

 protected:
  using Reader::Reader;
  std::map<std::int64_t, StoredChannel> channels_;
};

/// `form` is kBag or kDb3. Throws mcap::RecordingFileError.
std::unique_ptr<IndexedReader> open_indexed(const std::filesystem::path& file, Form form);

}  // namespace rtd::recordings
