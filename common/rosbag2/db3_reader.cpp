// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/rosbag2/db3_reader.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cerrno>
#include <set>
#include <tuple>
#include <utility>

#include "common/io/byte_sink.hpp"
#include "common/io/byte_source.hpp"

namespace rtd::rosbag2 {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxMessageBytes = 256ULL << 20;
constexpr std::int64_t kMaxHeapBytes = 1LL << 30;  // SQLite's own, of the whole process
constexpr std::size_t kMaxTopics = 10'000, kLongestName = 255;
constexpr std::uint64_t kRowBytes = 8;            // at least
constexpr std::size_t kMostDescribed = 16 << 20;  // of definitions: topics of one type have copies of it
constexpr int kStepInstructions = 1000;           // of SQLite's machine between two calls of the progress handler

/// Bytes of a file next to a database; 0: there is none. Throws Db3Error for what is not a regular file, which SQLite
/// would wait for.
std::uint64_t size_beside(const fs::path& path, const char* suffix) {
  try {
    return io::FileSource(path.string() + suffix, io::Links::kRefuse).size();
  } catch (const io::IoError& error) {
    if (error.code().value() == ENOENT) return 0;
    throw Db3Error(error.what());
  }
}

/// Without a log next to it the file is complete in itself: "immutable" reads it without locks, so also in a folder
/// that is read-only.
std::string uri_of(const fs::path& path) {
  std::string uri = "file:";
  for (const char c : fs::absolute(path).string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += c == '%' ? "%25" : c == '?' ? "%3f" : "%23";
    } else {
      uri += c;
    }
  }
  bool complete = true;
  for (const char* suffix : {"-wal", "-journal"}) complete = size_beside(path, suffix) == 0 && complete;
  return uri + (complete ? "?mode=ro&immutable=1" : "?mode=ro");
}

class Statement {
 public:
  /// Null inside when SQLite refuses the text.
  Statement(sqlite3* database, const char* sql) { sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr); }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  bool usable() const { return statement_ != nullptr; }
  void bind(int index, std::int64_t value) { sqlite3_bind_int64(statement_, index, value); }
  int step() { return sqlite3_step(statement_); }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  int type(int column) const { return sqlite3_column_type(statement_, column); }
  std::vector<std::uint8_t> bytes(int column) const {
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
    const int size = sqlite3_column_bytes(statement_, column);
    return data == nullptr ? std::vector<std::uint8_t>{} : std::vector<std::uint8_t>(data, data + size);
  }
  std::string text(int column) const {
    const std::vector<std::uint8_t> content = bytes(column);
    return {content.begin(), content.end()};
  }

 private:
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace

/// The SQLite progress handler: ends a query that a crafted file keeps busy. Rows may share long chains of pages.
int Db3Reader::count_step(void* reader) {
  constexpr int kPagesOfStep = 100;
  auto& [database, left] = static_cast<Db3Reader*>(reader)->work_;
  int found = 0, read = 0, ignored = 0;
  sqlite3_db_status(database, SQLITE_DBSTATUS_CACHE_HIT, &found, &ignored, 1);
  sqlite3_db_status(database, SQLITE_DBSTATUS_CACHE_MISS, &read, &ignored, 1);
  const auto steps = static_cast<std::uint64_t>(1 + (found + read) / kPagesOfStep);
  left -= std::min(left, steps);
  return left == 0 ? 1 : 0;
}

void Db3Reader::Close::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

Db3Reader::Db3Reader(const fs::path& path) : path_(path) {
  open();
  bound();
  require_tables();
  read_topics();
  read_extras();
  read_places();
}

void Db3Reader::fail(const std::string& what) const {
  throw Db3Error(path_.string() + ": " + what);
}

