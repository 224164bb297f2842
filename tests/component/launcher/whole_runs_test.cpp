// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
/// A recording of a ROS 2 camera is played beside a run that uses it as its camera, as users try a driver's habits.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/recordings/reader.hpp"
#include "common/ros2/message_json.hpp"
#include "common/ros2/names.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/frames_table.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/mcap_file.hpp"

namespace rtd::launcher {
namespace {

using camera::test::ImageBag;
using test_support::Links;
using namespace ::testing;

/// Three seconds of a room at 30 Hz, whose driver leaves the step of its colour images at 0.
std::string recording_with_step_0() {
  camera::test::McapFile file;
  const auto source = camera::make_source("synthetic:static?frames=90&width=320&height=240");
  source->open();
  while (const auto frame = source->next()) {
    const double stamp_s = 1e-9 * static_cast<double>(frame->image.stamp_ns);
    const auto& lens = source->info().camera.parameters();
    msg::CameraInfo info = ImageBag::camera_info(lens.fx);
    info.width = static_cast<std::uint32_t>(lens.width);
    info.height = static_cast<std::uint32_t>(lens.height);
    info.k = {lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1};
    info.header.stamp = msg::to_time(frame->image.stamp_ns);
    cv::Mat depth_mm;
    frame->image.depth.convertTo(depth_mm, CV_16UC1, 1000 * frame->image.depth_scale_m);
    msg::Image color = ImageBag::image(frame->image.color_bgr, "bgr8", stamp_s);
    color.step = 0;
    file.add("/cam/camera_info", "sensor_msgs/msg/CameraInfo", info, stamp_s);
    file.add("/cam/image_raw", "sensor_msgs/msg/Image", color, stamp_s);
    file.add("/cam/depth", "sensor_msgs/msg/Image", ImageBag::image(depth_mm, "16UC1", stamp_s), stamp_s);
  }
  return file.bytes();
}

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(LiveRecording, with_a_wrong_step_is_tracked_with_one_warning) {
  const ScratchFolder scratch;
  const std::string recording = scratch / "driver.mcap";
  std::ofstream(recording, std::ios::binary) << recording_with_step_0();
  const std::string domain = "93";  // of no other test
  RtdCommand run, replay(std::filesystem::path(RTD_EXECUTABLE).parent_path() / "rtd-replay");
  run.start({"run", "--source", "ros2:/cam/image_raw,/cam/depth", "--frames", "30", "--detector", "off", "--out",
             scratch / "out", "--domain", domain});
  ASSERT_TRUE(run.wait_for("it has no publisher")) << run.output();
  replay.start({recording, "--domain", domain, "--wait-readers", "10"});
  const int exit_code = run.wait();
  if (test_support::kSanitized && exit_code == 3) GTEST_SKIP() << test_support::kTooSlow;  // frames late
  EXPECT_EQ(exit_code, 0) << run.output();
  EXPECT_EQ(replay.wait(), 0) << replay.output();
  EXPECT_THAT(run.output(), AllOf(HasSubstr("30 used, 30 with pose"), HasSubstr("'step' is 0")));
  EXPECT_EQ(occurrences(run.output(), "'step' is 0"), 1U) << run.output();
}

// A run on a computer that has no time for it: half of the frames are lost on the way, other programs take the
// processors, and again and again nothing runs at all.

/// Each in a session of its own, to which Linux gives as much as to the whole run.
class BusyProcesses {
 public:
  explicit BusyProcesses(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      const pid_t pid = fork();
      if (pid == 0) {
        setsid();
        alarm(kLongest_s);
        while (getppid() != 1) continue;
      }
      if (pid > 0) pids_.push_back(pid);
    }
  }
  ~BusyProcesses() {
    for (const pid_t pid : pids_) ::kill(pid, SIGKILL);
    for (const pid_t pid : pids_) waitpid(pid, nullptr, 0);
  }
  BusyProcesses(const BusyProcesses&) = delete;
  BusyProcesses& operator=(const BusyProcesses&) = delete;

