// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Whatever happens while a map is saved: the file is the old map or the new one.
#include "services/slam/map_file.hpp"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>

#include "tests/support/sample_map.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::slam {
namespace {

using test_support::sample_contents;
using test_support::sample_map;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class MapFileOnDisk : public ::testing::Test {
 protected:
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_.path()), {}));
  }
  static std::size_t keyframes_in(const std::filesystem::path& path) { return load_map_file(path).keyframes.size(); }

  const rtd::test::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "room.rtdmap";
};

TEST_F(MapFileOnDisk, is_replaced_as_a_whole) {
  const std::uint64_t bytes = save_map_file(path_, take_snapshot(sample_map({.keyframes = 5})));
  EXPECT_EQ(std::filesystem::file_size(path_), bytes);
  EXPECT_EQ(keyframes_in(path_), 4U);
  save_map_file(path_, take_snapshot(sample_map({.keyframes = 20})));
  EXPECT_EQ(keyframes_in(path_), 19U);
  EXPECT_EQ(files(), 1U);
}

/// No file may grow beyond `bytes`, as on a full disk; ends with the object.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::size_t bytes) : old_handler_(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    ::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
  sighandler_t old_handler_;
};

TEST_F(MapFileOnDisk, survives_a_disk_without_room_for_the_new_map) {
  save_map_file(path_, take_snapshot(sample_map({.keyframes = 5})));
  const MapSnapshot larger = take_snapshot(sample_map({.keyframes = 60, .features = 400}));
  for (const std::size_t limit : {0, 10, 4096, 200'000, 1'000'000}) {
    const FileSizeLimit full(limit);
    EXPECT_THAT([&] { save_map_file(path_, larger); },
                ThrowsMessage<io::IoError>(AllOf(HasSubstr("room.rtdmap: "), HasSubstr("larger"))));
    EXPECT_EQ(keyframes_in(path_), 4U) << "limit " << limit;
    EXPECT_EQ(files(), 1U);
  }
  save_map_file(path_, larger);
  EXPECT_EQ(keyframes_in(path_), 59U);
}

TEST_F(MapFileOnDisk, survives_a_kill_while_the_new_map_is_written) {
  save_map_file(path_, take_snapshot(sample_map({.keyframes = 5})));
  const MapSnapshot larger = take_snapshot(sample_map({.keyframes = 300, .features = 1000}));
  for (int round = 0; round < 6; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      while (true) save_map_file(path_, larger);
    }
    ::usleep(static_cast<useconds_t>(2000 + 7000 * round));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::size_t keyframes = keyframes_in(path_);
    EXPECT_TRUE(keyframes == 4 || keyframes == 299) << keyframes;
  }
  io::remove_unfinished(folder_);
  EXPECT_EQ(files(), 1U) << "what killed processes left is removed";
}

TEST_F(MapFileOnDisk, names_what_is_wrong_with_the_place) {
  const MapSnapshot snapshot = take_snapshot(sample_map());
  EXPECT_THAT([&] { save_map_file(folder_ / "none" / "room.rtdmap", snapshot); },
              ThrowsMessage<io::IoError>(AllOf(HasSubstr("none/room.rtdmap"), HasSubstr("no such folder"))));
  EXPECT_THAT([&] { load_map_file(path_); },
              ThrowsMessage<io::IoError>(AllOf(HasSubstr("room.rtdmap"), HasSubstr("No such file"))));
  std::ofstream(path_) << "not a map";
  EXPECT_THAT([&] { load_map_file(path_); },
              ThrowsMessage<MapFileError>(AllOf(HasSubstr("room.rtdmap"), HasSubstr("not a map file"))));
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// RTD_LARGE_MAP=10000: keyframes of 1250 features; asked is 10 s each.
TEST_F(MapFileOnDisk, saves_and_loads_a_large_map_in_time) {
  const char* asked = std::getenv("RTD_LARGE_MAP");
  const std::uint32_t keyframes = asked == nullptr ? 200 : static_cast<std::uint32_t>(std::atoi(asked));
  const Map map(sample_contents({keyframes, 1250, 350, 60}));
  auto start = std::chrono::steady_clock::now();
  const MapSnapshot snapshot = take_snapshot(map);
  const double copy_s = seconds_since(start);
  const std::uint64_t bytes = save_map_file(path_, snapshot);
  const double save_s = seconds_since(start);
  start = std::chrono::steady_clock::now();
  const Map loaded(load_map_file(path_));
  const double load_s = seconds_since(start);
  std::printf("%u keyframes, %zu landmarks: %.0f MB, copied in %.2f s, saved in %.2f s, loaded in %.2f s\n", keyframes,
              loaded.landmark_count(), static_cast<double>(bytes) * 1e-6, copy_s, save_s, load_s);
  EXPECT_EQ(loaded.landmark_count(), map.landmark_count());
  EXPECT_LT(save_s, 10);
  EXPECT_LT(load_s, 10);
}

}  // namespace
}  // namespace rtd::slam