void Db3Reader::open() {
  try {
    bytes_ = io::FileSource(path_).size() + size_beside(path_, "-wal");
  } catch (const io::IoError& error) {
    throw Db3Error(error.what());
  }
  if (bytes_ == 0) fail("the file is empty");
  sqlite3* database = nullptr;
  const int opened = sqlite3_open_v2(uri_of(path_).c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  database_.reset(database);
  if (opened != SQLITE_OK) fail(std::string("cannot be opened: ") + sqlite3_errstr(opened));
}

void Db3Reader::bound() {
  sqlite3* database = database_.get();
  sqlite3_hard_heap_limit64(kMaxHeapBytes);
  const std::uint64_t longest = std::clamp<std::uint64_t>(bytes_, 1U << 20, kMaxMessageBytes);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(longest));
  sqlite3_limit(database, SQLITE_LIMIT_ATTACHED, 0);
  sqlite3_limit(database, SQLITE_LIMIT_TRIGGER_DEPTH, 0);
  sqlite3_db_config(database, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);  // else a cut file is refused whole
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_exec(database, "PRAGMA query_only=1; PRAGMA cell_size_check=1; PRAGMA mmap_size=0", nullptr, nullptr,
               nullptr);
  work_ = {database, 10'000 + bytes_ / 100};  // a row takes 20 instructions
  sqlite3_progress_handler(database, kStepInstructions, count_step, this);
}

void Db3Reader::require_tables() {
  Statement tables(database_.get(),
                   "SELECT count(*) FROM sqlite_schema WHERE name IN ('topics', 'messages') AND type = 'table' AND "
                   "sql LIKE 'CREATE TABLE%'");
  if (!tables.usable() || tables.step() != SQLITE_ROW)
    fail(std::string("no readable SQLite file: ") + sqlite3_errmsg(database_.get()));
  if (tables.integer(0) != 2)
    fail("an SQLite file, but no rosbag2 recording: it lacks the table 'topics' or 'messages'");
  Statement computed(database_.get(),
                     "SELECT (SELECT count(*) FROM pragma_table_xinfo('topics') WHERE hidden) + "
                     "(SELECT count(*) FROM pragma_table_xinfo('messages') WHERE hidden) + "
                     "(SELECT count(*) FROM pragma_table_xinfo('message_definitions') WHERE hidden)");
  if (!computed.usable() || computed.step() != SQLITE_ROW || computed.integer(0) != 0)
    fail("no rosbag2 recording: it has columns that are computed");
}

/// Of what a row holds. Those of a crafted file may hold the same bytes, all of it each.
void Db3Reader::take(std::size_t bytes) {
  const bool overlaps = bytes >= unread_;
  unread_ -= std::min<std::uint64_t>(bytes, unread_);
  if (overlaps) fail("its rows hold more than the file: they overlap");
}

void Db3Reader::read_topics() {
  Statement rows(database_.get(), "SELECT id, name, type, serialization_format FROM topics NOT INDEXED");
  if (!rows.usable()) fail(std::string("no rosbag2 recording: ") + sqlite3_errmsg(database_.get()));
  unread_ = bytes_;
  int result = rows.step();
  for (; result == SQLITE_ROW && topics_.size() < kMaxTopics; result = rows.step()) {
    const Db3Topic topic{rows.text(1), rows.text(2), rows.text(3), 0, {}, {}, {}};
    take(topic.name.size() + topic.type.size() + topic.serialization_format.size());
    if (std::max(topic.name.size(), topic.type.size()) <= kLongestName) topics_[rows.integer(0)] = topic;
  }
  if (result == SQLITE_ROW) fail("has more than " + std::to_string(kMaxTopics) + " topics");
  if (result != SQLITE_DONE) fail(std::string("its topics cannot be read: ") + sqlite3_errmsg(database_.get()));
}

/// Of columns and tables that not every version has: a query that one lacks is not usable.
void Db3Reader::read_extras() {
  unread_ = bytes_;
  Statement qos(database_.get(), "SELECT id, offered_qos_profiles FROM topics NOT INDEXED");
  while (qos.usable() && qos.step() == SQLITE_ROW) {
    const std::string profiles = qos.text(1);
    take(profiles.size());
    if (const auto topic = topics_.find(qos.integer(0)); topic != topics_.end()) topic->second.offered_qos = profiles;
  }
  Statement types(database_.get(),
                  "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions NOT INDEXED");
  std::map<std::string, std::pair<std::string, std::string>> definitions;
  while (types.usable() && types.step() == SQLITE_ROW) {
    auto& [encoding, text] = definitions[types.text(0)] = {types.text(1), types.text(2)};
    take(encoding.size() + text.size());
  }
  std::size_t described_bytes = 0;
  for (auto& [id, topic] : topics_) {
    const auto found = definitions.find(topic.type);
    if (found == definitions.end() || (described_bytes += found->second.second.size()) > kMostDescribed) continue;
    std::tie(topic.definition_encoding, topic.definition) = found->second;
  }
}

// The index on `timestamp` is not used: older versions lack it, and a damaged one would hide messages.
void Db3Reader::read_places() {
  Statement rows(database_.get(), "SELECT timestamp, topic_id, rowid FROM messages NOT INDEXED");
  if (!rows.usable()) fail(std::string("no rosbag2 recording: ") + sqlite3_errmsg(database_.get()));
  std::uint64_t strays = 0;
  int result = rows.step();
  for (const std::uint64_t most = bytes_ / kRowBytes; result == SQLITE_ROW && places_.size() < most;
       result = rows.step()) {
    const auto topic = topics_.find(rows.integer(1));
    if (topic == topics_.end()) {
      ++strays;
      continue;
    }
    ++topic->second.messages;
    places_.push_back({rows.integer(0), topic->first, rows.integer(2)});
  }
  if (result != SQLITE_DONE) {
    damages_.push_back(path_.string() + ": damaged after " + std::to_string(places_.size()) + " messages: " +
                       (result == SQLITE_ROW ? "more rows than bytes" : sqlite3_errmsg(database_.get())) +
                       "; what follows is lost");
  }
  if (strays != 0)
    damages_.push_back(path_.string() + ": " + std::to_string(strays) + " messages belong to no topic of the file");
  std::ranges::stable_sort(places_, {}, &Db3Place::time_ns);
}

std::vector<Db3Place> Db3Reader::messages(const std::vector<std::string>& topics) {
  unread_ = bytes_;
  const std::set<std::string> names(topics.begin(), topics.end());
  std::set<std::int64_t> wanted;
  for (const auto& [id, topic] : topics_) {
    if (names.contains(topic.name)) wanted.insert(id);
  }
  std::vector<Db3Place> found;
  std::ranges::copy_if(places_, std::back_inserter(found), [&](const auto& p) { return wanted.contains(p.topic); });
  return found;
}

std::vector<std::uint8_t> Db3Reader::read(const Db3Place& place) {
  take(0);
  work_.steps_left = 10'000;
  Statement row(database_.get(), "SELECT data FROM messages WHERE rowid = ?");
  row.bind(1, place.row);
  if (row.step() != SQLITE_ROW || row.type(0) != SQLITE_BLOB) {
    fail("message " + std::to_string(place.row) + " of " + topics_.at(place.topic).name +
         " is damaged: " + sqlite3_errmsg(database_.get()));
  }
  std::vector<std::uint8_t> data = row.bytes(0);
  take(data.size());
  return data;
}

}  // namespace rtd::rosbag2