 private:
  static constexpr unsigned kLongest_s = 200;
  std::vector<pid_t> pids_;
};

class OverloadedRun : public testing::Test {
 protected:
  std::string log(const std::string& service) const { return text_of(out_ + "/logs/" + service + ".log"); }
  pid_t pid_of(const std::string& service) const { return pid_in(log(service)); }
  /// While the camera plays.
  void stop_everything_again_and_again() {
    constexpr std::chrono::milliseconds kBurst{300}, kBetween{2000};
    std::vector<pid_t> all = {static_cast<pid_t>(rtd_.process())};
    for (const char* service : {"camera", "filter", "slam"}) all.push_back(pid_of(service));
    ASSERT_THAT(all, testing::Each(testing::Gt(0)));
    for (; bursts_ < 6; ++bursts_) {
      std::this_thread::sleep_for(kBetween);
      for (const pid_t pid : all) ::kill(pid, SIGSTOP);
      std::this_thread::sleep_for(kBurst);
      for (const pid_t pid : all) ::kill(pid, SIGCONT);
      rtd_.take_output();
    }
  }

  ScratchFolder scratch_;
  std::string out_ = scratch_ / "out";
  RtdCommand rtd_;
  int bursts_ = 0;
};

TEST_F(OverloadedRun, keeps_its_pose_with_the_newest_frames) {
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  const BusyProcesses others(3 * std::max(2U, std::thread::hardware_concurrency()));
  rtd_.start({"run", "--source", "synthetic:office?frames=240&drops=0.5", "--out", out_, "--domain", "78", "--detector",
              "off", "--pace", "realtime"});
  for (int i = 0; i < 600 && log("camera").find("event=all_ready") == std::string::npos; ++i)
    rtd_.wait_for("never printed", std::chrono::milliseconds(50));
  stop_everything_again_and_again();
  ASSERT_EQ(rtd_.wait(std::chrono::seconds(120)), 0) << rtd_.output();
  const nlohmann::json report = nlohmann::json::parse(text_of(out_ + "/report.json"));
  EXPECT_GE(report["frames_tracked"].get<double>(), 0.99 * report["frames_used"].get<double>());
  EXPECT_LT(report["ate_rmse_m"], 0.03);
  EXPECT_THAT(log("slam"), Not(HasSubstr("event=tracking_lost")));
  for (const char* service : {"camera", "filter", "slam"}) EXPECT_EQ(report["restarts"][service], 0) << service;
}

// A run in which everything is stopped and continues, as in a paused container. RTD_PAUSE_S: how long, at
// both paces; without it 10 s at one pace for each vendor.

class PausedRun : public testing::TestWithParam<std::string> {
 protected:
  std::string log(const std::string& service) const { return text_of(out_ + "/logs/" + service + ".log"); }
  pid_t pid_of(const std::string& service) const { return pid_in(log(service)); }
  bool wait_for_log(const std::string& service, const std::string& text) {
    for (int i = 0; i < 600; ++i) {
      if (log(service).find(text) != std::string::npos) return true;
      rtd_.wait_for("never printed", std::chrono::milliseconds(50));
    }
    return false;
  }
  static std::chrono::seconds pause() {
    const char* const text = std::getenv("RTD_PAUSE_S");
    return std::chrono::seconds(text == nullptr ? 10 : std::atoi(text));
  }
  static std::vector<std::string> paces() {
    if (std::getenv("RTD_PAUSE_S") != nullptr) return {"lockstep", "realtime"};
    return {GetParam() == "fastdds" ? "lockstep" : "realtime"};
  }
  /// The launcher continues first: it could kill the others.
  void stop_everything_for_a_while() {
    std::vector<pid_t> all = {static_cast<pid_t>(rtd_.process())};
    for (const char* service : {"camera", "filter", "slam"}) all.push_back(pid_of(service));
    for (const pid_t pid : all) ASSERT_EQ(send_signal(pid, SIGSTOP), 0) << pid;
    std::this_thread::sleep_for(pause());
    for (const pid_t pid : all) ASSERT_EQ(send_signal(pid, SIGCONT), 0) << pid;
  }
  static long count(const std::string& text, const std::string& part) {
    long found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  }

