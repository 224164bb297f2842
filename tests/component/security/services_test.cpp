// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The real services: what they open is what the table of roles says, and secured they do the same work.
#include <gmock/gmock.h>

#include <map>
#include <mutex>
#include <regex>
#include <set>
#include <string>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "common/bus/commands.hpp"
#include "common/bus/fastdds/participant.hpp"
#include "common/bus/topic_roles.hpp"
#include "common/bus/topics.hpp"
#include "common/msg/imu.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::bus {
namespace {

/// Who opens which writers and readers in a domain, by participant name: "rtd-slam" writes "rtd/tracking".
class EndpointCensus : private fastdds::DiscoveryAdapter {
 public:
  explicit EndpointCensus(std::uint32_t domain) : participant_(options(domain), read_host_limits(), &writers_) {
    participant_.observe(*this);
  }
  ~EndpointCensus() override { participant_.silence(); }

  struct Topics {
    std::set<std::string> writes, reads;
  };
  std::map<std::string, Topics> by_participant() const;

 private:
  static BusOptions options(std::uint32_t domain);
  void found(const fastdds::FoundParticipant& participant) override;
  void found(const TopicWriter& writer, bool gone) override;
  void found(const TopicReader& reader, bool gone) override;

  mutable std::mutex mutex_;
  std::map<ParticipantId, std::string> names_;
  std::map<ParticipantId, Topics> topics_;
  EndpointRegistry writers_;          // with it, everything is discovered
  fastdds::Participant participant_;  // last: calls the others
};

BusOptions EndpointCensus::options(std::uint32_t domain) {
  BusOptions options;
  options.domain = domain;
  options.participant_name = "census";
  return options;
}

std::map<std::string, EndpointCensus::Topics> EndpointCensus::by_participant() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, Topics> all;
  for (const auto& [guid, topics] : topics_) {
    const auto name = names_.find(guid);
    if (name == names_.end()) continue;
    all[name->second].writes.insert(topics.writes.begin(), topics.writes.end());
    all[name->second].reads.insert(topics.reads.begin(), topics.reads.end());
  }
  return all;
}

void EndpointCensus::found(const fastdds::FoundParticipant& participant) {
  const std::lock_guard lock(mutex_);
  names_.try_emplace(participant.id, participant.name);
}

void EndpointCensus::found(const TopicWriter& writer, bool /*gone*/) {
  const std::lock_guard lock(mutex_);
  topics_[participant_of(writer.id)].writes.insert(writer.topic.name);
}

void EndpointCensus::found(const TopicReader& reader, bool /*gone*/) {
  const std::lock_guard lock(mutex_);
  topics_[participant_of(reader.id)].reads.insert(reader.topic.name);
}

}  // namespace
}  // namespace rtd::bus

namespace rtd::launcher {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class SecuredServicesTest : public ::testing::Test {
 protected:
  std::vector<std::string> run_command(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> command = {
        "run",     "--source", "synthetic:office?frames=12", "--out",    scratch_ / name,        "--pace", "lockstep",
        "--dense", "--record", scratch_ / (name + ".mcap"),  "--domain", std::to_string(domain_)};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }
  static std::set<std::string> set_of(const std::vector<std::string>& topics) { return {topics.begin(), topics.end()}; }

  /// The raw frames are in a folder for their user only, and so is the rest of the shared memory. Waits for them.
  bool frames_are_hidden(const std::string& camera_log) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < give_up) {
      rtd_.wait_for("never printed", std::chrono::milliseconds(20));
      std::smatch memory;
      const pid_t pid = pid_in(text_of(camera_log));
      if (pid < 0) continue;
      const std::string maps = text_of("/proc/" + std::to_string(pid) + "/maps");
      if (!std::regex_search(maps, memory, std::regex("(/dev/shm/rtd_rings_\\S+)/fast_datasharing_"))) continue;
      const std::string folder = memory[1];
      if (!std::regex_search(maps, memory, std::regex("/dev/shm/fast(rtps|dds)_[0-9a-f]+"))) continue;
      const auto others = std::filesystem::perms::group_all | std::filesystem::perms::others_all;
      const auto hidden = [&](const std::string& path) {
        return (std::filesystem::status(path).permissions() & others) == std::filesystem::perms::none;
      };
      if (hidden(folder) && hidden(memory.str())) return true;
    }
    return false;
  }

  const std::uint32_t domain_ = test_domain();
  ScratchFolder scratch_;
  RtdCommand rtd_;
};

