// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// `rtd-detector --robots` as a process, with a network of a few weights.
#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/fleet/robot_double.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::detector {
namespace {

using namespace std::chrono_literals;
using launcher::RtdCommand;
using test_support::RobotDouble;
using ::testing::HasSubstr;
using ::testing::Not;

class FleetProcess : public ::testing::Test {
 protected:
  FleetProcess() {
    options_.vendor = "fastdds";
    options_.domain = test_domain();
    write_model({.free_batch = true});
  }

  void write_model(const test::TinyNetwork& network) const {
    folder_.write("tiny.onnx", test::tiny_network_onnx(network));
  }
  std::vector<std::string> arguments(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"--robots", "all",  "--domain", std::to_string(options_.domain),
                                    "--model",  model_, "--set",    "detector.class_names=[person, box]"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::unique_ptr<RobotDouble> robot(const std::string& name, int id) const {
    return std::make_unique<RobotDouble>(options_, RobotDouble::Options{.name = name, .id = id});
  }
  void expect_refused(const std::vector<std::string>& more, const std::string& cause) const {
    RtdCommand detector;
    EXPECT_EQ(detector.run(arguments(more)), 2);
    EXPECT_THAT(detector.output(), HasSubstr(cause));
  }

  bus::BusOptions options_;
  const rtd::test::TemporaryFolder folder_;
  const std::string model_ = folder_.file("tiny.onnx");
};

TEST_F(FleetProcess, answers_robots_and_ends_with_zero) {
  const auto anna = robot("anna", 1), ben = robot("ben", 2);
  RtdCommand detector;
  detector.start(arguments());
  EXPECT_TRUE(anna->wait_answers(30));
  EXPECT_TRUE(ben->wait_answers(30));
  std::string name;  // that ps and top show, although it has started itself again
  std::getline(std::ifstream("/proc/" + std::to_string(detector.process()) + "/comm"), name);
  EXPECT_EQ(name, std::filesystem::path(RTD_EXECUTABLE).filename());
  detector.interrupt();
  EXPECT_EQ(detector.wait(), 0);
  EXPECT_THAT(detector.output(), HasSubstr("event=serves robot=\"anna\""));
  EXPECT_THAT(detector.output(), Not(HasSubstr("event=no_batch")));
}

TEST_F(FleetProcess, computes_one_by_one_with_a_network_that_takes_no_batch_and_says_so_once) {
  write_model({});
  const auto anna = robot("anna", 1), ben = robot("ben", 2);
  RtdCommand detector;
  detector.start(arguments());
  EXPECT_TRUE(anna->wait_answers(30));
  EXPECT_TRUE(ben->wait_answers(30));
  EXPECT_THAT(anna->status()->message, HasSubstr("), one image at a time, 2 robots"));
  detector.interrupt();
  EXPECT_EQ(detector.wait(), 0);
  const std::string& output = detector.output();
  EXPECT_NE(output.find("event=no_batch"), std::string::npos);
  EXPECT_EQ(output.find("event=no_batch"), output.rfind("event=no_batch"));
  EXPECT_THAT(output, HasSubstr("--free-batch"));
}

TEST_F(FleetProcess, continues_on_the_cpu_without_its_engine_and_says_so) {
  const auto anna = robot("anna", 1);
  RtdCommand detector;
  detector.start(arguments({"--engine", "onnxruntime:/nowhere.so"}));
  EXPECT_TRUE(anna->wait_answers(30));
  EXPECT_THAT(anna->status()->message, HasSubstr("computes on CPU (OpenCV DNN) in place of the engine asked for: "));
  detector.interrupt();
  EXPECT_EQ(detector.wait(), 0);
  EXPECT_THAT(detector.output(), HasSubstr("event=engine_fallback asked=onnxruntime:/nowhere.so"));
}

TEST_F(FleetProcess, the_second_one_takes_over_within_two_seconds_when_the_first_is_killed) {
  const auto anna = robot("anna", 1), ben = robot("ben", 2);
  RtdCommand first, second;
  first.start(arguments());
  ASSERT_TRUE(anna->wait_answers(10));
  ASSERT_TRUE(ben->wait_answers(10));
  second.start(arguments());
  ASSERT_TRUE(second.wait_for("standby for anna"));
  ASSERT_TRUE(second.wait_for("standby for ben"));
  EXPECT_THAT(second.output(), HasSubstr("(pid " + std::to_string(first.process()) + ") serves it"));
  anna->take_figures();
  ben->take_figures();
  ASSERT_TRUE(anna->wait_answers(1));
  ASSERT_TRUE(ben->wait_answers(1));
  ::kill(static_cast<pid_t>(first.process()), SIGKILL);
  EXPECT_TRUE(anna->wait_answers(60));
  EXPECT_TRUE(ben->wait_answers(60));
  EXPECT_LE(anna->figures().longest_gap_ms, 2000);
  EXPECT_LE(ben->figures().longest_gap_ms, 2000);
  RecordProperty("gap_ms", static_cast<int>(anna->figures().longest_gap_ms));
  second.interrupt();
  EXPECT_EQ(second.wait(), 0);
}

TEST_F(FleetProcess, refuses_what_is_for_one_robot) {
  expect_refused({"--pace", "asap"}, "several robots are served at pace realtime");
  expect_refused({"--pace", "lockstep"}, "several robots are served at pace realtime");
  expect_refused({"--input", "frame"}, "raw frames never leave their host");
  expect_refused({"--max-rate", "5"}, "detector.max_rate_hz (--max-rate) is for one robot");
  expect_refused({"--robot", "anna"}, "--robot names the one robot of a detector");
}

TEST_F(FleetProcess, refuses_names_that_no_robot_can_have) {
  RtdCommand wrong, mixed;
  EXPECT_EQ(wrong.run({"--robots", "anna,1st", "--model", model_}), 2);
  EXPECT_THAT(wrong.output(), HasSubstr("'1st' cannot be a robot's name"));
  EXPECT_EQ(mixed.run({"--robots", "all,anna", "--model", model_}), 2);
  EXPECT_THAT(mixed.output(), HasSubstr("'all' is given alone"));
}

TEST_F(FleetProcess, refuses_to_start_without_weights) {
  RtdCommand detector;
  EXPECT_EQ(detector.run({"--robots", "all", "--domain", std::to_string(options_.domain), "--model", "/nowhere.onnx"}),
            2);
  EXPECT_THAT(detector.output(), HasSubstr("deploy/setup.sh --models"));
}

}  // namespace
}  // namespace rtd::detector
