// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/recover.hpp"

#include "common/mcap/stream_reader.hpp"
#include "common/mcap/summary.hpp"

namespace rtd::mcap {
namespace {

/// Writes the records of a reader into a new file.
class Copy {
 public:
  Copy(const StreamReader& reader, io::ByteSink& sink, const WriterOptions& options)
      : reader_(reader), sink_(sink), options_(options) {}

  void add(const Record& record) {
    std::visit([&](const auto& typed) { take(typed); }, record);
  }
  Statistics finish() {
    writer().close();
    return writer().statistics();
  }
  std::optional<Statistics> announced;

 private:
  /// Begun with the first record, so that a header can come before.
  Writer& writer() {
    if (!writer_) writer_.emplace(sink_, options_);
    return *writer_;
  }
  void take(const Header& header) {
    if (writer_) return;
    options_.profile = header.profile;
    options_.library = header.library;
  }
  void take(const Schema& schema) { writer().write(schema); }
  void take(const Channel& channel) { define(channel); }
  void take(const Message& message) {
    if (!defined_.contains(message.channel_id)) define(reader_.channels().at(message.channel_id));
    writer().write(message);
  }
  void take(const Attachment& attachment) { writer().write(attachment); }
  void take(const Metadata& metadata) { writer().write(metadata); }
  void take(const Statistics& statistics) { announced = statistics; }
  template <class R>
  void take(const R&) {}

  void define(Channel channel) {
    if (!defined_.insert(channel.id).second) return;
    const auto schema = reader_.schemas().find(channel.schema_id);
    if (schema != reader_.schemas().end())
      writer().write(schema->second);
    else
      channel.schema_id = 0;  // a file must not name a schema that it does not have
    writer().write(channel);
  }

  const StreamReader& reader_;
  io::ByteSink& sink_;
  WriterOptions options_;
  std::optional<Writer> writer_;
  std::set<ChannelId> defined_;
};

}  // namespace

std::optional<std::uint64_t> RecoverReport::messages_lost() const {
  if (!announced) return std::nullopt;
  const std::uint64_t whole = announced->message_count;
  return whole - std::min(whole, recovered.message_count);
}

RecoverReport recover(const io::ByteSource& source, io::ByteSink& sink, const RecoverOptions& options) {
  StreamReader reader(source, options.reader);
  Problems ignored(0);  // the streaming reader finds them, too
  if (const std::optional<Summary> summary = read_summary(source, options.reader, ignored))
    reader.assume(summary->schemas, summary->channels);
  Copy copy(reader, sink, options.writer);
  while (const Record* record = reader.next()) {
    copy.add(*record);
    if (options.progress) options.progress(reader.bytes_read());
  }
  RecoverReport report;
  report.recovered = copy.finish();
  report.announced = copy.announced;
  report.problems = reader.problems().listed();
  report.problem_count = reader.problems().total();
  report.data_lost = reader.problems().data_lost();
  return report;
}

}  // namespace rtd::mcap