TEST_F(SecuredServicesTest, services_open_what_the_table_of_roles_says_and_nothing_else) {
  const bus::EndpointCensus census(domain_);
  ASSERT_EQ(rtd_.run(run_command("census")), 0) << rtd_.output();
  auto opened = census.by_participant();
  // In the clear each connection is a node of ROS 2 with parameters.
  const auto of_the_node = [](const std::string& topic) {
    return topic == "ros_discovery_info" || topic.starts_with("rq/rtd_") || topic.starts_with("rr/rtd_");
  };
  for (auto& [participant, topics] : opened) {
    std::erase_if(topics.writes, of_the_node);
    std::erase_if(topics.reads, of_the_node);
  }
  for (const std::string role : {"camera", "filter", "slam", "dense", "launcher"}) {
    const bus::RoleTopics table = bus::topics_of(role);
    const auto& topics = opened[role == "launcher" ? "rtd" : "rtd-" + role];
    // Only with an IMU, wheels or filter.person_masks; at pace lockstep slam asks no atlas for its place.
    std::set<std::string> with_options = {msg::kImuTopic, msg::kWheelTopic, bus::topics::kPersonMasks.name,
                                          bus::topics::kSubmap.name};
    if (role == "camera") with_options.insert(bus::topics::kTfStatic.name);  // of a recording that has it
    auto writes = set_of(table.writes), reads = set_of(table.reads);
    if (role == "camera") std::erase_if(writes, [](const auto& topic) { return topic.starts_with("rtd/frame_"); });
    for (auto* expected : {&writes, &reads})
      std::erase_if(*expected, [&](const auto& topic) { return with_options.contains(topic); });
    EXPECT_EQ(topics.writes, writes) << role << ", whose frames are those of one size";
    auto read = topics.reads;
    if (role == "launcher") read.erase(bus::topics::kPersonMasks.name);  // in the clear, for the pictures of its report
    EXPECT_EQ(read, reads) << role;
  }
  auto detector = opened.find("rtd-detector");
  if (detector == opened.end()) return;  // no weights
  std::set<std::string> reads = set_of(bus::topics_of("detector").reads);
  reads.erase(bus::topics::kColorJpeg.name);  // in place of the frame on another host
  std::set<std::string> writes = set_of(bus::topics_of("detector").writes);
  if (!detector->second.writes.contains(bus::topics::kPersonMasks.name))
    writes.erase(bus::topics::kPersonMasks.name);  // no weights for them
  EXPECT_EQ(detector->second.writes, writes);
  for (const std::string& topic : detector->second.reads) EXPECT_TRUE(reads.contains(topic)) << topic;
}

TEST_F(SecuredServicesTest, a_secured_run_does_what_a_run_in_the_clear_does) {
  const std::string keystore = scratch_ / "keystore";
  RtdCommand create;
  ASSERT_EQ(create.run({"keystore", "create", keystore}), 0) << create.output();
  rtd_.start(run_command("secured", {"--secure", "--keystore", keystore}));
  EXPECT_TRUE(frames_are_hidden(scratch_ / "secured/logs/camera.log"));
  ASSERT_EQ(rtd_.wait(), 0) << rtd_.output();
  EXPECT_THAT(text_of(scratch_ / "secured/logs/slam.log"), HasSubstr("enclave=/rtd/slam"));
  if (!test_support::kSanitized) {  // a slow camera sends frames of a lockstep run again
    EXPECT_THAT(text_of(scratch_ / "secured/logs/record.log"),
                HasSubstr("topic=rtd/frame messages=12 lost_in_transit=0"));
  }
  for (const char* service : {"camera", "filter", "slam", "dense", "record"}) {
    const std::string log = text_of(scratch_ / (std::string("secured/logs/") + service + ".log"));
    EXPECT_THAT(log, Not(HasSubstr("SECURITY Error"))) << service;
    EXPECT_THAT(log, Not(HasSubstr("bus_problem"))) << service;
  }
  RtdCommand clear;
  ASSERT_EQ(clear.run(run_command("clear")), 0) << clear.output();
  EXPECT_EQ(text_of(scratch_ / "secured/trajectory.txt"), text_of(scratch_ / "clear/trajectory.txt"))
      << "byte for byte";
}

