// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/endpoints.hpp"
#include "common/bus/fastdds/participant.hpp"
#include "common/bus/fastdds/qos_mapping.hpp"
#include "common/bus/host/host_checks.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/io/fd_writing.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace fs = std::filesystem;

constexpr int kDomain = 95;

std::string port_name(std::uint32_t id) {
  return std::string(kShmPrefix) + "port" + std::to_string(7400 + 250 * kDomain + 11 + 2 * id);
}

class ParticipantId : public testing::Test {
 protected:
  void add_port(std::uint32_t id) { std::ofstream(folder_ / port_name(id)); }
  const rtd::test::TemporaryFolder folder_;
};

TEST_F(ParticipantId, follows_the_process_id) {
  EXPECT_EQ(free_participant_id(kDomain, 0, {}, folder_), 0U);
  EXPECT_EQ(free_participant_id(kDomain, 118, {}, folder_), 118U);
  EXPECT_EQ(free_participant_id(kDomain, 4328, {}, folder_), 44U);
  EXPECT_EQ(free_participant_id(232, 4304, {}, folder_), 44U) << "of sixty, its ports end at 65535";
}

TEST_F(ParticipantId, is_not_that_of_a_port_which_is_there) {
  add_port(44);
  add_port(45);
  EXPECT_EQ(free_participant_id(kDomain, 4328, {}, folder_), 46U);
  EXPECT_EQ(free_participant_id(kDomain + 1, 4328, {}, folder_), 44U) << "another domain has other ports";
  add_port(118);
  EXPECT_EQ(free_participant_id(kDomain, 118, {}, folder_), 0U);
}

TEST_F(ParticipantId, is_not_that_of_another_participant_of_this_process) {
  EXPECT_EQ(free_participant_id(kDomain, 4328, {44, 46}, folder_), 45U);
  EXPECT_EQ(free_participant_id(kDomain, 46, {44, 46}, folder_), 47U);
}

TEST_F(ParticipantId, is_none_when_all_ports_are_there) {
  for (std::uint32_t id = 0; id < 119; ++id) add_port(id);
  EXPECT_EQ(free_participant_id(kDomain, 61, {}, folder_), std::nullopt);
}

/// The names above are those that Fast DDS gives its files.
TEST(ParticipantOnTheBus, has_a_port_in_shared_memory_that_the_next_one_avoids) {
  BusOptions options;
  options.domain = kDomain;
  const auto first = static_cast<std::uint32_t>(getpid());
  const auto before = free_participant_id(kDomain, first);
  {
    const Participant participant(options, read_host_limits());
    EXPECT_NE(free_participant_id(kDomain, first), before);
  }
  EXPECT_EQ(free_participant_id(kDomain, first), before);
}

TEST(ParticipantOnTheBus, has_no_port_in_shared_memory_beside_a_program_of_another_user) {
  BusOptions options;
  options.domain = kDomain;
  HostLimits limits = read_host_limits();
  limits.closed_ports[7400 + 250 * kDomain + 13] = geteuid() + 1;
  const auto first = static_cast<std::uint32_t>(getpid());
  const auto before = free_participant_id(kDomain, first);
  const Participant participant(options, limits);
  EXPECT_EQ(free_participant_id(kDomain, first), before);
}

TEST(ParticipantOnTheBus, does_not_choose_its_port_while_another_process_does) {
  using std::chrono::milliseconds;
  BusOptions options;
  options.domain = kDomain;
  auto other = std::make_unique<ShmFolder>(kShmFolder, std::chrono::seconds(10));
  ASSERT_TRUE(other->locked());
  const auto joined =
      std::async(std::launch::async, [&] { const Participant participant(options, read_host_limits()); });
  EXPECT_EQ(joined.wait_for(milliseconds(1500)), std::future_status::timeout);
  other.reset();
  joined.wait();
}

/// Has every third port locked, but not there yet: as one that joins at the same time.
class FasterProcess {
 public:
  FasterProcess() {
    std::deque<io::Descriptor> locks;
    for (std::uint32_t id = 0; id < 119; id += 3) {
      paths_.push_back(fs::path(kShmFolder) / (port_name(id) + "_el"));
      locks.emplace_back(open(paths_.back().c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0644));
      EXPECT_EQ(flock(locks.back().get(), LOCK_EX | LOCK_NB), 0) << paths_.back();
    }
    pid_ = fork();  // from here on it has the locks
    if (pid_ == 0) prctl(PR_SET_PDEATHSIG, SIGKILL);
    while (pid_ == 0) pause();
    EXPECT_GT(pid_, 0);
  }
  ~FasterProcess() {
    if (pid_ > 0) kill(pid_, SIGKILL);  // -1 are all processes
    if (pid_ > 0) waitpid(pid_, nullptr, 0);
    for (const fs::path& path : paths_) unlink(path.c_str());
  }
  FasterProcess(const FasterProcess&) = delete;
  FasterProcess& operator=(const FasterProcess&) = delete;

 private:
  std::vector<fs::path> paths_;
  pid_t pid_ = 0;
};

TEST(ParticipantOnTheBus, receives_also_when_another_process_was_faster_at_its_port) {
  BusOptions options;
  options.domain = kDomain;
  const FasterProcess faster;
  const auto join = [&] { return std::make_shared<Participant>(options, read_host_limits()); };
  const auto poses = [] { return create_codec(MessageTraits<msg::TrackingResult>::kId); };
  for (int tried = 0; tried < 3; ++tried) {  // of each remainder by three: ids are 31 apart
    std::promise<void> received;
    FastddsReader reader(join(), poses(), "rtd/tracking", reader_qos(qos_settings(QosProfile::kPose), true),
                         [&](auto, auto) { received.set_value(); }, {});
    FastddsWriter writer(join(), poses(), "rtd/tracking", writer_qos(qos_settings(QosProfile::kPose), true), {});
    for (int i = 0; i < 10'000 && (writer.matched() == 0 || reader.matched() == 0); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const msg::TrackingResult pose{};
    EXPECT_TRUE(writer.write(&pose));
    EXPECT_EQ(received.get_future().wait_for(std::chrono::seconds(10)), std::future_status::ready);
  }
}

/// With Fast DDS' direct calls between participants of one process both wait forever within a fraction of a second.
TEST(ParticipantOnTheBus, two_of_one_process_announce_their_liveliness_at_once_and_end) {
  RawWriterOptions announces;
  announces.qos.liveliness_lease_ns = 3'000'000;
  BusOptions options;
  options.domain = kDomain;
  const auto end_in_time = std::async(std::launch::async, [&] {
    const auto first = connect_raw(options), second = connect_raw(options);
    const auto first_writer = first->writer({"rtd/first", "First"}, announces);
    const auto second_writer = second->writer({"rtd/second", "Second"}, announces);
    std::this_thread::sleep_for(std::chrono::seconds(1));
  });
  if (end_in_time.wait_for(std::chrono::seconds(20)) != std::future_status::ready) {
    std::fputs("the participants wait for each other forever\n", stderr);
    std::_Exit(EXIT_FAILURE);
  }
}

}  // namespace
}  // namespace rtd::bus::fastdds
