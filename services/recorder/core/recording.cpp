// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/recording.hpp"

#include <algorithm>
#include <limits>

#include "common/ros2/offered_qos.hpp"

namespace rtd::recorder {
namespace {

mcap::WriterOptions writer_options(const RecordingOptions& options) {
  mcap::WriterOptions writer;
  writer.profile = "ros2";
  writer.library = "rtd-slam";
  writer.compression = options.compression;
  // This class ends the chunks itself, so that it knows which messages each of them contains.
  writer.chunk_size = std::numeric_limits<std::uint64_t>::max() / 2;
  return writer;
}

}  // namespace

Recording::Recording(RecordingOptions options, OpenSink open_sink, TopicBook& book, SyncThread& sync)
    : options_(options),
      open_sink_(std::move(open_sink)),
      book_(book),
      sync_(sync),
      sink_(open_sink_(0)),
      writer_(*sink_, writer_options(options)) {
  update_file();
}

void Recording::write(const QueuedMessage& message, std::int64_t now_ns) {
  const io::ByteView data = message.bytes->view();
  const bool chunk_full =
      writer_.open_chunk_messages() > 0 && writer_.open_chunk_bytes() + data.size() > options_.chunk_bytes;
  if (chunk_full) end_chunk();
  const std::uint64_t file_bytes = file_.bytes + writer_.open_chunk_bytes();
  if (file_.messages > 0 && !options_.split.has_room(file_bytes, data.size(), file_.first_ns, message.received_ns)) {
    begin_next_file();
  }
  writer_.write(mcap::Message{channel(message.topic), message.sequence, message.received_ns, message.source_ns, data});
  if (messages_.size() <= message.topic) messages_.resize(message.topic + 1);
  ++messages_[message.topic];
  book_.count_written(message.topic, data.size());
  if (file_.messages++ == 0) file_.first_ns = message.received_ns;
  file_.last_ns = std::max(file_.last_ns, message.received_ns);
  if (!chunk_begun_ns_) chunk_begun_ns_ = now_ns;
  if (writer_.open_chunk_bytes() >= options_.chunk_bytes) end_chunk();
}

void Recording::tick(std::int64_t now_ns) {
  if (chunk_begun_ns_ && now_ns - *chunk_begun_ns_ >= options_.chunk_age_ns) end_chunk();
}

void Recording::finish(const std::vector<mcap::Metadata>& metadata) {
  const std::size_t topics = book_.topics().size();
  for (std::size_t topic = 0; topic < topics; ++topic) channel(topic);
  end_chunk();
  for (const mcap::Metadata& record : metadata) writer_.write(record);
  writer_.close();
  update_file();
  sync_.put(sink_, {bytes(), messages_});
}

std::vector<FileSummary> Recording::files() const {
  std::vector<FileSummary> all = ended_files_;
  all.push_back(file_);
  return all;
}

mcap::ChannelId Recording::channel(std::size_t topic) {
  if (const auto known = channels_.find(topic); known != channels_.end()) return known->second;
  const RecordedTopic described = book_.topic(topic);
  const ros2::TypeDefinition& type = described.type;
  auto schema = schemas_.find(type.name);
  if (schema == schemas_.end()) {
    // rosbag2 takes the type name from the schema, so an unknown type has one too, without text.
    schema = schemas_.emplace(type.name, writer_.add(mcap::Schema{0, type.name, type.encoding, type.text})).first;
  }
  const mcap::ChannelId id = writer_.add(mcap::Channel{
      0, schema->second, described.name, "cdr", {{"offered_qos_profiles", ros2::offered_qos_text(described.offered)}}});
  channels_.emplace(topic, id);
  return id;
}

void Recording::end_chunk() {
  writer_.end_chunk();
  chunk_begun_ns_.reset();
  update_file();
  sync_.put(sink_, {bytes(), messages_});
}

void Recording::begin_next_file() {
  end_chunk();
  std::shared_ptr<io::ByteSink> next = open_sink_(ended_files_.size() + 1);
  writer_.split(*next);
  file_.bytes = sink_->position();
  sync_.put(sink_, {bytes(), messages_});
  bytes_before_ += file_.bytes;
  ended_files_.push_back(file_);
  file_ = {};
  sink_ = std::move(next);
  update_file();
}

void Recording::update_file() {
  file_.bytes = sink_->position();
}

}  // namespace rtd::recorder
