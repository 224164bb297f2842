// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/join.hpp"

#include <set>
#include <utility>

#include "common/mcap/stream_reader.hpp"
#include "common/mcap/summary.hpp"

namespace rtd::mcap {
namespace {

/// The new file; remembers which of its channels stands for which one of the parts.
class Joint {
 public:
  Joint(io::ByteSink& sink, const WriterOptions& options) : sink_(sink), options_(options) {}

  void begin_part() { channel_of_.clear(); }
  void add(const StreamReader& part, const Record& record) {
    std::visit([&](const auto& typed) { take(part, typed); }, record);
  }
  Statistics finish() {
    writer().close();
    return writer().statistics();
  }

 private:
  /// Begun with the first record, so that a header can come before.
  Writer& writer() {
    if (!writer_) writer_.emplace(sink_, options_);
    return *writer_;
  }
  void take(const StreamReader& /*part*/, const Header& header) {
    if (writer_) return;
    options_.profile = header.profile;
    options_.library = header.library;
  }
  void take(const StreamReader& part, const Message& message) {
    Message renamed = message;
    renamed.channel_id = channel(part, message.channel_id);
    writer().write(renamed);
  }
  void take(const StreamReader& part, const Channel& channel) { this->channel(part, channel.id); }
  void take(const StreamReader& /*part*/, const Attachment& attachment) { writer().write(attachment); }
  void take(const StreamReader& /*part*/, const Metadata& metadata) {
    if (metadata_.emplace(metadata.name, metadata.metadata).second) writer().write(metadata);
  }
  template <class R>
  void take(const StreamReader& /*part*/, const R&) {}

  ChannelId channel(const StreamReader& part, ChannelId id) {
    if (const auto known = channel_of_.find(id); known != channel_of_.end()) return known->second;
    Channel channel = part.channels().at(id);
    const auto schema = part.schemas().find(channel.schema_id);
    // A file must not name a schema that it does not have.
    channel.schema_id = schema == part.schemas().end() ? SchemaId{0} : same_or_new(schemas_, schema->second);
    return channel_of_[id] = same_or_new(channels_, channel);
  }
  /// The id in the new file of a record that is equal but for its id; written if it is new.
  template <class R>
  decltype(R::id) same_or_new(std::vector<R>& written, R record) {
    for (const R& other : written) {
      record.id = other.id;
      if (record == other) return other.id;
    }
    record.id = writer().add(record);
    written.push_back(record);
    return record.id;
  }

  io::ByteSink& sink_;
  WriterOptions options_;
  std::optional<Writer> writer_;
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::set<std::pair<std::string, std::map<std::string, std::string>>> metadata_;  ///< name and content
  std::map<ChannelId, ChannelId> channel_of_;                                      ///< of the part in work
};

}  // namespace

JoinReport join(std::span<const io::ByteSource* const> parts, io::ByteSink& sink, const JoinOptions& options) {
  JoinReport report;
  Joint joint(sink, options.writer);
  std::uint64_t bytes_before = 0;
  for (const io::ByteSource* const part : parts) {
    StreamReader reader(*part, options.reader);
    Problems ignored(0);  // the streaming reader finds them, too
    if (const std::optional<Summary> summary = read_summary(*part, options.reader, ignored))
      reader.assume(summary->schemas, summary->channels);
    joint.begin_part();
    while (const Record* record = reader.next()) {
      joint.add(reader, *record);
      if (options.progress) options.progress(bytes_before + reader.bytes_read());
    }
    bytes_before += part->size();
    const auto& listed = reader.problems().listed();
    report.problems.insert(report.problems.end(), listed.begin(), listed.end());
    report.problem_count += reader.problems().total();
    report.data_lost = report.data_lost || reader.problems().data_lost();
  }
  report.joined = joint.finish();
  return report;
}

}  // namespace rtd::mcap
