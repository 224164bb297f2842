// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Cyclone DDS through iceoryx: with the daemon (package iceoryx) and, above all, without.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <chrono>
#include <map>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

std::shared_ptr<Bus> connect_iceoryx(const std::string& vendor = "cyclonedds") {
  BusOptions options;
  options.vendor = vendor;
  options.domain = test_domain();
  options.participant_name = "iceoryx-test";
  options.iceoryx = true;
  return connect(options);
}

bool roudi_answers() {
  const int probe = socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un address{AF_UNIX, "/tmp/roudi"};
  const bool answers = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(probe);
  return answers;
}

/// An iox-roudi of our own, silent; not `running()` where it is not installed.
class Roudi {
 public:
  Roudi() {
    char name[] = "iox-roudi";
    char* argv[] = {name, nullptr};
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    if (posix_spawnp(&pid_, name, &files, nullptr, argv, environ) != 0) pid_ = 0;
    posix_spawn_file_actions_destroy(&files);
    for (int i = 0; pid_ > 0 && i < 10'000 && !roudi_answers(); ++i) std::this_thread::sleep_for(1ms);
  }
  ~Roudi() {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  bool running() const { return pid_ > 0 && roudi_answers(); }

 private:
  pid_t pid_ = 0;
};

std::string error_of(const std::string& vendor) {
  try {
    connect_iceoryx(vendor);
  } catch (const BusError& error) {
    return error.what();
  }
  return "";
}

TEST(Iceoryx, a_missing_daemon_is_a_clear_error_at_once) {
  if (roudi_answers()) GTEST_SKIP() << "an iox-roudi runs on this host";
  const auto start = std::chrono::steady_clock::now();
  const std::string error = error_of("cyclonedds");
  EXPECT_LT(std::chrono::steady_clock::now() - start, 1s);
  EXPECT_THAT(error, HasSubstr("no iox-roudi runs on this host"));
  EXPECT_THAT(error, HasSubstr("start it (package iceoryx: iox-roudi)"));
}

TEST(Iceoryx, is_refused_with_a_vendor_that_has_none) {
  for (const std::string& vendor : dds_vendors()) {
    if (vendor == "cyclonedds") continue;
    EXPECT_THAT(error_of(vendor), HasSubstr("add --dds cyclonedds"));
  }
}

/// A process of its own for each that attaches to the daemon: it sends them SIGTERM when it ends.
TEST(Iceoryx, loans_reach_readers_in_shared_memory_and_over_udp) {
  if (roudi_answers()) GTEST_SKIP() << "an iox-roudi runs on this host";
  const Roudi roudi;
  if (!roudi.running()) GTEST_SKIP() << "iox-roudi does not run here: apt-get install iceoryx";
  constexpr int kFrames = 100;
  BusOptions options;
  options.vendor = "cyclonedds";
  options.domain = test_domain();
  const auto bus = connect(options);
  Collector<msg::TrackingResult> results;
  const auto reader = bus->reader(topics::kTracking, results.callback());
  auto go = bus->writer(topics::kTracking);
  const PeerProcess sending("iceoryx", "send_frames", test_domain(), kFrames);
  const PeerProcess sharing("iceoryx", "answer_frames", test_domain(), 1);
  const PeerProcess over_udp("cyclonedds", "answer_frames", test_domain(), 2);
  // Our own two and those of the peers that answer, which write once they have met the sender.
  for (int i = 0; i < 20'000 && reader.matched() < 3; ++i) std::this_thread::sleep_for(1ms);
  ASSERT_EQ(reader.matched(), 3);
  for (int i = 0; i < 20'000 && go.matched() < 2; ++i) std::this_thread::sleep_for(1ms);
  go.write(msg::TrackingResult{});

  EXPECT_EQ(results.next()->landmarks, 0U);         // our own
  std::map<std::uint32_t, std::uint64_t> answered;  // by the peer's number
  for (int answers = 0; answers < 2 * kFrames; ++answers) {
    const auto result = results.next();
    ASSERT_EQ(result->seq, answered[result->landmarks]++);
    ASSERT_EQ(result->inliers, 1U) << "frame " << result->seq << " arrived changed at peer " << result->landmarks;
  }
  EXPECT_EQ(answered[1], static_cast<std::uint64_t>(kFrames));
}

TEST(Iceoryx, what_cannot_be_lent_continues_over_udp) {
  if (roudi_answers()) GTEST_SKIP() << "an iox-roudi runs on this host";
  const Roudi roudi;
  if (!roudi.running()) GTEST_SKIP() << "iox-roudi does not run here: apt-get install iceoryx";
  const PeerProcess peer("iceoryx", "leave_history", test_domain(), 20);
  BusOptions options;
  options.vendor = "cyclonedds";
  options.domain = test_domain();
  const auto bus = connect(options);
  Collector<msg::KeyframeEvent> keyframes;
  Collector<msg::CameraInfo> info;
  const auto keyframe_reader = bus->reader(topics::kKeyframes, keyframes.callback());
  const auto info_reader = bus->reader(topics::kCameraInfo, info.callback());
  for (std::uint64_t i = 0; i < 20; ++i) EXPECT_EQ(keyframes.next()->event_index, i);
  EXPECT_EQ(info.next()->width, 640U);
}

}  // namespace
}  // namespace rtd::bus
