// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "common/bus/offered_qos.hpp"

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

/// A double-quoted YAML scalar.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
    } else {
      if (c == '"' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out + '"';
}

std::string span_text(const char* indent, const FileSummary& span) {
  return fmt::format(
      "{0}duration:\n{0}  nanoseconds: {1}\n{0}starting_time:\n{0}  nanoseconds_since_epoch: {2}\n"
      "{0}message_count: {3}\n",
      indent, span.last_ns - span.first_ns, span.first_ns, span.messages);
}

FileSummary sum(const std::vector<FileSummary>& files) {
  FileSummary all;
  for (const FileSummary& file : files) {
    if (file.messages == 0) continue;
    all.first_ns = all.messages == 0 ? file.first_ns : std::min(all.first_ns, file.first_ns);
    all.last_ns = std::max(all.last_ns, file.last_ns);
    all.messages += file.messages;
    all.bytes += file.bytes;
  }
  return all;
}

std::string topic_text(const RecordedTopic& topic) {
  return fmt::format(
      "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n"
      "        offered_qos_profiles: {}\n      message_count: {}\n",
      quoted(topic.name), quoted(topic.type.name), quoted(bus::offered_qos_text(topic.offered)), topic.counts.written);
}

}  // namespace

SyncThread::SyncThread(std::chrono::milliseconds pause) : pause_(pause), thread_([this] { loop(); }) {}

void SyncThread::put(std::shared_ptr<io::ByteSink> sink, Acknowledged written) {
  {
    const std::lock_guard lock(mutex_);
    // Of one sink only the newest mark counts.
    if (!marks_.empty() && marks_.back().sink == sink) marks_.pop_back();
    marks_.push_back({std::move(sink), std::move(written)});
  }
  changed_.notify_one();
}

Acknowledged SyncThread::acknowledged() const {
  const std::lock_guard lock(mutex_);
  return acknowledged_;
}

std::string SyncThread::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void SyncThread::finish() {
  std::unique_lock lock(mutex_);
  ended_ = true;
  lock.unlock();
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void SyncThread::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ended_ || !marks_.empty(); });
    if (marks_.empty()) return;
    const std::deque<Mark> marks = std::exchange(marks_, {});
    lock.unlock();
    sync(marks);
    lock.lock();
    changed_.wait_for(lock, pause_, [this] { return ended_; });
  }
}

/// In order: a mark counts when all before it are durable too.
void SyncThread::sync(const std::deque<Mark>& marks) {
  for (const Mark& mark : marks) {
    std::string failure;
    try {
      mark.sink->sync();
    } catch (const io::IoError& error) {
      failure = error.what();
    }
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) failure_ = failure;
    if (failure_.empty()) acknowledged_ = mark.written;
  }
}

Recording::Recording(RecordingOptions options, OpenSink open_sink, TopicRegistry& book, SyncThread& sync)
    : options_(options),
      open_sink_(std::move(open_sink)),
      book_(book),
      sync_(sync),
      sink_(open_sink_(0)),
      writer_(*sink_, writer_options(options)) {
  file_.bytes = sink_->position();
}

std::uint64_t Recording::log_time(const QueuedMessage& message) {
  constexpr std::uint64_t kLongestRepairNs = 2'000'000'000;  // beyond: the clock was set back
  if (logged_ns_.size() <= message.topic) logged_ns_.resize(message.topic + 1);
  std::uint64_t& last_ns = logged_ns_[message.topic];
  const bool repaired = message.received_ns < last_ns && last_ns - message.received_ns <= kLongestRepairNs;
  return last_ns = repaired ? last_ns : message.received_ns;
}

void Recording::write(const QueuedMessage& message, std::int64_t now_ns) {
  const io::ByteView data = message.bytes->view();
  const std::uint64_t log_ns = log_time(message);
  const bool chunk_full =
      writer_.open_chunk_messages() > 0 && writer_.open_chunk_bytes() + data.size() > options_.chunk_bytes;
  if (chunk_full) end_chunk();
  const std::uint64_t file_bytes = file_.bytes + writer_.open_chunk_bytes();
  if (file_.messages > 0 && !options_.split.has_room(file_bytes, data.size(), file_.first_ns, log_ns)) {
    begin_next_file();
  }
  writer_.write(mcap::Message{channel(message.topic), message.sequence, log_ns, message.source_ns, data});
  if (messages_.size() <= message.topic) messages_.resize(message.topic + 1);
  ++messages_[message.topic];
  book_.count(message.topic, [&](TopicCounts& counts) {
    ++counts.written;
    counts.written_bytes += data.size();
  });
  if (file_.messages++ == 0) file_.first_ns = log_ns;
  file_.last_ns = std::max(file_.last_ns, log_ns);
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
  file_.bytes = sink_->position();
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
  // rosbag2 takes the type name from the schema, so an unknown type has one too, without text.
  const mcap::SchemaId schema = writer_.add(mcap::Schema{0, type.name, type.encoding, type.text});
  const mcap::ChannelId id = writer_.add(mcap::Channel{
      0, schema, described.name, "cdr", {{"offered_qos_profiles", bus::offered_qos_text(described.offered)}}});
  channels_.emplace(topic, id);
  return id;
}

void Recording::end_chunk() {
  writer_.end_chunk();
  chunk_begun_ns_.reset();
  file_.bytes = sink_->position();
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
  file_.bytes = sink_->position();
}

std::string bag_metadata_text(const std::vector<std::string>& names, const std::vector<FileSummary>& files,
                              const std::vector<RecordedTopic>& topics) {
  std::string text = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n";
  text += span_text("  ", sum(files));
  text += topics.empty() ? "  topics_with_message_count: []\n" : "  topics_with_message_count:\n";
  for (const RecordedTopic& topic : topics) text += topic_text(topic);
  text += "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n";
  for (const std::string& name : names) text += "    - " + name + '\n';
  text += "  files:\n";
  for (std::size_t i = 0; i < files.size(); ++i) {
    text += "    - path: " + names[i] + '\n' + span_text("      ", files[i]);
  }
  return text;
}

}  // namespace rtd::recorder
