// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/definitions.hpp"

namespace rtd::mcap {

template <class Id, class R>
bool Definitions::keep(std::map<Id, R>& known, const R& record, const char* kind, std::uint64_t offset) {
  const auto [entry, added] = known.try_emplace(record.id, record);
  if (added || entry->second == record) return true;
  problems_.add_repeated({ProblemKind::kConflictingDefinition, offset,
                          std::string(kind) + ' ' + std::to_string(record.id) + " is defined twice, differently",
                          "the first definition counts"});
  return false;
}

bool Definitions::accept(const Schema& schema, std::uint64_t offset) {
  if (schema.id != 0) return keep(schemas_, schema, "Schema", offset);
  problems_.add_repeated({ProblemKind::kDamagedRecord, offset, "Schema: the id 0 means \"no schema\"",
                          "it is ignored, as the format asks"});
  return false;
}

bool Definitions::accept(const Channel& channel, std::uint64_t offset) {
  if (channel.schema_id != 0 && !schemas_.contains(channel.schema_id))
    problems_.add_repeated({ProblemKind::kMissingSchema, offset,
                            "Channel \"" + channel.topic + "\": its schema " + std::to_string(channel.schema_id) +
                                " is not in the file before it",
                            "its messages are delivered, but cannot be decoded without knowing their type"});
  return keep(channels_, channel, "Channel", offset);
}

bool Definitions::accept(const Message& message, std::uint64_t offset) {
  if (channels_.contains(message.channel_id)) return true;
  problems_.add_repeated(
      {ProblemKind::kMissingChannel, offset,
       "Message: its channel " + std::to_string(message.channel_id) + " is not in the file before it",
       "the messages of this channel are left out: their topic is not known", true});
  return false;
}

}  // namespace rtd::mcap
