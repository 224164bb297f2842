// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// `rtd doctor` with the bus options of the services: what a profile needs is there, or is named with its cure.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <ctime>
#include <memory>

#include "common/bus/network.hpp"
#include "common/bus/port_check.hpp"
#include "common/msg/services.hpp"
#include "services/launcher/doctor/doctor_command.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::launcher {
namespace {

namespace fs = std::filesystem;
using namespace ::testing;

/// A host that lacks nothing but what the test takes away.
class DoctorTest : public testing::Test {
 protected:
  DoctorTest() {
    fs::copy_file(RTD_EXECUTABLE, scratch_ / "rtd");
    fs::create_symlink(fs::path(RTD_EXECUTABLE).parent_path() / "rtd-keystore", scratch_ / "rtd-keystore");
    for (const msg::NamedService& service : msg::kServices) {
      const std::string file = scratch_ / service.executable;
      std::ofstream(file) << "#!/bin/sh\n";
      fs::permissions(file, fs::perms::owner_all);
    }
  }
  /// In a domain of this process.
  int doctor(std::vector<std::string> arguments) {
    ::setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // OpenNI's drivers are unloaded with what they hold
    arguments.insert(arguments.begin(), {"doctor", "--domain", std::to_string(domain())});
    const int exit_code = rtd_.run(arguments);
    ::unsetenv("ASAN_OPTIONS");
    return exit_code;
  }
  /// Its ports are below those that the kernel gives to any program.
  static std::uint32_t domain() { return test_domain(); }

  ScratchFolder scratch_;
  RtdCommand rtd_{scratch_ / "rtd"};
};

/// Holds a UDP port and does not share it.
class Port {
 public:
  explicit Port(std::uint16_t number) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(number);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0) << number;
  }
  ~Port() { close(socket_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

 private:
  int socket_;
};

TEST_F(DoctorTest, names_the_dds_settings_of_ros_that_it_follows_and_those_that_it_does_not) {
  ::setenv("ROS_STATIC_PEERS", "192.0.2.1", 1);
  doctor({"--dds", "fastdds"});
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("warn network: ROS_STATIC_PEERS=192.0.2.1: is not followed"),
                                   HasSubstr("--profile lan")));
  ::setenv("ROS_STATIC_PEERS", "127.0.0.1", 1);
  doctor({"--dds", "fastdds"});
  EXPECT_THAT(rtd_.output(), HasSubstr("ok   network: ROS_STATIC_PEERS=127.0.0.1: followed"));
  ::unsetenv("ROS_STATIC_PEERS");
}

TEST_F(DoctorTest, a_host_that_lacks_nothing_is_exit_code_0) {
  EXPECT_EQ(doctor({}), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("ok   services"), HasSubstr("ok   network: this host only"),
                                   HasSubstr("ok   bus: "), Not(HasSubstr("FAIL"))));
}

TEST_F(DoctorTest, only_what_every_run_starts_must_be_there) {
  fs::remove(scratch_ / "rtd-dense");
  EXPECT_EQ(doctor({}), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("warn services: not there, for some options only: rtd-dense; build"),
                                   HasSubstr("ok   services: camera, ")));
  fs::remove(scratch_ / "rtd-slam");
  EXPECT_EQ(doctor({}), 1);
  EXPECT_THAT(rtd_.output(), HasSubstr("FAIL services: missing rtd-slam; build them with"));
}

TEST_F(DoctorTest, a_profile_that_is_none_is_exit_code_2) {
  EXPECT_EQ(doctor({"--profile", "lna"}), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("lan, localhost, secure, wifi"));
}

TEST_F(DoctorTest, an_interface_that_is_not_there_is_named_with_those_that_are) {
  EXPECT_EQ(doctor({"--profile", "lan", "--interface", "eth99"}), 1);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("FAIL network: --interface eth99"), HasSubstr("there are")));
}

TEST_F(DoctorTest, peers_are_resolved_and_need_a_network) {
  EXPECT_EQ(doctor({"--profile", "lan", "--peers", "127.0.0.1,no such host"}), 1);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("ok   network: --peers 127.0.0.1 is 127.0.0.1"),
                                   HasSubstr("FAIL network: --peers no such host: no IPv4 address")));
  EXPECT_EQ(doctor({"--peers", "10.0.0.2"}), 1);
  EXPECT_THAT(rtd_.output(), HasSubstr("--profile lan or wifi"));
}

