// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Fast DDS with a Discovery Server as docs/two-hosts.md starts it: no multicast, no peers, only the server's address.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "common/bus/network.hpp"
#include "common/bus/raw_bus.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/eventually.hpp"

namespace rtd::bus {
namespace {

using test_support::eventually;
using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr char kServer[] = "/usr/bin/fast-discovery-server";

/// A UDP port that is free now.
int free_port() {
  const int probe = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  socklen_t size = sizeof(address);
  bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size);
  close(probe);
  return ntohs(address.sin_port);
}

/// eProsima's own server, until the end of the test.
class Server {
 public:
  Server(const std::string& id, int port) {
    std::string arguments[] = {kServer, "-i", id, "-l", "127.0.0.1", "-p", std::to_string(port)};
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t silent;
    posix_spawn_file_actions_init(&silent);
    posix_spawn_file_actions_addopen(&silent, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (posix_spawn(&pid_, kServer, &silent, nullptr, argv.data(), environ) != 0) pid_ = 0;
    posix_spawn_file_actions_destroy(&silent);
  }
  ~Server() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  bool running() const { return pid_ > 0 && waitpid(pid_, nullptr, WNOHANG) == 0; }

 private:
  pid_t pid_ = 0;
};

class DiscoveryServer : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::vector<std::string> vendors = dds_vendors();
    if (std::find(vendors.begin(), vendors.end(), "fastdds") == vendors.end())
      GTEST_SKIP() << "built without Fast DDS, which alone knows Discovery Servers";
    if (!std::filesystem::exists(kServer)) GTEST_SKIP() << "no " << kServer << ": apt-get install fastdds-tools";
  }

  /// As `--profile wifi --discovery-server 127.0.0.1:PORT` on one host.
  BusOptions options() {
    BusOptions options = options_of("fastdds");
    options.network.multicast = false;
    options.network.discovery_server = "127.0.0.1:" + std::to_string(port_);
    options.on_problem = [this](const std::string& problem) { problems_.push(std::make_shared<std::string>(problem)); };
    return options;
  }
  const int port_ = free_port();
  Collector<std::string> problems_;
};

TEST_F(DiscoveryServer, matches_two_participants_that_do_not_find_each_other_without_it) {
  const auto here = connect(options()), there = connect(options());
  Collector<msg::PoseStamped> poses;
  const auto reader = there->reader(topics::kPose, poses.callback());
  auto writer = here->writer(topics::kPose);

  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(*problems_.next(30s),
              AllOf(HasSubstr("no Discovery Server answers at " + options().network.discovery_server),
                    HasSubstr("fast-discovery-server -i 0 -l 127.0.0.1 -p")));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kServerPatience + 10s);
  problems_.next(30s);  // of the other one
  EXPECT_EQ(writer.matched(), 0);
  EXPECT_EQ(reader.matched(), 0);

  const Server server("0", port_);
  ASSERT_TRUE(eventually([&] { return writer.matched() == 1 && reader.matched() == 1; }))
      << (server.running() ? "the server runs" : "the server has ended");
  msg::PoseStamped pose;
  pose.header.frame_id = "map";
  EXPECT_TRUE(writer.write(pose));
  EXPECT_EQ(poses.next(30s)->header.frame_id, "map");

  // Tools see what they have no reader for.
  const auto tool = connect_raw(options());
  EXPECT_TRUE(eventually([&] {
    const auto writers = tool->writers();
    return std::any_of(writers.begin(), writers.end(),
                       [](const TopicWriter& known) { return known.topic.name == topics::kPose.name; });
  }));
}

TEST_F(DiscoveryServer, that_answers_in_time_is_no_problem) {
  const Server server("0", port_);
  const auto here = connect(options()), there = connect(options());
  const auto reader = there->reader(topics::kPose, [](const auto&) {});
  auto writer = here->writer(topics::kPose);
  ASSERT_TRUE(eventually([&] { return writer.matched() == 1 && reader.matched() == 1; }));
  std::this_thread::sleep_for(kServerPatience + 500ms);
  EXPECT_EQ(problems_.size(), 0U) << *problems_.next(30s);
}

TEST_F(DiscoveryServer, of_another_id_is_named_as_missing) {
  const Server other("1", port_);
  const auto bus = connect(options());
  EXPECT_THAT(*problems_.next(30s), HasSubstr("-i 0"));
  EXPECT_TRUE(other.running());
}

}  // namespace
}  // namespace rtd::bus
