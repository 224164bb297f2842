// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/rosbag1/bag_reader.hpp"

#include <algorithm>
#include <set>

namespace rtd::rosbag1 {
namespace {

constexpr std::uint64_t kLoadedBytes = 128 << 20;  // of chunks: neighbours overlap in time
constexpr std::size_t kLongestName = 255;          // each message would repeat it
constexpr std::uint64_t kMostDescribed = 16 << 20;
constexpr std::size_t kMaxDamages = 100;

/// A record inside a chunk.
struct InnerRecord {
  std::size_t begin = 0;
  RecordHeader header;
  Bytes data;
};

InnerRecord next_record(ros::ByteCursor& cursor) {
  const std::size_t begin = cursor.position();
  RecordHeader header(cursor.take(cursor.read<std::uint32_t>()));
  const Bytes data = cursor.take(cursor.read<std::uint32_t>());
  return {begin, std::move(header), data};
}

}  // namespace

BagReader::BagReader(const std::filesystem::path& path) : file_(path), unpack_limit_(file_.size()) {
  walk();
  search_unindexed();
  const auto older = [](const MessagePlace& a, const MessagePlace& b) { return a.time_ns < b.time_ns; };
  std::stable_sort(messages_.begin(), messages_.end(), older);
}

void BagReader::walk() {
  std::uint64_t position = file_.first_record();
  try {
    check_bag_header(RecordHeader(file_.record_at(position).header));
  } catch (const ros::WireError& error) {
    throw BagError(file_.path().string() + ": its first record is damaged: " + error.what());
  }
  try {
    while (position < file_.size()) {
      const RecordPlace place = file_.record_at(position);
      take_noting(place);
      position = place.end();
    }
  } catch (const BagError& error) {
    note(std::string(error.what()) + "; what follows is lost");
  }
  if (!complete_ && !chunks_.empty()) distrust_index();
}

/// A record that is damaged inside does not keep from the next.
void BagReader::take_noting(const RecordPlace& place) {
  try {
    take(place);
  } catch (const ros::WireError& error) {
    note(file_.path().string() + ", record before byte " + std::to_string(place.data_begin) + ": " + error.what());
  }
}

void BagReader::check_bag_header(const RecordHeader& header) const {
  if (header.op() != Op::kBagHeader) throw ros::WireError("it is not a bag header");
  if (const std::string encryptor = header.text("encryptor"); !encryptor.empty() && encryptor != "rosbag/NoEncryptor") {
    throw BagError(file_.path().string() + " is encrypted (" + encryptor + "); decrypt it with: rosbag decrypt FILE");
  }
}

void BagReader::take(const RecordPlace& place) {
  const RecordHeader header(place.header);
  const auto op = header.op();
  if (op == Op::kBagHeader) indexed_ = header.number<std::uint64_t>("index_pos") != 0;
  if (op == Op::kChunk || op == Op::kConnection) complete_ = op == Op::kConnection;
  if (op == Op::kChunk) {
    chunks_.push_back(
        {place.data_begin, place.data_bytes, header.number<std::uint32_t>("size"), header.text("compression")});
    Chunk& chunk = chunks_.back();
    chunk.refused = chunk.size > kMaxChunkBytes || !unpack_limit_.take(chunk.size);
    unpacked_bytes_ += chunk.refused ? 0 : chunk.size;
  }
  if (op != Op::kIndex && op != Op::kConnection) return;
  const std::vector<std::uint8_t> data = file_.read(place.data_begin, place.data_bytes);
  if (op == Op::kConnection) return take_connection(header, data);
  if (chunks_.empty()) throw ros::WireError("an index precedes the first chunk");
  try {
    take_index(header, data);
  } catch (const ros::WireError&) {
    distrust_index();
    throw;
  }
}

/// The index records of a chunk follow it, one for each connection.
void BagReader::take_index(const RecordHeader& header, Bytes entries) {
  constexpr std::size_t kEntryBytes = 12;
  const auto connection = header.number<std::uint32_t>("conn"), count = header.number<std::uint32_t>("count");
  if (header.number<std::uint32_t>("ver") != 1 || entries.size() != count * kEntryBytes) {
    throw ros::WireError("an index of " + std::to_string(count) + " messages has " + std::to_string(entries.size()) +
                         " bytes");
  }
  if (chunks_.back().index == Index::kDamaged) return;
  chunks_.back().index = Index::kSound;
  ros::ByteCursor cursor(entries);
  while (cursor.remaining() > 0) {
    const std::int64_t time_ns = read_time_ns(cursor);
    messages_.push_back({time_ns, connection, last_chunk(), cursor.read<std::uint32_t>()});
  }
}

/// The last chunk will be searched instead.
void BagReader::distrust_index() {
  chunks_.back().index = Index::kDamaged;
  std::erase_if(messages_, [chunk = last_chunk()](const MessagePlace& message) { return message.chunk == chunk; });
}

/// Topic and type are in the record's data, which is itself a list of fields.
void BagReader::take_connection(const RecordHeader& header, Bytes data) {
  const RecordHeader fields(data);
  const std::string mapped = header.text("topic");
  Connection connection{mapped.empty() ? fields.text("topic") : mapped, fields.text("type"), fields.text("md5sum"),
                        fields.text("message_definition")};
  if (std::max(connection.topic.size(), connection.type.size()) > kLongestName)
    throw ros::WireError("a topic or its type has a name of more than 255 bytes");
  if ((described_bytes_ += connection.definition.size()) > kMostDescribed) connection.definition.clear();
  connections_[header.number<std::uint32_t>("conn")] = std::move(connection);
}

/// Chunks without index for their messages; and, when the end of the file is missing, those that hold the description
/// of a connection.
void BagReader::search_unindexed() {
  std::set<std::uint32_t> described, unknown;
  for (const MessagePlace& message : messages_) {
    if (connections_.count(message.connection) == 0 && unknown.insert(message.connection).second) {
      described.insert(message.chunk);
    }
  }
  for (std::uint32_t chunk = 0; chunk < chunks_.size(); ++chunk) {
    const bool messages = chunks_[chunk].index != Index::kSound;
    if (messages || described.count(chunk) != 0) search(chunk, messages);
  }
}

void BagReader::search(std::uint32_t chunk, bool messages) {
  try {
    ros::ByteCursor cursor(load(chunk));
    while (cursor.remaining() > 0) {
      const InnerRecord record = next_record(cursor);
      if (record.header.op() == Op::kConnection) take_connection(record.header, record.data);
      if (messages && record.header.op() == Op::kMessage) {
        messages_.push_back({record.header.time_ns("time"), record.header.number<std::uint32_t>("conn"), chunk,
                             static_cast<std::uint32_t>(record.begin)});
      }
    }
  } catch (const BagError& error) {
    note(error.what());
  } catch (const ros::WireError& error) {
    note(file_.path().string() + ", chunk at byte " + std::to_string(chunks_[chunk].begin) + ": " + error.what());
  }
}

std::vector<Topic> BagReader::topics() const {
  std::map<std::uint32_t, std::uint64_t> messages;
  for (const MessagePlace& message : messages_) ++messages[message.connection];
  std::map<std::string, Topic> topics;
  for (const auto& [id, connection] : connections_) {
    const auto topic = topics.try_emplace(connection.topic, Topic{connection.topic, connection.type, 0}).first;
    topic->second.messages += messages[id];
  }
  std::vector<Topic> sorted;
  for (const auto& [name, topic] : topics) sorted.push_back(topic);
  return sorted;
}

std::vector<MessagePlace> BagReader::messages(const std::vector<std::string>& topics) {
  unread_bytes_ = unpacked_bytes_;
  const std::set<std::string> names(topics.begin(), topics.end());
  std::set<std::uint32_t> wanted;
  for (const auto& [id, connection] : connections_) {
    if (names.contains(connection.topic)) wanted.insert(id);
  }
  std::vector<MessagePlace> chosen;
  std::copy_if(messages_.begin(), messages_.end(), std::back_inserter(chosen),
               [&](const MessagePlace& message) { return wanted.count(message.connection) != 0; });
  return chosen;
}

Bytes BagReader::read(const MessagePlace& message) {
  const auto fail = [&](const std::string& cause) {
    return BagError(file_.path().string() + ", chunk at byte " + std::to_string(chunks_.at(message.chunk).begin) +
                    ", message at byte " + std::to_string(message.offset) + " in it: " + cause);
  };
  try {
    ros::ByteCursor cursor(load(message.chunk));
    cursor.take(message.offset);
    take_unread(ros::ByteCursor(cursor).read<std::uint32_t>());
    const InnerRecord record = next_record(cursor);
    if (record.header.op() != Op::kMessage || record.header.number<std::uint32_t>("conn") != message.connection) {
      throw ros::WireError("the index is wrong, there is another record");
    }
    take_unread(record.data.size());
    return record.data;
  } catch (const ros::WireError& error) {
    throw fail(error.what());
  }
}

void BagReader::take_unread(std::uint64_t bytes) {
  if (bytes > unread_bytes_) throw ros::WireError("the index is wrong, its messages overlap");
  unread_bytes_ -= bytes;
}

const std::vector<std::uint8_t>& BagReader::load(std::uint32_t chunk) {
  if (const auto loaded = loaded_.find(chunk); loaded != loaded_.end()) return loaded->second;
  const Chunk& wanted = chunks_.at(chunk);
  if (wanted.refused)
    throw ros::WireError("a chunk claims " + std::to_string(wanted.size) + " bytes, too many for the size of the bag");
  std::vector<std::uint8_t> content =
      decompress(wanted.compression, file_.read(wanted.begin, wanted.bytes), wanted.size);
  for (loaded_bytes_ += content.size(); loaded_bytes_ > kLoadedBytes && !loaded_.empty(); loading_order_.pop_front()) {
    const auto oldest = loaded_.find(loading_order_.front());
    loaded_bytes_ -= oldest->second.size();
    loaded_.erase(oldest);
  }
  loading_order_.push_back(chunk);
  return loaded_[chunk] = std::move(content);
}

void BagReader::note(const std::string& damage) {
  if (damages_.size() < kMaxDamages) damages_.push_back(damage);
}

}  // namespace rtd::rosbag1
