// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/writer.hpp"

#include <algorithm>
#include <array>

#include "common/io/bytes.hpp"

namespace rtd::mcap {

namespace {

constexpr std::array kExtraData{std::byte{0x01}, std::byte{0xff}, std::byte{0xff}};

void require(bool allowed, const std::string& what) {
  if (!allowed) throw std::invalid_argument("MCAP: " + what);
}

template <class Id, class R>
Id lowest_free_id(const std::map<Id, R>& used) {
  require(used.size() < 0xfffe, "no id is free: a file holds at most 65534 schemas and as many channels");
  Id id = 1;
  while (used.contains(id)) ++id;
  return id;
}

/// False: it is known already and the same.
template <class Id, class R>
bool is_new(const std::map<Id, R>& known, const R& record, const char* kind) {
  const auto found = known.find(record.id);
  if (found == known.end()) return true;
  require(found->second == record, std::string(kind) + ' ' + std::to_string(record.id) +
                                       " is already defined otherwise; an id keeps its meaning through a file");
  return false;
}

/// Appends the end of a file, from the first summary record to the closing magic, to `out`, which holds the DataEnd.
class SummarySection {
 public:
  /// `out_offset`: where out[0] stands in the file.
  SummarySection(Bytes& out, std::uint64_t out_offset, ByteView padding)
      : out_(out), out_offset_(out_offset), padding_(padding), start_(out.size()) {}

  /// All records of one kind: a vector, or a map whose values they are.
  template <class Records>
  void group(const Records& records, bool wanted) {
    if (!wanted || records.empty()) return;
    const std::uint64_t group_start = offset();
    for (const auto& entry : records) append_record(out_, record_of(entry), padding_);
    const Opcode opcode = record_of(*records.begin()).kOpcode;
    offsets_.push_back({opcode, group_start, offset() - group_start});
  }

  void finish(bool with_offsets) {
    Footer footer;
    if (out_.size() != start_) footer.summary_start = out_offset_ + start_;
    if (with_offsets && !offsets_.empty()) {
      footer.summary_offset_start = offset();
      for (const SummaryOffset& group : offsets_) append_record(out_, group, padding_);
    }
    append_record(out_, footer);
    // The CRC covers the footer up to itself.
    const std::size_t crc_at = out_.size() - sizeof(footer.summary_crc);
    io::store(out_.data() + crc_at, io::crc32(ByteView(out_).subspan(start_, crc_at - start_)));
    Encoder(out_).rest(io::bytes_of(kMagic));
  }

 private:
  std::uint64_t offset() const { return out_offset_ + out_.size(); }
  template <class R>
  static const R& record_of(const R& record) {
    return record;
  }
  template <class Id, class R>
  static const R& record_of(const std::pair<const Id, R>& entry) {
    return entry.second;
  }

