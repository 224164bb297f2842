// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <gtest/gtest.h>

#include <sstream>

#include "services/launcher/core/run/record_builder.hpp"
#include "services/launcher/core/run/terminal.hpp"
#include "services/launcher/process/usage_registry.hpp"
#include "tests/support/frame_list.hpp"

namespace rtd::launcher {
namespace {

using std::chrono::milliseconds;

TEST(terminal, rewrites_one_line_and_puts_messages_above_it) {
  std::ostringstream out;
  Terminal terminal(out, {true, false, 80});
  terminal.status("frame 1", milliseconds(0));
  terminal.status("frame 2", milliseconds(100));
  terminal.warn("slam died");
  terminal.status("frame 3", milliseconds(110));
  terminal.end_status();
  EXPECT_EQ(out.str(), "\r\033[Kframe 1\r\033[Kframe 2\r\033[Kslam died\n\r\033[Kframe 3\n");
}

TEST(terminal, rewrites_ten_times_a_second_at_most) {
  std::ostringstream out;
  Terminal terminal(out, {true, false, 80});
  terminal.status("frame 1", milliseconds(0));
  terminal.status("frame 2", milliseconds(99));
  EXPECT_EQ(out.str(), "\r\033[Kframe 1");
}

TEST(terminal, cuts_the_line_to_the_terminals_width) {
  std::ostringstream out;
  Terminal terminal(out, {true, false, 6});
  terminal.status("frame 1", milliseconds(0));
  EXPECT_EQ(out.str(), "\r\033[Kframe");
}

TEST(terminal, repeats_plain_lines_every_two_seconds_without_a_terminal) {
  std::ostringstream out;
  Terminal terminal(out, {false, false, 80});
  for (int i = 0; i < 45; ++i) terminal.status("frame " + std::to_string(i), milliseconds(i * 100));
  terminal.warn("slam died");
  terminal.end_status();
  EXPECT_EQ(out.str(), "frame 0\nframe 20\nframe 40\nslam died\n");
}

TEST(terminal, shows_the_message_of_a_hostile_heartbeat_without_obeying_it) {
  std::ostringstream out;
  Terminal terminal(out, {true, false, 200});
  FrameList store;
  RecordBuilder builder(store);
  builder.add(msg::ServiceStatus{.service = "camera",
                                 .state = msg::ServiceState::kDegraded,
                                 .message = "gone\033[2J\nrtd: slam was killed\xc2\x9b"
                                            "31m"});
  terminal.warn(*builder.take_notice());
  EXPECT_EQ(out.str(), "camera: gone\\x1b[2J\\x0artd: slam was killed\\xc2\\x9b31m\n");
  terminal.status(format_live_status(builder.live()), milliseconds(0));
  EXPECT_EQ(out.str().find("\033[2J"), std::string::npos);
  EXPECT_NE(out.str().find("waiting"), 0U);
}

TEST(terminal, continues_long_lines_below) {
  std::ostringstream out;
  Terminal terminal(out, {false, false, 80});
  std::string words;
  for (int i = 0; i < 60; ++i) words += "word ";
  terminal.warn("  " + words + std::string(200, 'x'));
  std::istringstream lines(out.str());
  std::vector<std::size_t> lengths;
  for (std::string line; std::getline(lines, line);) lengths.push_back(line.size());
  ASSERT_EQ(lengths.size(), 3U);
  EXPECT_LE(lengths[0], 160U);
  EXPECT_LE(lengths[1], 160U);
  EXPECT_EQ(lengths[2], 206U) << "no word is cut";
}

TEST(terminal, colors_warnings_alone) {
  std::ostringstream out;
  Terminal terminal(out, {.interactive = true, .color = true});
  terminal.print("hello");
  terminal.warn("slam died");
  EXPECT_EQ(out.str(), "hello\n\033[33mslam died\033[0m\n");
}

TEST(terminal, quiet_shows_warnings_only) {
  std::ostringstream out;
  Terminal terminal(out, {false, true, 80});
  terminal.print("hello");
  terminal.status("frame 1", milliseconds(0));
  terminal.warn("slam died");
  EXPECT_EQ(out.str(), "slam died\n");
}

TEST(terminal, leaves_out_what_is_not_read_and_says_so) {
  std::ostringstream out;
  bool room = true;
  Terminal terminal(out, {false, false, 80, [&] { return room; }});
  terminal.warn("filter died");
  room = false;
  terminal.warn("slam died");
  terminal.status("frame 1", milliseconds(0));
  terminal.warn("dense died");
  room = true;
  terminal.warn("camera died");
  EXPECT_EQ(out.str(), "filter died\n  (2 messages left out, because the output was not read)\ncamera died\n");
}

TEST(usage_registry, adds_cpu_time_over_all_lives_and_keeps_the_highest_peak) {
  UsageRegistry book;
  book.add_sample("slam", 100, 1.0);
  book.add_sample("slam", 90, 1.9);
  EXPECT_DOUBLE_EQ(book.usage().at("slam").cpu_s, 1.9) << "it still runs";
  book.add_exit("slam", {0, 9, 2.0, 500});
  book.add_restart("slam");
  book.add_sample("slam", 120, 1.4);
  book.add_exit("slam", {0, 0, 1.5, 500});
  const run_record::ProcessUsage usage = book.usage().at("slam");
  EXPECT_DOUBLE_EQ(usage.cpu_s, 3.5);
  EXPECT_DOUBLE_EQ(usage.peak_rss_mb, 120) << "samples, not the account that holds the launcher's memory too";
  EXPECT_EQ(usage.restarts, 1);
}

TEST(usage_registry, a_process_too_short_to_be_sampled_is_taken_from_the_kernels_account) {
  UsageRegistry book;
  book.add_sample("camera", -1, 0);
  book.add_exit("camera", {0, 0, 0.1, 30});
  EXPECT_DOUBLE_EQ(book.usage().at("camera").peak_rss_mb, 30);
}

TEST(online_trajectory, has_a_line_per_tracked_frame) {
  run_record::FrameRecord tracked, lost;
  tracked.tracking.state = msg::TrackingState::kOk;
  tracked.tracking.stamp_ns = 1'305'031'102'175'304'000;
  tracked.tracking.T_world_camera = {{1, -2, 0.5}, {0, 0, 0, 1}};
  lost.tracking.state = msg::TrackingState::kLost;
  EXPECT_EQ(online_trajectory_text({tracked, lost}),
            "1305031102.175304 1.000000000 -2.000000000 0.500000000 0.000000000 0.000000000 0.000000000 1.000000000\n");
  EXPECT_EQ(online_trajectory_text({tracked}, tracked.tracking.stamp_ns), "") << "of the frames before";
  EXPECT_NE(online_trajectory_text({tracked}, tracked.tracking.stamp_ns + 1), "");
}

}  // namespace
}  // namespace rtd::launcher
