// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/process/posix_process_host.hpp"
#include "services/launcher/core/run/record_builder.hpp"
#include "services/launcher/core/run/terminal.hpp"
#include "services/launcher/doctor/doctor_command.hpp"
#include "services/launcher/process/service_logs.hpp"
#include "services/launcher/process/usage_registry.hpp"
#include "services/launcher/run/run_command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::launcher {
namespace {

using camera::DeviceMode;
using camera::Stream;
using testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> split(const std::vector<std::string>& chunks) {
  std::vector<std::string> lines;
  const auto keep = [&](const std::string& line) { lines.push_back(line); };
  process::LineSplitter splitter;
  for (const std::string& chunk : chunks) splitter.feed(chunk, keep);
  splitter.finish(keep);
  return lines;
}

TEST(line_splitter, joins_a_line_that_came_in_pieces) {
  EXPECT_THAT(split({"one\ntw", "o\r\nth", "ree"}), ElementsAre("one", "two", "three"));
}

TEST(line_splitter, bounds_a_line_without_end) {
  const auto lines = split({std::string(10000, 'x')});
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0].size() + lines[1].size() + lines[2].size(), 10000U);
}

TEST(service_logs, keep_the_last_lines) {
  std::ostringstream out;
  Terminal terminal(out, {});
  ServiceLogs logs("/nowhere", terminal);
  for (int line = 1; line <= 20; ++line) logs.add("slam", std::to_string(line));
  const std::vector<std::string> tail = logs.tail("slam");
  ASSERT_EQ(tail.size(), 12U);
  EXPECT_EQ(tail.front(), "9");
  EXPECT_EQ(tail.back(), "20");
}

TEST(log_level, reads_the_format_of_our_services) {
  EXPECT_EQ(level_of("12:00:01.250 info slam event=started"), LogLevel::kInfo);
  EXPECT_EQ(level_of("12:00:01.250 warning slam event=tracking_lost frame=3"), LogLevel::kWarning);
  EXPECT_EQ(level_of("12:00:01.250 \033[31m\033[1merror\033[m slam event=x"), LogLevel::kError);
  EXPECT_EQ(level_of("12:00:01.250 critical slam event=x"), LogLevel::kError);
  EXPECT_EQ(level_of("rtd-slam: no such file"), LogLevel::kError);
  EXPECT_EQ(level_of("error"), LogLevel::kInfo) << "not our format";
  EXPECT_EQ(level_of(""), LogLevel::kInfo);
}

TEST(log_level, the_reason_is_the_last_error_line_else_the_tail) {
  EXPECT_THAT(reason_lines({"x", "rtd-slam: why", "y"}), ElementsAre("rtd-slam: why"));
  EXPECT_THAT(reason_lines({"--foo: unknown", "Run with --help"}), ElementsAre("--foo: unknown", "Run with --help"));
}

TEST(process_usage, reads_peak_memory) {
  EXPECT_DOUBLE_EQ(peak_rss_mb("VmPeak:\t  999 kB\nVmHWM:\t    2048 kB\nVmRSS:\t 12 kB\n"), 2.0);
  EXPECT_DOUBLE_EQ(peak_rss_mb("Name:\trtd-slam\nState:\tZ (zombie)\n"), -1.0);
}

TEST(process_usage, reads_cpu_time) {
  const std::string ticks = std::to_string(3 * sysconf(_SC_CLK_TCK));
  EXPECT_DOUBLE_EQ(cpu_s("7 (rtd (x) y) S 1 7 7 0 -1 4194560 900 0 2 0 " + ticks + ' ' + ticks + " 0 0 20"), 6.0);
  EXPECT_DOUBLE_EQ(cpu_s(""), 0.0);
}

TEST(live_status, shows_everything_in_one_short_line) {
  LiveStatus status;
  status.frames = 123;
  status.total = 210;
  EXPECT_EQ(format_live_status(status), "frame 123/210  waiting for the first pose");
  status.camera_message = "waits for detector";
  EXPECT_EQ(format_live_status(status), "frame 123/210  camera waits for detector");
  status.tracking = true;
  status.state = msg::TrackingState::kOk;
  status.frames_per_s = 29.84;
  status.inliers = 213;
  status.dynamic_points = 87;
  status.dropped = 2;
  status.latency_ms = 31.4;
  EXPECT_EQ(format_live_status(status),
            "frame 123/210  29.8 fps  ok  inliers 213  dynamic 87  dropped 2  latency 31 ms  3 s left");
  status.total = 21000;
  EXPECT_THAT(format_live_status(status), testing::EndsWith("  12 min left"));
  status.frames = status.total;
  EXPECT_THAT(format_live_status(status), testing::EndsWith(" ms"));
  status.frames = 123;
  status.total = 0;
  status.state = msg::TrackingState::kRecentlyLost;
  EXPECT_EQ(format_live_status(status),
            "frame 123  29.8 fps  recently lost  inliers 213  dynamic 87  dropped 2  latency 31 ms");
}

