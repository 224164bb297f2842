// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

struct sqlite3;

namespace rtd::rosbag2 {

/// A file cannot be read; what() names it and the cause.
class Db3Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Db3Topic {
  std::string name, type, serialization_format;
  std::uint64_t messages = 0;
  std::string offered_qos;                      ///< YAML of its writers; empty where the version has none
  std::string definition_encoding, definition;  ///< of its type, "ros2msg" or "ros2idl"; empty before version 4
};

/// One message in the file.
struct Db3Place {
  std::int64_t time_ns = 0;  ///< when it was recorded
  std::int64_t topic = 0, row = 0;
};

/// Reads a rosbag2 file of the storage plugin sqlite3, all versions of its schema: of the tables `topics` and
/// `messages` only the columns that they share are required. The file is never written; a file that was not closed is
/// read with the -wal next to it. Memory and time are bounded by the size of the file. Not thread-safe.
class Db3Reader {
 public:
  /// Throws Db3Error: unreadable, no SQLite file, without these tables. Damage further on is listed by damages().
  explicit Db3Reader(const std::filesystem::path& path);

  /// By the id that Db3Place gives.
  const std::map<std::int64_t, Db3Topic>& topics() const { return topics_; }
  /// The messages of these topics, oldest first; at one time in the order of the file.
  std::vector<Db3Place> messages(const std::vector<std::string>& topics);
  /// Each message at most once after messages(). Throws Db3Error when it is damaged.
  std::vector<std::uint8_t> read(const Db3Place& place);
  /// What could not be used, one line each; empty for a sound file.
  const std::vector<std::string>& damages() const { return damages_; }

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };

  /// Of the progress handler.
  struct Work {
    sqlite3* database = nullptr;
    std::uint64_t steps_left = 0;
  };

  static int count_step(void* reader);
  void open();
  void bound();
  void require_tables();
  void read_topics();
  void read_extras();
  void read_places();
  void take(std::size_t bytes);
  [[noreturn]] void fail(const std::string& what) const;

  const std::filesystem::path path_;
  std::uint64_t bytes_ = 0;   ///< of the file and its -wal
  std::uint64_t unread_ = 0;  ///< of them, by the query in work: rows do not overlap
  Work work_;
  std::unique_ptr<sqlite3, Close> database_;
  std::map<std::int64_t, Db3Topic> topics_;
  std::vector<Db3Place> places_;
  std::vector<std::string> damages_;
};

}  // namespace rtd::rosbag2