  Bytes& out_;
  std::uint64_t out_offset_;
  ByteView padding_;
  std::size_t start_;
  std::vector<SummaryOffset> offsets_;
};

}  // namespace

Writer::Writer(io::ByteSink& sink, WriterOptions options) : sink_(&sink), options_(std::move(options)) {
  require(options_.chunk_size > 0, "chunk_size is 0; give at least 1 byte, usually 1 to 4 MiB");
  begin();
}

void Writer::begin() {
  require(sink_->position() == 0,
          "a file begins in an empty sink; this one holds " + std::to_string(sink_->position()) + " bytes");
  offset_ = data_crc_ = 0;
  Bytes start;
  Encoder(start).rest(io::bytes_of(kMagic));
  append_record(start, Header{options_.profile, options_.library}, padding());
  append(start);
  statistics_ = {};
  chunk_indexes_.clear();
  attachment_indexes_.clear();
  metadata_indexes_.clear();
  closed_ = false;
  for (const auto& [id, schema] : schemas_) define(schema);
  for (const auto& [id, channel] : channels_) define(channel);
}

void Writer::write(const Schema& schema) {
  require_open();
  require(schema.id != 0, "schema \"" + schema.name + "\" has the id 0, which means \"no schema\"; use 1 to 65535");
  if (!is_new(schemas_, schema, "schema")) return;
  define(schema);
  schema_ids_.emplace(meaning_of(schemas_.emplace(schema.id, schema).first->second), schema.id);
}

void Writer::write(const Channel& channel) {
  require_open();
  require(channel.schema_id == 0 || schemas_.contains(channel.schema_id),
          "channel \"" + channel.topic + "\" names schema " + std::to_string(channel.schema_id) +
              ", which was not written before");
  if (!is_new(channels_, channel, "channel")) return;
  define(channel);
  channel_ids_.emplace(meaning_of(channels_.emplace(channel.id, channel).first->second), channel.id);
}

SchemaId Writer::add(Schema schema) {
  if (const auto same = schema_ids_.find(meaning_of(schema)); same != schema_ids_.end()) return same->second;
  schema.id = lowest_free_id(schemas_);
  write(schema);
  return schema.id;
}

ChannelId Writer::add(Channel channel) {
  if (const auto same = channel_ids_.find(meaning_of(channel)); same != channel_ids_.end()) return same->second;
  channel.id = lowest_free_id(channels_);
  write(channel);
  return channel.id;
}

void Writer::write(const Message& message) {
  require_open();
  require(channels_.contains(message.channel_id),
          "a message names channel " + std::to_string(message.channel_id) + ", which was not written before");
  if (!options_.use_chunks) {
    Bytes record;
    append_record(record, message);
    append(record);
  } else {
    const std::uint64_t size = kFrameBytes + 22 + message.data.size();
    if (chunk_.records.size() + size > options_.chunk_size) end_chunk();
    if (options_.self_contained_chunks) repeat_definitions(message.channel_id);
    MessageIndex& index = chunk_.indexes[message.channel_id];
    index.channel_id = message.channel_id;
    index.records.emplace_back(message.log_time, chunk_.records.size());
    append_record(chunk_.records, message);
    chunk_.messages.count(message);
  }
  statistics_.count(message);
}

void Writer::write(const Attachment& attachment) {
  require_open();
  Bytes record;
  append_record(record, attachment, padding());
  const std::size_t crc_at = record.size() - padding().size() - sizeof(attachment.crc);
  io::store(record.data() + crc_at, io::crc32(ByteView(record).subspan(kFrameBytes, crc_at - kFrameBytes)));
  const AttachmentIndex index{
      offset_,         record.size(),        attachment.log_time, attachment.create_time, attachment.data.size(),
      attachment.name, attachment.media_type};
  append(record);
  attachment_indexes_.push_back(index);
  ++statistics_.attachment_count;
}

void Writer::write(const Metadata& metadata) {
  require_open();
  Bytes record;
  append_record(record, metadata, padding());
  const MetadataIndex index{offset_, record.size(), metadata.name};
  append(record);
  metadata_indexes_.push_back(index);
  ++statistics_.metadata_count;
}

void Writer::end_chunk() {
  require_open();
  if (chunk_.messages.message_count == 0) return;  // what is defined so far waits for its first message
  const ByteView records = chunk_.records;
  const std::uint32_t crc = io::crc32(records);
  const ByteView body = compress(options_.compression, records, compressed_);
  const Statistics& messages = chunk_.messages;
  Chunk chunk{
      messages.message_start_time, messages.message_end_time, records.size(), crc, name_of(options_.compression), {}};
  Bytes head;
  append_record(head, chunk);
  // The records themselves go from where they are into the sink: only their lengths are put into the head.
  io::store(head.data() + 1, head.size() - kFrameBytes + body.size());
  io::store(head.data() + head.size() - sizeof(std::uint64_t), std::uint64_t{body.size()});
  chunk.records = body;
  ChunkIndex index = index_of(chunk, offset_, head.size() + body.size());
  Bytes tail;
  if (options_.use_message_index) {
    for (const auto& [channel, entries] : chunk_.indexes) {
      index.message_index_offsets[channel] = index.chunk_start_offset + index.chunk_length + tail.size();
      append_record(tail, entries, padding());
    }
  }
  index.message_index_length = tail.size();
  append(head, body, options_.compression == Compression::kNone ? crc : io::crc32(body), tail);
  chunk_indexes_.push_back(std::move(index));
  ++statistics_.chunk_count;
  clear_chunk();
}

void Writer::close() {
  if (closed_) return;
  end_chunk();
  append(chunk_.records);  // defined, but never used: no chunk, as there are readers that refuse one without messages
  clear_chunk();
  Bytes end;
  append_record(end, DataEnd{data_crc_});
  SummarySection summary(end, offset_, padding());
  summary.group(schemas_, options_.use_repeated_schemas);
  summary.group(channels_, options_.use_repeated_channels);
  summary.group(std::vector{statistics_}, options_.use_statistics);
  summary.group(chunk_indexes_, options_.use_chunk_index);
  summary.group(attachment_indexes_, options_.use_attachment_index);
  summary.group(metadata_indexes_, options_.use_metadata_index);
  summary.finish(options_.use_summary_offset);
  append(end);
  closed_ = true;
}

void Writer::split(io::ByteSink& next) {
  close();
  sink_ = &next;
  begin();
}

void Writer::require_open() const {
  require(!closed_, "the file is closed; nothing can be written to it any more");
}

template <class R>
void Writer::define(const R& record) {
  if (options_.use_chunks) {
    append_record(chunk_.records, record);
  } else {
    Bytes bytes;
    append_record(bytes, record, padding());
    append(bytes);
  }
  if constexpr (std::is_same_v<R, Schema>) {
    ++statistics_.schema_count;
  } else {
    ++statistics_.channel_count;
    defined_in_chunk_.insert(record.id);
  }
}

void Writer::repeat_definitions(ChannelId id) {
  if (!defined_in_chunk_.insert(id).second) return;
  const Channel& channel = channels_.at(id);
  if (channel.schema_id != 0) append_record(chunk_.records, schemas_.at(channel.schema_id));
  append_record(chunk_.records, channel);
}

/// Keeps the memory of the records.
void Writer::clear_chunk() {
  chunk_.records.clear();
  chunk_.indexes.clear();
  chunk_.messages = {};
  defined_in_chunk_.clear();
}

ByteView Writer::padding() const {
  return options_.add_extra_data_to_records ? ByteView(kExtraData) : ByteView();
}

void Writer::append(ByteView record) {
  append(record, {}, 0, {});
}

void Writer::append(ByteView head, ByteView body, std::uint32_t body_crc, ByteView tail) {
  sink_->append({head, body, tail});
  offset_ += head.size() + body.size() + tail.size();
  data_crc_ = io::crc32(head, data_crc_);
  if (!body.empty()) data_crc_ = io::crc32_combine(data_crc_, body_crc, body.size());
  data_crc_ = io::crc32(tail, data_crc_);
}

}  // namespace rtd::mcap
