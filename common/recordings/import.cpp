// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/import.hpp"

#include <algorithm>
#include <optional>

#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/indexed_reader.hpp"

namespace rtd::recordings {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxDamages = 100;

/// Reports every thousandth message, and the end.
class Steps {
 public:
  Steps(const Share& progress, std::uint64_t messages) : progress_(progress), messages_(messages) {}
  ~Steps() { progress_(1); }
  void step() {
    constexpr std::uint64_t kStep = 1000;
    if (++done_ % kStep != 0 || messages_ == 0) return;
    progress_(std::min(1.0, static_cast<double>(done_) / static_cast<double>(messages_)));
  }

 private:
  const Share& progress_;
  const std::uint64_t messages_;
  std::uint64_t done_ = 0;
};

}  // namespace

Import::Import(io::ByteSink& sink, bool packed_messages)
    : writer_(sink, {.profile = "ros2"}), packed_messages_(packed_messages) {}

void Import::add(const fs::path& file, Form form, const std::string& name, const Share& progress) {
  unpack_limit_ = io::UnpackLimit(fs::file_size(file));
  if (form == Form::kBag || form == Form::kDb3) return add_indexed(file, form, name, progress);
  mcap::require_recording(io::FileSource(file), name);
  add_mcap(file, name, progress);
}

mcap::ChannelId Import::channel(const mcap::Schema& schema, mcap::Channel channel) {
  channel.schema_id = schema.name.empty() ? mcap::SchemaId{0} : writer_.add(schema);
  return writer_.add(std::move(channel));
}

void Import::write(mcap::Message message, const std::string& topic) {
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(message.data.data());
  const auto unpacked = unpacked_message({bytes, message.data.size()});
  if ((packed_messages_ && !unpacked) || (unpacked && !unpack_limit_.take(unpacked->size()))) {
    if (damages_.size() < kMaxDamages) note("a message of " + topic + " cannot be unpacked (zstd); it is left out");
    return;
  }
  if (unpacked) message.data = std::as_bytes(std::span(*unpacked));
  writer_.write(message);
}

void Import::add_mcap(const fs::path& file, const std::string& name, const Share& progress) {
  const io::FileSource source(file);
  mcap::IndexedReader reader(source);
  const auto& statistics = reader.summary().statistics;
  Steps steps(progress, statistics ? statistics->message_count : 0);
  std::map<mcap::ChannelId, mcap::ChannelId> ids;
  mcap::MessageCursor cursor = reader.messages();
  while (const mcap::Message* const message = cursor.next()) {
    const auto [id, first] = ids.try_emplace(message->channel_id, 0);
    if (first) {
      const auto schema = reader.summary().schemas.find(cursor.channel().schema_id);
      id->second =
          channel(schema == reader.summary().schemas.end() ? mcap::Schema{} : schema->second, cursor.channel());
    }
    mcap::Message copy = *message;
    copy.channel_id = id->second;
    write(copy, cursor.channel().topic);
    steps.step();
  }
  for (const mcap::Problem& problem : reader.problems().listed()) {
    if (mcap::is_damage(problem)) note(name + ", " + mcap::to_string(problem));
  }
}

void Import::add_indexed(const fs::path& file, Form form, const std::string& name, const Share& progress) {
  const std::unique_ptr<IndexedReader> reader = open_indexed(file, form);
  std::map<std::int64_t, mcap::ChannelId> ids;
  for (const auto& [id, stored] : reader->channels()) {
    ids[id] = channel({0, stored.type, stored.schema_encoding, stored.schema_text},
                      {0, 0, stored.topic, stored.encoding, stored.metadata});
  }
  const std::vector<std::string> of_file = reader->take_damages();
  std::uint32_t sequence = 0;
  const auto note_messages = [&] {
    for (const std::string& damage : reader->take_damages()) {
      if (form == Form::kBag) ++sequence;  // `rtd info` counts the gap as a lost message
      if (damages_.size() < kMaxDamages) note(name + ": " + damage);
    }
  };
  Steps steps(progress, reader->play_all());
  while (const std::optional<StoredMessage> stored = reader->next_stored()) {
    note_messages();
    const auto time = static_cast<mcap::Timestamp>(std::max<std::int64_t>(0, stored->recorded_ns));
    write({ids.at(stored->channel), ++sequence, time, time, std::as_bytes(stored->bytes)},
          reader->channels().at(stored->channel).topic);
    steps.step();
  }
  note_messages();
  for (const std::string& damage : of_file) note(damage);
}

}  // namespace rtd::recordings
