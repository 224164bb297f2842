// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Fast DDS's shared memory between processes.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/log/Log.hpp>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "common/bus/bus_factory.hpp"
#include "common/bus/host/ring_folder.hpp"
#include "common/bus/host/shm_leftovers.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/eventually.hpp"

namespace rtd::bus {
namespace {

using test_support::eventually;
using namespace std::chrono_literals;

/// The files of shared memory that only this process maps, with their locks.
std::set<std::string> shm_files_of(pid_t pid, const std::string& except) {
  std::set<std::string> files;
  std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t name = line.find("/dev/shm/");
    if (line.ends_with(" (deleted)")) continue;  // while a semaphore is made, its file has another name
    if (name != std::string::npos && except.find(line.substr(name)) == std::string::npos)
      files.insert(line.substr(name));
  }
  return files;
}

std::string maps_of(pid_t pid) {
  std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
  return {std::istreambuf_iterator<char>(maps), {}};
}

bool exists(const std::string& path) {
  return access(path.c_str(), F_OK) == 0;
}

TEST(FastddsProcesses, leftovers_of_a_killed_writer_are_cleaned_and_those_of_the_living_are_not) {
  // In another domain, so that it does not open what the first one has.
  PeerProcess killed("fastdds", "flood_frames", test_domain()), living("fastdds", "send_heartbeats", test_domain() + 1);
  const auto has_frames_in = [](pid_t pid) { return maps_of(pid).find("fast_datasharing") != std::string::npos; };
  const auto has_segment = [](pid_t pid) {
    const std::string maps = maps_of(pid);  // named by the version of Fast DDS
    return maps.find("fastrtps_port") != std::string::npos || maps.find("fastdds_port") != std::string::npos;
  };
  ASSERT_TRUE(eventually([&] { return has_frames_in(killed.pid()) && has_segment(killed.pid()); }));
  ASSERT_TRUE(eventually([&] { return has_segment(living.pid()); }));
  const auto doomed = shm_files_of(killed.pid(), maps_of(living.pid()));
  const auto needed = shm_files_of(living.pid(), {});
  ASSERT_GE(doomed.size(), 3U);  // segment, port, frames

  killed.kill_now();
  for (const std::string& file : doomed) EXPECT_TRUE(exists(file)) << file;
  EXPECT_TRUE(eventually([&] {
    remove_shm_leftovers();  // what each service does at its start; the files are too young at first
    return std::none_of(doomed.begin(), doomed.end(), exists);
  }));
  for (const std::string& file : needed) EXPECT_TRUE(exists(file)) << file;
}

/// Another process writes frames as fast as it can, with writers that come and go: one that opens its rings may end.
TEST(FastddsProcesses, a_strangers_rings_are_never_mapped_and_the_camera_of_the_run_is_received_meanwhile) {
  const RingsOfRun run;
  BusOptions options = options_of("fastdds");
  options.shared_memory = false;
  const auto beside = connect(options);
  options.shared_memory = true;
  options.rings = std::getenv(kRingsVariable);
  const auto bus = connect(options), camera_bus = connect(options);
  Collector<msg::RgbdFrame> frames;
  std::atomic<int> strangers{0}, strange_frames{0};
  auto camera = camera_bus->writer(topics::kFrame);
  const auto reader =
      bus->reader(topics::kFrame,
                  [&, id = camera.id()](const std::shared_ptr<const msg::RgbdFrame>& frame, const WriterId& writer) {
                    writer == id ? frames.push(frame) : void(++strange_frames);
                  });
  const auto open_reader = beside->reader(
      topics::kFrame, [&, id = camera.id()](const auto&, const WriterId& writer) { strangers += writer != id; });
  wait_matched(reader, camera);
  const PeerProcess stranger("fastdds", "churn_frames", test_domain());
  ASSERT_TRUE(eventually([&] { return strangers > 0; }));
  constexpr int kFrames = 200;
  int received = 0;
  for (int seq = 0; seq < kFrames; ++seq) {
    auto frame = camera.loan();
    fill_frame(*frame, static_cast<std::uint64_t>(seq));
    camera.write(std::move(frame));
    if (frames.try_next(200ms)) ++received;
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_GE(received, 0.95 * kFrames) << "beside " << strangers << " frames of the stranger";
  EXPECT_EQ(strange_frames, 0) << "readers of a run have its rings alone";
  std::istringstream maps(maps_of(getpid()));
  for (std::string line; std::getline(maps, line);) {
    const bool is_ring = line.find("fast_datasharing") != std::string::npos;
    EXPECT_TRUE(!is_ring || line.find(options.rings + '/') != std::string::npos) << line;
  }
}

/// Output and exit code of bus_peer in a mount namespace whose /dev/shm holds `size`; exit code 77: not permitted here.
std::pair<std::string, int> run_with_small_shm(const std::string& size) {
  const std::string inner = "mount -t tmpfs -o size=" + size +
                            " tmpfs /dev/shm || exit 77; exec timeout 5 " BUS_PEER_PATH " fastdds send_heartbeats " +
                            std::to_string(test_domain());
  FILE* pipe = popen(("unshare --user --map-root-user --mount sh -c '" + inner + "' 2>&1 || exit $?").c_str(), "r");
  if (pipe == nullptr) return {"", 77};
  std::string output;
  char line[512];
  while (fgets(line, sizeof(line), pipe) != nullptr) output += line;
  const int status = pclose(pipe);
  return {output, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

TEST(FastddsProcesses, too_small_shared_memory_ends_with_the_fix_instead_of_a_bus_error) {
  const auto [output, code] = run_with_small_shm("8m");
  if (code == 77 || output.find("unshare") != std::string::npos) GTEST_SKIP() << "no mount namespaces here: " << output;
  EXPECT_EQ(code, 2);
  EXPECT_NE(output.find("/dev/shm is too small: 8 MiB free"), std::string::npos) << output;
  EXPECT_NE(output.find("remount,size="), std::string::npos) << output;
}

/// Counts what Fast DDS says of messages that it cannot read.
class UnreadableMessages : public eprosima::fastdds::dds::LogConsumer {
 public:
  explicit UnreadableMessages(std::shared_ptr<std::atomic<int>> count) : count_(std::move(count)) {}
  void Consume(const eprosima::fastdds::dds::Log::Entry& entry) override {
    if (std::string(entry.context.category) == "RTPS_MSG_IN") ++*count_;
  }

 private:
  std::shared_ptr<std::atomic<int>> count_;
};

TEST(FastddsProcesses, messages_in_shared_memory_end_where_they_were_written) {
  using eprosima::fastdds::dds::Log;
  const auto bus = connect_to("fastdds");
  const auto unreadable = std::make_shared<std::atomic<int>>(0);
  Log::RegisterConsumer(std::make_unique<UnreadableMessages>(unreadable));
  Log::SetVerbosity(Log::Kind::Warning);
  Collector<msg::RgbdFrame> frames;
  const auto reader = bus->reader(topics::kFrame, frames.callback());
  auto go = bus->writer(topics::kTracking);
  const PeerProcess peer("fastdds", "send_frames", test_domain(), 60);
  wait_matched(reader, go);
  go.write(msg::TrackingResult{});
  for (int frame = 0; frame < 60; ++frame) frames.next();
  Log::Flush();
  Log::SetVerbosity(Log::Kind::Error);
  EXPECT_EQ(*unreadable, 0);
}

TEST(FastddsLog, is_text_without_colours) {
  using eprosima::fastdds::dds::Log;
  const auto bus = connect_to("fastdds");
  ::testing::internal::CaptureStderr();
  EPROSIMA_LOG_ERROR(TEST, "of a \033[31mpeer");
  Log::Flush();
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "Fast DDS: TEST: of a \\x1b[31mpeer\n");
}

TEST(FastddsOptions, refuse_a_segment_that_no_image_fits_in) {
  BusOptions options = options_of("fastdds");
  options.shm_segment_mib = 1;
  EXPECT_THROW(connect(options), BusError);
}
}  // namespace
}  // namespace rtd::bus
