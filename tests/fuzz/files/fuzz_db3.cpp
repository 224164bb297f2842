// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed sqlite3 files of rosbag2: no exception but Db3Error.
#include <sqlite3.h>

#include <filesystem>
#include <stdexcept>

#include "common/rosbag2/db3_reader.hpp"
#include "tests/fuzz/fuzz_loop.hpp"

namespace rtd::rosbag2 {
namespace {

namespace fs = std::filesystem;

constexpr char kTopics[] =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT "
    "NULL,offered_qos_profiles TEXT NOT NULL);"
    "INSERT INTO topics VALUES(1,'/a','std_msgs/msg/A','cdr',''),(2,'/b','std_msgs/msg/B','cdr','');";
constexpr char kMessages[] =
    "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT "
    "NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
    "INSERT INTO messages(topic_id,timestamp,data) VALUES(1,3,zeroblob(9000)),(2,1,x'00010203'),(1,2,x'07'),(1,4,x'');";
constexpr char kNewer[] =
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);"
    "INSERT INTO schema VALUES(4,'jazzy');";

io::Bytes sample(const fs::path& path, const std::string& statements) {
  fs::remove(path);
  sqlite3* database = nullptr;
  const bool made = sqlite3_open(path.c_str(), &database) == SQLITE_OK &&
                    sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
  sqlite3_close(database);
  if (!made) throw std::runtime_error("SQLite cannot write " + path.string());
  return fuzz::bytes_of(rtd::test::read_text(path));
}

std::vector<io::Bytes> seeds(const fs::path& path) {
  return {sample(path, std::string("PRAGMA page_size=512;") + kTopics + kMessages),
          sample(path, std::string(kNewer) + kTopics + kMessages),
          sample(path, std::string("PRAGMA page_size=1024;") + kTopics +
                           "CREATE VIEW messages AS SELECT 1 AS id,1 AS topic_id,1 AS timestamp,x'00' AS data;")};
}

std::string try_input(const fuzz::FuzzFile& file, const io::Bytes& input, std::uint64_t& read) {
  file.write(input);
  try {
    Db3Reader reader(file.path());
    for (const Db3Place& place : reader.messages({"/a", "/b"})) {
      try {
        read += reader.read(place).size();
      } catch (const Db3Error&) {
      }
    }
  } catch (const Db3Error&) {
  }
  return "";
}

}  // namespace
}  // namespace rtd::rosbag2

int main(int argc, char** argv) {
  using namespace rtd;
  const fuzz::FuzzFile file(".db3");
  const std::vector<io::Bytes> files = rosbag2::seeds(file.path());
  std::uint64_t read = 0;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_db3_failed.db3",
       .make = [&](fuzz::Random& random) { return fuzz::mutate_one(files, random); },
       .test = [&](const io::Bytes& input, fuzz::Random&) { return rosbag2::try_input(file, input, read); },
       .counted = [&] { return "bytes read " + std::to_string(read); },
       .max_allocated = 32 << 20});  // SQLite's cache, and a message of 1 MiB a few times
}
