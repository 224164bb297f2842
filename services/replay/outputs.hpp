// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/mcap/summary.hpp"
#include "services/replay/core/message_feed.hpp"

namespace rtd::replay {

struct OutputOptions {
  std::map<std::string, std::string> remaps;  ///< by DDS name
  std::string robot;                          ///< whose the topics become; "": names as recorded
  bool restamp = false;                       ///< published_ns of our frames and features becomes now
  bool wait_for_readers = false;              ///< never overtake a reliable reader: nothing else paces the messages
  bool frames_apart = false;  ///< frames have their own writing thread, so that other topics do not wait a millisecond
};

/// A topic of the recording on the bus.
struct Output {
  bus::RawTopic topic;
  bus::RawWriterOptions options;
  bool carries_seq = false;        ///< one of our types that begin with the number of the frame
  bool carries_published = false;  ///< ... and have published_ns behind the stamp
  std::uint64_t sent = 0, refused = 0, since_acknowledged = 0;
  std::vector<std::byte> restamped;
  std::unique_ptr<bus::RawWriter> writer;
};

/// The writers of a replay, with types and QoS as recorded.
class Outputs {
 public:
  /// A writer for each topic among `channels`, and one for the texts of their types, for recorders. Throws BusError;
  /// ConfigError: two types on one topic, one of our types with other fields than it has now.
  Outputs(bus::RawBus& bus, const std::vector<const mcap::Channel*>& channels, const mcap::Summary& summary,
          OutputOptions options);
  ~Outputs();
  Outputs(const Outputs&) = delete;
  Outputs& operator=(const Outputs&) = delete;

  /// Messages of one topic stay in order.
  void send(const PlayedMessage& message);
  void send_clock(std::int64_t recorded_ns);
  const Output& of(mcap::ChannelId channel) const { return *by_channel_.at(channel); }
  const std::map<std::string, Output>& all() const { return outputs_; }  ///< by topic
  /// Reliable topics without a reader.
  std::vector<std::string> unread() const;
  /// Writes the waiting frames. Afterwards nothing can be sent and the counts are final.
  void finish();
  /// Waits until every reliable reader has everything.
  void wait_acknowledged(int timeout_ms);

 private:
  static constexpr std::size_t kWaitingFrames = 4;

  void publish_schemas(const std::vector<const mcap::Channel*>& channels, const mcap::Summary& summary);
  void write(Output& output, const PlayedMessage& message) const;
  Output make_output(const mcap::Channel& channel, const mcap::Summary& summary) const;

  bus::RawBus& bus_;
  const OutputOptions options_;
  std::map<std::string, Output> outputs_;  ///< by topic
  std::map<mcap::ChannelId, Output*> by_channel_;
  std::unique_ptr<bus::RawWriter> clock_, schemas_;
  concurrency::BoundedQueue<PlayedMessage> frames_{kWaitingFrames, concurrency::Overflow::kBlock};
  std::thread frame_thread_;
};

}  // namespace rtd::replay