  ScratchFolder scratch_;
  std::string out_ = scratch_ / "out";
  RtdCommand rtd_;
};

TEST_P(PausedRun, continues_with_all_services_and_the_same_map) {
  for (const std::string& pace : paces()) {
    out_ = scratch_ / pace;
    rtd_.start({"run", "--source", "synthetic:office?frames=150", "--out", out_, "--domain", "77", "--detector", "off",
                "--pace", pace, "--dds", GetParam()});
    ASSERT_TRUE(wait_for_log("slam", "event=map_started")) << rtd_.output();
    stop_everything_for_a_while();
    ASSERT_EQ(rtd_.wait(std::chrono::seconds(120)), 0) << rtd_.output();
    for (const char* wrong : {"killed", "restarted", "died"}) EXPECT_THAT(rtd_.output(), Not(HasSubstr(wrong)));
    EXPECT_EQ(count(log("slam"), "event=map_started"), 1) << log("slam");
    EXPECT_EQ(count(log("camera"), "event=started"), 1);
    const long poses = count(text_of(out_ + "/trajectory.txt"), "\n");
    EXPECT_GE(poses, pace == "lockstep" ? 150 : 120) << pace;
  }
}

INSTANTIATE_TEST_SUITE_P(Vendors, PausedRun, testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& test) { return test.param; });

/// Every message of a run that ROS 2 sees has the frames of the table in docs/frames.md.

/// "nav_msgs/Odometry", as a recording has it.
std::string dds_type(std::string plain) {
  return ros2::dds_type(plain.insert(plain.find('/'), "/msg"));
}

/// Adds the frames of all headers in a message. A header that names none has no frame.
void add_links(const nlohmann::ordered_json& value, Links& links) {
  if (value.is_object() && value.contains("header")) {
    const std::string frame = value["header"].value("frame_id", "");
    if (!frame.empty()) links.insert(test_support::link(frame, value.value("child_frame_id", "")));
  }
  if (!value.is_structured()) return;
  for (const auto& part : value) add_links(part, links);
}

TEST(RunFrames, are_those_of_the_table) {
  const ScratchFolder scratch;
  RtdCommand rtd;
  const std::string recording = scratch / "run.mcap";
  ASSERT_EQ(rtd.run({"run", "--source", "synthetic:office?frames=60&people=1", "--pace", "lockstep", "--dense",
                     "--record", recording, "--out", scratch / "out", "--domain", "92"}),
            0)
      << rtd.output();
  const auto reader = recordings::open_reader(recording);
  std::map<std::string, Links> seen;
  std::vector<std::string> topics;
  for (const auto& topic : reader->topics())
    if (topic.name.starts_with("/")) topics.push_back(topic.name);
  reader->play(topics);
  while (const auto message = reader->next()) {
    add_links(ros2::message_json(dds_type(message->type), message->bytes, 100), seen[ros2::dds_topic(message->topic)]);
  }
  std::erase_if(seen, [](const auto& entry) { return entry.second.empty(); });
  std::set<std::string> names;
  for (const auto& [topic, links] : seen) names.insert(topic);
  EXPECT_THAT(names, IsSupersetOf({"rt/tf", "rt/slam/odometry", "rt/slam/path", "rt/slam/map_points", "rt/map",
                                   "rt/dense/points", "rt/camera/color/camera_info", "rt/filter/dynamic_mask"}));
  const std::map<std::string, Links> table = test_support::table_of_frames();
  for (const auto& [topic, links] : seen) {
    ASSERT_TRUE(table.contains(topic)) << topic << " is not in the table";
    for (const std::string& each : links) EXPECT_THAT(table.at(topic), Contains(each)) << topic;
  }
}

}  // namespace
}  // namespace rtd::launcher
