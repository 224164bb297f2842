// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/io/unpacked.hpp"
#include "common/mcap/writer.hpp"
#include "common/recordings/reader.hpp"

namespace rtd::recordings {

/// Called now and then with the share of a file that has been read, 0 to 1.
using Share = std::function<void(double share)>;

/// Copies recordings of several formats into one MCAP file: messages byte for byte with their times; channels that are
/// the same in several files as one. ROS 1 messages keep their encoding ("ros1").
class Import {
 public:
  /// `sink` is empty and outlives this. `packed_messages`: each message is a zstd frame.
  Import(io::ByteSink& sink, bool packed_messages);

  /// Adds a file of this form; `name` is for messages. Throws mcap::RecordingFileError when it is no MCAP file,
  /// database or bag or cannot be used at all, io::IoError when the sink fails.
  void add(const std::filesystem::path& file, Form form, const std::string& name, const Share& progress);
  /// Ends the MCAP file.
  void close() { writer_.close(); }
  /// What could not be copied, one line each.
  const std::vector<std::string>& damages() const { return damages_; }
  void note(const std::string& damage) { damages_.push_back(damage); }

 private:
  void add_mcap(const std::filesystem::path& file, const std::string& name, const Share& progress);
  void add_indexed(const std::filesystem::path& file, Form form, const std::string& name, const Share& progress);
  mcap::ChannelId channel(const mcap::Schema& schema, mcap::Channel channel);
  void write(mcap::Message message, const std::string& topic);

  mcap::Writer writer_;
  const bool packed_messages_;
  io::UnpackLimit unpack_limit_{0};  ///< of the messages of one file
  std::vector<std::string> damages_;
};

}  // namespace rtd::recordings
