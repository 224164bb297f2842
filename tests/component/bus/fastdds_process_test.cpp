// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Between processes: shared memory, data sharing and a peer that dies.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "common/bus/bus_factory.hpp"
#include "common/bus/shm_leftovers.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<Bus> connect_fastdds() {
  BusOptions options;
  options.domain = test_domain();
  options.participant_name = "bus-test";
  return connect(options);
}

TEST(FastddsProcesses, frames_arrive_whole_and_in_order) {
  constexpr std::uint64_t kFrames = 60;
  const auto bus = connect_fastdds();
  Collector<msg::RgbdFrame> frames;
  const auto reader = bus->reader(topics::kFrame, frames.callback());
  auto go = bus->writer(topics::kTracking);
  const PeerProcess peer("send_frames", test_domain(), kFrames);
  while (reader.matched() == 0 || go.matched() == 0) std::this_thread::sleep_for(1ms);
  go.write(msg::TrackingResult{});

  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const auto frame = frames.next();
    ASSERT_EQ(frame->seq, seq);
    ASSERT_TRUE(equals_pattern(*frame)) << "frame " << seq;
  }
}

TEST(FastddsProcesses, no_torn_frame_is_ever_delivered) {
  const auto bus = connect_fastdds();
  std::atomic<int> delivered{0}, torn{0};
  const auto reader = bus->reader(topics::kFrame, [&](std::shared_ptr<const msg::RgbdFrame> frame) {
    if (!equals_pattern(*frame)) ++torn;
    ++delivered;
    std::this_thread::sleep_for(3ms);  // slower than the writer: samples are overwritten while they are taken
  });
  const PeerProcess peer("flood_frames", test_domain());

  for (int i = 0; i < 10'000 && delivered < 200; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_GE(delivered, 20);
  EXPECT_EQ(torn, 0);
}

TEST(FastddsProcesses, nothing_is_lost_with_three_feature_frames_in_flight) {
  constexpr std::uint64_t kMessages = 2000, kWindow = 3;
  const auto bus = connect_fastdds();
  Collector<msg::TrackingResult> results;
  const auto reader = bus->reader(topics::kTracking, results.callback());
  auto writer = bus->writer(topics::kFeatures);
  const PeerProcess peer("answer_features", test_domain());
  while (writer.matched() == 0 || reader.matched() == 0) std::this_thread::sleep_for(1ms);

  auto features = std::make_unique<msg::FeatureFrame>();
  std::uint64_t sent = 0;
  for (std::uint64_t answered = 0; answered < kMessages; ++answered) {
    for (; sent < kMessages && sent < answered + kWindow; ++sent) {
      fill_features(*features, sent);
      ASSERT_TRUE(writer.write(*features));
    }
    const auto result = results.next();
    ASSERT_EQ(result->seq, answered);
    ASSERT_EQ(result->inliers, 1U) << "features " << answered << " arrived changed";
  }
}

/// The writer's shared memory has five slots: one that gets lost now and then ends the stream.
TEST(FastddsProcesses, two_readers_get_every_frame_of_a_long_stream) {
  constexpr std::uint64_t kFrames = 2000, kWindow = 3;
  const auto bus = connect_fastdds();
  Collector<msg::TrackingResult> results;
  const auto reader = bus->reader(topics::kTracking, results.callback());
  auto writer = bus->writer(topics::kFrame);
  const PeerProcess filter("answer_frames", test_domain(), 1), detector("answer_frames", test_domain(), 2);
  while (writer.matched() < 2 || reader.matched() < 2) std::this_thread::sleep_for(1ms);

  std::map<std::uint32_t, std::uint64_t> answered;  // by the peer's number
  const auto answered_by_both = [&] {
    return answered.size() < 2 ? 0 : std::min(answered.begin()->second, answered.rbegin()->second);
  };
  std::uint64_t sent = 0;
  while (answered_by_both() < kFrames) {
    for (; sent < kFrames && sent < answered_by_both() + kWindow; ++sent) {
      auto frame = writer.loan();
      fill_frame(*frame, sent);
      ASSERT_TRUE(writer.write(std::move(frame))) << "frame " << sent;
    }
    const auto result = results.next();
    ASSERT_EQ(result->seq, answered[result->landmarks]++);
    ASSERT_EQ(result->inliers, 1U);
  }
}

TEST(FastddsProcesses, late_reader_gets_keyframes_and_camera_info) {
  const PeerProcess peer("leave_history", test_domain(), 40);
  std::this_thread::sleep_for(300ms);  // not needed to pass, but makes sure that the reader is late
  const auto bus = connect_fastdds();
  Collector<msg::KeyframeEvent> keyframes;
  Collector<msg::CameraInfo> info;
  const auto keyframe_reader = bus->reader(topics::kKeyframes, keyframes.callback());
  const auto info_reader = bus->reader(topics::kCameraInfo, info.callback());

  for (std::uint64_t i = 0; i < 40; ++i) EXPECT_EQ(keyframes.next()->event_index, i);
  const auto received = info.next();
  EXPECT_EQ(received->width, 640U);
  EXPECT_EQ(received->header.frame_id, "camera");
}

TEST(FastddsProcesses, killed_writer_is_noticed_and_its_successor_heard) {
  const auto bus = connect_fastdds();
  Collector<msg::ServiceStatus> status;
  Collector<int> alive;
  StatusCallbacks callbacks;
  callbacks.on_liveliness = [&](int writers) { alive.push(std::make_shared<int>(writers)); };
  const auto reader = bus->reader(topics::kStatus, status.callback(), callbacks);

  auto first = std::make_unique<PeerProcess>("send_heartbeats", test_domain());
  EXPECT_EQ(*alive.next(), 1);
  const auto pid = status.next()->pid;
  first->kill_now();
  EXPECT_EQ(*alive.next(4s), 0);

  const PeerProcess second("send_heartbeats", test_domain());
  while (status.next()->pid == pid) {
  }
}

/// The files of shared memory that only this process maps, with their locks.
std::set<std::string> shm_files_of(pid_t pid, const std::string& except) {
  std::set<std::string> files;
  std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t name = line.find("/dev/shm/");
    if (name != std::string::npos && except.find(line.substr(name)) == std::string::npos)
      files.insert(line.substr(name));
  }
  return files;
}

std::string maps_of(pid_t pid) {
  std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
  return {std::istreambuf_iterator<char>(maps), {}};
}

template <class Condition>
bool eventually(Condition condition) {
  for (int i = 0; i < 10'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

bool exists(const std::string& path) {
  return access(path.c_str(), F_OK) == 0;
}

TEST(FastddsProcesses, leftovers_of_a_killed_writer_are_cleaned_and_those_of_the_living_are_not) {
  PeerProcess killed("flood_frames", test_domain()), living("send_heartbeats", test_domain());
  const auto has_frames_in = [](pid_t pid) { return maps_of(pid).find("fast_datasharing") != std::string::npos; };
  const auto has_segment = [](pid_t pid) { return maps_of(pid).find("fastrtps_port") != std::string::npos; };
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

/// Output and exit code of bus_peer in a mount namespace whose /dev/shm holds `size`; exit code 77: not permitted here.
std::pair<std::string, int> run_with_small_shm(const std::string& size) {
  const std::string inner = "mount -t tmpfs -o size=" + size +
                            " tmpfs /dev/shm || exit 77; exec timeout 5 " BUS_PEER_PATH " send_heartbeats " +
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

}  // namespace
}  // namespace rtd::bus