TEST_F(DoctorTest, ports_in_use_are_named) {
  {
    const Port discovery(bus::discovery_port(domain()));
    EXPECT_EQ(doctor({}), 1);
    EXPECT_THAT(rtd_.output(), HasSubstr("FAIL ports: UDP port " + std::to_string(bus::discovery_port(domain()))));
  }
  std::vector<std::unique_ptr<Port>> others;
  for (int id = 0; id < bus::kPeerParticipants; ++id)
    others.push_back(std::make_unique<Port>(bus::participant_port(domain(), id)));
  EXPECT_EQ(doctor({"--profile", "wifi"}), 1);
  EXPECT_THAT(rtd_.output(), HasSubstr("FAIL ports: 0 of 32 from UDP"));
}

TEST_F(DoctorTest, the_engines_of_the_detector_are_named) {
  doctor({});
  EXPECT_THAT(rtd_.output(), HasSubstr("ok   detector engines: cpu"));
}

TEST_F(DoctorTest, a_missing_keystore_is_named_with_the_command_that_makes_one) {
  EXPECT_EQ(doctor({"--secure", "--keystore", scratch_ / "none"}), 1);
  EXPECT_THAT(rtd_.output(),
              HasSubstr("FAIL keystore: " + scratch_ / "none" + " is not a keystore: make one with 'rtd keystore"));
}

TEST_F(DoctorTest, the_enclaves_of_a_keystore_are_checked) {
  const std::string folder = scratch_ / "keys", enclaves = folder + "/enclaves/rtd";
  ASSERT_EQ(rtd_.run({"keystore", "create", folder}), 0) << rtd_.output();
  EXPECT_EQ(doctor({"--secure", "--keystore", folder}), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("ok   keystore: "), HasSubstr("is the first to expire, in 3")));

  // The GPU host has the detector's keys only.
  for (const auto& enclave : fs::directory_iterator(enclaves))
    if (enclave.path().filename() != "detector") fs::remove_all(enclave.path());
  EXPECT_EQ(doctor({"--secure", "--keystore", folder}), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(), HasSubstr("warn keystore: no enclave /rtd/camera, /rtd/filter"));

  std::ofstream(enclaves + "/detector/cert.pem") << "no certificate\n";
  EXPECT_EQ(doctor({"--secure", "--keystore", folder}), 1);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("FAIL keystore: "), HasSubstr("/detector/cert.pem")));
}

TEST_F(DoctorTest, keys_that_expire_soon_are_reported_and_expired_ones_fail) {
  constexpr std::int64_t kDayS = 24 * 3600;
  bus::BusOptions options;
  options.security = {scratch_ / "keys", "/rtd/launcher"};
  ASSERT_EQ(rtd_.run({"keystore", "create", options.security.keystore, "--days", "60"}), 0) << rtd_.output();
  Findings soon, late;
  EXPECT_EQ(check_keystore(options, std::time(nullptr) + 40 * kDayS, soon), "/rtd/launcher");
  EXPECT_THAT(soon, Contains(AllOf(Field(&Finding::verdict, Verdict::kWarn),
                                   Field(&Finding::text, HasSubstr("'rtd keystore renew ")))));
  EXPECT_EQ(check_keystore(options, std::time(nullptr) + 70 * kDayS, late), "");
  ASSERT_EQ(rtd_.run({"keystore", "create", scratch_ / "short", "--days", "5"}), 0) << rtd_.output();
  EXPECT_EQ(doctor({"--secure", "--keystore", scratch_ / "short"}), 0) << "still good: " << rtd_.output();
  EXPECT_THAT(late,
              Contains(AllOf(Field(&Finding::verdict, Verdict::kFail), Field(&Finding::text, HasSubstr("expired")))));
}

TEST_F(DoctorTest, a_discovery_server_that_does_not_answer_is_named) {
  const std::vector<std::string> vendors = bus::dds_vendors();
  if (std::find(vendors.begin(), vendors.end(), "fastdds") == vendors.end()) GTEST_SKIP() << "built without Fast DDS";
  EXPECT_EQ(doctor({"--dds", "fastdds", "--discovery-server", "127.0.0.1:9"}), 1);
  EXPECT_THAT(rtd_.output(), HasSubstr("FAIL bus: no Discovery Server answers at 127.0.0.1:9"));
}

}  // namespace
}  // namespace rtd::launcher
