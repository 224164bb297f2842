// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/copy.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "common/mcap/stream_reader.hpp"
#include "common/mcap/summary.hpp"

namespace rtd::mcap {
namespace {

/// The new file. Remembers which of its channels stands for which one of the parts.
class NewFile {
 public:
  NewFile(io::ByteSink& sink, const WriterOptions& options) : sink_(sink), options_(options) {}

  void begin_part() { channel_of_.clear(); }
  void take(const StreamReader& /*part*/, const Header& header) {
    if (writer_) return;
    options_.profile = header.profile;
    options_.library = header.library;
  }
  void take(const StreamReader& /*part*/, const Schema& schema) { writer().add(schema); }
  void take(const StreamReader& part, const Channel& channel) { this->channel(part, channel.id); }
  void take(const StreamReader& part, const Message& message) {
    Message renamed = message;
    renamed.channel_id = channel(part, message.channel_id);
    writer().write(renamed);
  }
  void take(const StreamReader& /*part*/, const Attachment& attachment) { writer().write(attachment); }
  void take(const StreamReader& /*part*/, const Metadata& metadata) {
    if (metadata_.emplace(metadata.name, metadata.metadata).second) writer().write(metadata);
  }
  void take(const StreamReader& /*part*/, const Statistics& statistics) {
    announced = announced.value_or(0) + statistics.message_count;
  }
  template <class R>
  void take(const StreamReader& /*part*/, const R&) {}

  Statistics finish() {
    writer().close();
    return writer().statistics();
  }

  std::optional<std::uint64_t> announced;  ///< messages

 private:
  /// Begun with the first record, so that a header can come before.
  Writer& writer() {
    if (!writer_) writer_.emplace(sink_, options_);
    return *writer_;
  }
  ChannelId channel(const StreamReader& part, ChannelId id) {
    if (const auto known = channel_of_.find(id); known != channel_of_.end()) return known->second;
    Channel channel = part.channels().at(id);
    const auto schema = part.schemas().find(channel.schema_id);
    // A file must not name a schema that it does not have.
    channel.schema_id = schema == part.schemas().end() ? SchemaId{0} : writer().add(schema->second);
    return channel_of_[id] = writer().add(std::move(channel));
  }

  io::ByteSink& sink_;
  WriterOptions options_;
  std::optional<Writer> writer_;
  std::set<std::pair<std::string, std::map<std::string, std::string>>> metadata_;  ///< name and content
  std::map<ChannelId, ChannelId> channel_of_;                                      ///< of the part in work
};

/// Copies one source, behind others of `bytes_before`, and adds its problems to the report.
void copy(const io::ByteSource& source, NewFile& file, const CopyOptions& options, std::uint64_t bytes_before,
          CopyReport& report) {
  StreamReader reader(source, options.reader);
  Problems ignored(0);  // the streaming reader finds them, too
  if (const std::optional<Summary> summary = read_summary(source, options.reader, ignored))
    reader.assume(summary->schemas, summary->channels);
  while (const Record* record = reader.next()) {
    std::visit([&](const auto& typed) { file.take(reader, typed); }, *record);
    if (options.progress) options.progress(bytes_before + reader.bytes_read());
  }
  const auto& listed = reader.problems().listed();
  report.problems.insert(report.problems.end(), listed.begin(), listed.end());
  report.problem_count += reader.problems().total();
  report.data_lost = report.data_lost || reader.problems().data_lost();
}

}  // namespace

std::optional<std::uint64_t> CopyReport::messages_lost() const {
  if (!announced) return std::nullopt;
  return *announced - std::min(*announced, copied.message_count);
}

CopyReport join(std::span<const io::ByteSource* const> parts, io::ByteSink& sink, const CopyOptions& options) {
  CopyReport report;
  NewFile file(sink, options.writer);
  std::uint64_t bytes_before = 0;
  for (const io::ByteSource* const part : parts) {
    file.begin_part();
    copy(*part, file, options, bytes_before, report);
    bytes_before += part->size();
  }
  report.copied = file.finish();
  report.announced = file.announced;
  return report;
}

CopyReport recover(const io::ByteSource& source, io::ByteSink& sink, CopyOptions options) {
  options.reader.salvage_cut_chunk = true;
  return join(std::array{&source}, sink, options);
}

}  // namespace rtd::mcap