namespace fs = std::filesystem;

class TraceFileTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(parts_); }
  void part(const std::string& name, const std::string& text) { std::ofstream(parts_ / name) << text; }
  std::string joined() { return rtd::test::read_text(folder_ / "trace.json"); }

  const rtd::test::TemporaryFolder folder_;
  const fs::path parts_ = folder_ / "parts";
};

TEST_F(TraceFileTest, joins_the_parts_and_removes_them) {
  part("slam.2.jsonl", "{\"name\":\"b\",\"args\":{}}\n");
  part("filter.1.jsonl", "{\"name\":\"a\",\"args\":{}}\n");
  EXPECT_EQ(join_trace(parts_, folder_ / "trace.json"), "");
  EXPECT_EQ(joined(),
            "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n{\"name\":\"a\",\"args\":{}},\n{\"name\":\"b\",\"args\":{}}"
            "\n]}\n");
  EXPECT_FALSE(fs::exists(parts_));
}

TEST_F(TraceFileTest, leaves_out_what_a_killed_process_did_not_finish) {
  part("slam.2.jsonl", "{\"name\":\"b\",\"args\":{}}\n{\"name\":\"c\",\"ar");
  EXPECT_EQ(join_trace(parts_, folder_ / "trace.json"), "");
  EXPECT_THAT(joined(), testing::Not(testing::HasSubstr("\"c\"")));
}

TEST_F(TraceFileTest, says_what_it_cannot_do) {
  EXPECT_THAT(join_trace(folder_ / "none", folder_ / "trace.json"), testing::HasSubstr("No such file"));
  EXPECT_THAT(join_trace(parts_, folder_ / "none/trace.json"),
              testing::HasSubstr("none/trace.json: there is no such folder"));
}

TEST(CameraCheckTest, lists_cameras_with_their_modes_and_what_keeps_them_from_being_used) {
  const std::vector<DeviceMode> modes = {{Stream::kColor, {640, 480}, 30, "RGB8"},
                                         {Stream::kDepth, {640, 480}, 30, "Z16"}};
  Findings findings;
  describe_cameras({{"openni2:1d27/0609@1/5", "PrimeSense", modes, ""},
                    {"realsense-dds:1234", "RealSense", {modes[0]}, "it streams no depth"},
                    {"openni2:2bc5/0401@1/6", "Astra", {}, "no permission"}},
                   findings);
  ASSERT_EQ(findings.size(), 3U);
  EXPECT_EQ(findings[0].verdict, Verdict::kOk);
  EXPECT_EQ(
      findings[0].text,
      "camera: --source openni2:1d27/0609@1/5 (PrimeSense): colour 640 x 480 RGB8 30 Hz; depth 640 x 480 Z16 30 Hz");
  EXPECT_EQ(findings[1].verdict, Verdict::kOk) << "a camera of another program is no fault";
  EXPECT_THAT(findings[1].text, HasSubstr("it streams no depth"));
  EXPECT_EQ(findings[2].verdict, Verdict::kWarn);
}

TEST(CameraCheckTest, says_what_the_build_supports_when_there_is_none) {
  Findings findings;
  describe_cameras({}, findings);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].text, HasSubstr("openni2"));
}

TEST(CameraCheckTest, a_run_without_its_camera_gets_the_answer_of_the_doctor) {
  EXPECT_THAT(why_no_camera("openni2", "", {}), HasSubstr("'rtd doctor' says:\n  cameras: none is plugged in"));
  const std::vector<camera::FoundCamera> cameras = {{"openni2:1d27/0609@1/5", "PrimeSense", {}, ""},
                                                    {"openni2:2bc5/0401@1/6", "Astra", {}, "no permission"}};
  EXPECT_EQ(why_no_camera("openni2", "", cameras), "");
  EXPECT_EQ(why_no_camera("openni2", "1d27/0609@1/5", cameras), "");
  EXPECT_THAT(why_no_camera("openni2", "2bc5/0401@1/6", cameras), HasSubstr("(Astra): no permission"));
  EXPECT_THAT(why_no_camera("openni2", "1d27/0609@1/9", cameras),
              HasSubstr("camera: --source openni2:1d27/0609@1/5 (PrimeSense)"));
  const std::vector<camera::FoundCamera> on_dds = {{"realsense-dds:1234", "RealSense", {}, ""}};
  EXPECT_EQ(why_no_camera("realsense-dds", "1234", on_dds), "");
  EXPECT_THAT(why_no_camera("realsense-dds", "99", on_dds), HasSubstr("--source 'realsense-dds:99': the camera"));
}

}  // namespace
}  // namespace rtd::launcher