/// Any service of the domain may send heartbeats, but only slam may write slam's poses.
TEST_F(SecuredServicesTest, a_heartbeat_in_the_name_of_slam_is_believed_from_slam_alone) {
  const std::string keystore = scratch_ / "keystore";
  RtdCommand create;
  ASSERT_EQ(create.run({"keystore", "create", keystore}), 0) << create.output();
  for (const std::string& vendor : bus::dds_vendors()) {
    bus::BusOptions options;
    options.vendor = vendor;
    options.domain = domain_;
    options.security = {keystore, "/rtd/dense"};
    const auto dense = bus::connect(options);
    auto forged = dense->writer(bus::topics::kStatus);
    const std::jthread forger([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        forged.write({.service = "slam", .pid = 1, .state = msg::ServiceState::kFinished});
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    });
    RtdCommand rtd;
    EXPECT_EQ(rtd.run({"run", "--source", "synthetic:office?frames=12", "--out", scratch_ / vendor, "--pace",
                       "lockstep", "--detector", "off", "--domain", std::to_string(domain_), "--secure", "--keystore",
                       keystore, "--dds", vendor}),
              0)
        << rtd.output();
    EXPECT_THAT(rtd.output(), HasSubstr("heartbeats_refused")) << "the attack was none";
    EXPECT_THAT(rtd.output(), HasSubstr("12 with pose")) << vendor;
  }
}

TEST_F(SecuredServicesTest, commands_are_answered_only_to_those_who_may_call) {
  const std::string keystore = scratch_ / "keystore", domain = std::to_string(domain_);
  RtdCommand create;
  ASSERT_EQ(create.run({"keystore", "create", keystore}), 0) << create.output();
  rtd_.start({"record", "--wait", "-o", scratch_ / "commanded.mcap", "--domain", domain, "--keystore", keystore});
  RtdCommand allowed, in_the_clear;
  int code = 1;  // on a busy host the recorder may not be there yet
  for (int tries = 0; tries < 5 && code != 0; ++tries)
    code = allowed.run({"call", "/recorder/start", "--domain", domain, "--keystore", keystore});
  EXPECT_EQ(code, 0) << allowed.output();
  EXPECT_THAT(allowed.output(), HasSubstr("recording to "));
  EXPECT_EQ(in_the_clear.run({"call", "/recorder/stop", "--domain", domain}), 1) << in_the_clear.output();
  EXPECT_THAT(in_the_clear.output(), HasSubstr("no running program offers /recorder/stop"));
  bus::BusOptions options;
  options.domain = domain_;
  options.security = {keystore, "/rtd/observer"};
  bus::CommandClient observer(options);
  try {
    observer.call("recorder/stop", "", 10'000);
    ADD_FAILURE() << "an observer stopped the recording";
  } catch (const bus::BusError& error) {
    EXPECT_THAT(error.what(), HasSubstr("enclave /rtd/observer may not subscribe topic rr/recorder/stopReply"));
  }
  rtd_.interrupt();
  EXPECT_EQ(rtd_.wait(), 0) << rtd_.output();
}

TEST_F(SecuredServicesTest, secure_never_falls_back_to_clear) {
  EXPECT_EQ(rtd_.run(run_command("none", {"--secure", "--keystore", scratch_ / "missing"})), 2);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("there is none"), HasSubstr("rtd keystore create")));
  RtdCommand service;
  EXPECT_EQ(service.run({"slam", "--secure", "--keystore", scratch_ / "missing"}), 2);
  EXPECT_THAT(service.output(), HasSubstr("rtd keystore create"));
}

#ifdef RTD_HAVE_CYCLONEDDS
TEST_F(SecuredServicesTest, a_secured_run_of_two_vendors_is_refused) {
  EXPECT_EQ(rtd_.run(run_command("mixed", {"--secure", "--dds", "fastdds", "--dds-of", "slam=cyclonedds"})), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("a secured domain needs one vendor"));
}
#endif

TEST_F(SecuredServicesTest, a_topic_without_permission_is_named) {
  const std::string keystore = scratch_ / "keystore";
  RtdCommand create;
  ASSERT_EQ(create.run({"keystore", "create", keystore}), 0) << create.output();
  EXPECT_EQ(rtd_.run({"slam", "--keystore", keystore, "--set", "bus.security.enclave=/rtd/observer", "--domain",
                      std::to_string(domain_)}),
            2);
  EXPECT_THAT(rtd_.output(), HasSubstr("enclave /rtd/observer may not publish topic rtd/status"));
}

}  // namespace
}  // namespace rtd::launcher
