// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Every message of a run that ROS 2 sees has the frames of the table in docs/frames.md.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/recordings/reader.hpp"
#include "common/ros2/message_json.hpp"
#include "common/ros2/names.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/frames_table.hpp"

namespace rtd::launcher {
namespace {

using test_support::Links;
using ::testing::Contains;
using ::testing::IsSupersetOf;

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
