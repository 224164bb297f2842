// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/pose_file.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>

#include "common/mcap/recording_file.hpp"
#include "common/mcap/writer.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/tracking.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::eval {
namespace {

using geometry::TrajectoryError;
using rtd::test::BagWriter;
using rtd::test::TemporaryFile;
using rtd::test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;

constexpr std::int64_t kSecond = 1'000'000'000;

class PoseFileTest : public testing::Test {
 protected:
  void refuses(const std::string& argument, const std::string& place, const std::string& cause,
               const MissingStamps& stamps = {}) const {
    EXPECT_THAT([&] { read_pose_file(argument, stamps); },
                ThrowsMessage<TrajectoryError>(AllOf(HasSubstr(place), HasSubstr(cause))));
  }

  TemporaryFolder folder_;
};

TEST_F(PoseFileTest, kitti_with_a_rate_is_stamped_by_index) {
  const std::string file = folder_.write("00.txt", "1 0 0 1.5 0 1 0 2 0 0 1 3e0\n0 -1 0 4 1 0 0 5 0 0 1 6\n");
  const PoseFile read = read_pose_file(file, {10, ""});
  ASSERT_THAT(read.poses, SizeIs(2));
  EXPECT_TRUE(read.took_stamps);
  EXPECT_EQ(read.poses[1].stamp_ns, kSecond / 10);
  EXPECT_EQ(read.poses[0].T_world_body.translation(), Eigen::Vector3d(1.5, 2, 3));
  EXPECT_LT((read.poses[1].T_world_body * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(4, 6, 6)).norm(), 1e-12);
}

TEST_F(PoseFileTest, kitti_with_times_takes_one_a_line) {
  const std::string file = folder_.write("00.txt", "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 4 0 1 0 5 0 0 1 6\n");
  const std::string times = folder_.write("times.txt", "0.000000e+00\n1.036224e-01\n");
  EXPECT_EQ(read_pose_file(file, {0, times}).poses[1].stamp_ns, 103'622'400);
  const std::string more = folder_.write("more.txt", "0\n1\n2\n");
  refuses(file, "00.txt", "has 2 poses, but there are 3 stamps", {0, more});
  refuses(file, "back.txt", "its stamps do not rise", {0, folder_.write("back.txt", "1\n0.5\n")});
}

TEST_F(PoseFileTest, kitti_without_stamps_is_numbered_and_other_rows_are_refused) {
  const std::string one = "1 0 0 1 0 1 0 2 0 0 1 3\n";
  EXPECT_TRUE(read_pose_file(folder_.write("00.txt", one), {}).numbered);
  refuses(folder_.write("a.txt", one + "1 2 3\n"), "a.txt:2", "3 numbers instead of 12", {10, ""});
  refuses(folder_.write("b.txt", one + "1 0 0 1 0 1 0 x 0 0 1 3\n"), "b.txt:2", "'x' is not a number", {10, ""});
  refuses(folder_.write("c.txt", one + "2 0 0 1 0 1 0 2 0 0 1 3\n"), "c.txt:2", "no rotation", {10, ""});
  refuses(folder_.write("d.txt", one + "-1 0 0 1 0 1 0 2 0 0 1 3\n"), "d.txt:2", "no rotation", {10, ""});
  const PoseFile lost = read_pose_file(folder_.write("e.txt", "1 0 0 nan 0 1 0 2 0 0 1 3\n" + one), {10, ""});
  ASSERT_THAT(lost.poses, SizeIs(1));
  EXPECT_EQ(lost.poses[0].stamp_ns, kSecond / 10) << "a row of nan has its place";
  EXPECT_THAT(lost.notes, testing::ElementsAre(HasSubstr("1 row of nan left out")));
}

constexpr char kStates[] =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
    "v_RS_R_x [m s^-1], b_w_RS_S_x [rad s^-1]\r\n"
    "1403636580838555648,4.688319,-1.786938,0.783338,0.6,0.8,0,0,-0.027876,0.1\r\n"
    "1403636580843555328,4.688177,-1.786770,0.787350,0.6,0.8,0,0,-0.029272,0.1\r\n";

TEST_F(PoseFileTest, euroc_states_are_read_by_the_names_of_their_columns) {
  const PoseFile read = read_pose_file(folder_.write("data.csv", kStates), {});
  ASSERT_THAT(read.poses, SizeIs(2));
  EXPECT_EQ(read.poses[1].stamp_ns, 1403636580843555328);
  EXPECT_EQ(read.poses[0].T_world_body.translation(), Eigen::Vector3d(4.688319, -1.786938, 0.783338));
  EXPECT_NEAR(Eigen::Quaterniond(read.poses[0].T_world_body.linear()).x(), 0.8, 1e-12);
}

TEST_F(PoseFileTest, euroc_columns_may_have_another_order_and_the_title_may_be_absent) {
  const std::string swapped = folder_.write(
      "a.csv", "#timestamp [ns], p_x, p_y, p_z, q_x, q_y, q_z, q_w\n1403636580838555648,1,2,3,0.8,0,0,0.6\n");
  const std::string bare = folder_.write("b.csv", "1403636580838555648,1,2,3,0.6,0.8,0,0\n");
  for (const std::string& file : {swapped, bare}) {
    const Eigen::Quaterniond q(read_pose_file(file, {}).poses.at(0).T_world_body.linear());
    EXPECT_NEAR(q.x(), 0.8, 1e-12) << file;
    EXPECT_NEAR(q.w(), 0.6, 1e-12) << file;
  }
}

TEST_F(PoseFileTest, euroc_titles_may_lack_their_mark_and_rows_of_nan_are_left_out) {
  const PoseFile read = read_pose_file(
      folder_.write("a.csv",
                    "timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z\n10,1,2,3,1,0,0,0\n20,nan,nan,nan,nan,nan,nan,nan\n"),
      {});
  EXPECT_THAT(read.poses, SizeIs(1));
  ASSERT_THAT(read.notes, SizeIs(1));
  EXPECT_THAT(read.notes[0], HasSubstr("1 row of nan left out"));
}

TEST_F(PoseFileTest, malformed_euroc_is_refused_with_its_line) {
  const std::string title = "#timestamp [ns], p_x, p_y, p_z, q_w, q_x, q_y, q_z\n", row = "10,1,2,3,1,0,0,0\n";
  refuses(folder_.write("a.csv", title + row + "20,1,2\n"), "a.csv:3", "3 columns instead of at least 8");
  refuses(folder_.write("b.csv", title + row + "1.5,1,2,3,1,0,0,0\n"), "b.csv:3", "not a stamp in nanoseconds");
  refuses(folder_.write("c.csv", title + row + "20,1,2,3,1,1,0,0\n"), "c.csv:3", "quaternion has length 1.41");
  refuses(folder_.write("e.csv", "#timestamp [ns], p_x, p_y\n" + row), "e.csv:1", "names no column p_z");
  refuses(folder_.write("f.csv", title), "f.csv", "holds no poses");
}

TEST_F(PoseFileTest, tum_is_read_as_before) {
  const std::string file = folder_.write("tum.txt", "# title\n1.5 1 2 3 0 0 0 1\n");
  EXPECT_EQ(read_pose_file(file, {}).poses.at(0).stamp_ns, 1'500'000'000);
  refuses(folder_.write("seven.txt", "1.5 1 2 3 0 0 0\n"), "seven.txt:1", "7 columns instead of 8");
  refuses("/absent/tum.txt", "/absent/tum.txt", "No such file");
  refuses(file + "?topic=/x", "tum.txt", "topic and child are for recordings");
  refuses(file + "?tpic=/x", "tpic=/x", "expected: FILE?topic=TOPIC");
}

TEST_F(PoseFileTest, only_a_pipe_that_the_user_hands_over_is_read) {
  ASSERT_EQ(mkfifo((folder_.path() / "groundtruth.txt").c_str(), 0600), 0);
  refuses(folder_.path() / "groundtruth.txt", "groundtruth.txt", "is a pipe, not a regular file");
  std::filesystem::create_symlink("/dev/zero", folder_.path() / "zero.txt");
  refuses(folder_.path() / "zero.txt", "zero.txt", "is a device, not a regular file");
  std::filesystem::resize_file(folder_.write("sparse.txt", ""), 30'000'000'000);
  refuses(folder_.path() / "sparse.txt", "sparse.txt", "has 30 GB, at most 256 MB are read as a list of poses");
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  ASSERT_EQ(write(ends[1], "1.5 1 2 3 0 0 0 1\n", 18), 18);
  close(ends[1]);
  EXPECT_THAT(read_pose_file("/dev/fd/" + std::to_string(ends[0]), {}).poses, SizeIs(1));
  close(ends[0]);
}

msg::Header header_at(std::int64_t stamp_ns, const std::string& frame = "map") {
  return {msg::to_time(stamp_ns), frame};
}

msg::PoseStamped pose_at(std::int64_t stamp_ns, double x) {
  msg::PoseStamped pose;
  pose.header = header_at(stamp_ns);
  pose.pose.position.x = x;
  return pose;
}

msg::TransformStamped transform_at(std::int64_t stamp_ns, const std::string& child, double x,
                                   const std::string& parent = "map") {
  msg::TransformStamped stamped;
  stamped.header = header_at(stamp_ns, parent);
  stamped.child_frame_id = child;
  stamped.transform.translation.x = x;
  return stamped;
}

/// A bag that a test puts together.
class Bag {
 public:
  template <class Message>
  void add(const std::string& topic, const std::string& type, const Message& message) {
    if (!ids_.contains(topic)) ids_[topic] = writer_.connection(topic, type);
    writer_.message(ids_[topic], ++time_ * kSecond, ros::encode<ros::Wire::kRos1>(message));
  }
  void add_bytes(const std::string& topic, const std::vector<std::uint8_t>& bytes) {
    writer_.message(ids_.at(topic), ++time_ * kSecond, bytes);
  }
  std::string bytes() { return writer_.closed(); }

 private:
  BagWriter writer_;
  std::map<std::string, std::uint32_t> ids_;
  std::int64_t time_ = 0;
};

TEST_F(PoseFileTest, the_only_poses_of_a_bag_are_found_and_sorted_by_their_stamps) {
  Bag bag;
  bag.add("/pose", "geometry_msgs/PoseStamped", pose_at(3 * kSecond, 3));
  bag.add("/pose", "geometry_msgs/PoseStamped", pose_at(2 * kSecond, 2));
  bag.add("/tf", "tf/tfMessage", msg::TFMessage{{transform_at(kSecond, "wheel", 1)}});
  const TemporaryFile file("x.bag", bag.bytes());
  const PoseFile read = read_pose_file(file.path().string(), {});
  ASSERT_THAT(read.poses, SizeIs(2));
  EXPECT_EQ(read.poses[0].stamp_ns, 2 * kSecond);
  EXPECT_EQ(read.poses[0].T_world_body.translation().x(), 2);
  EXPECT_THAT(read.damages, IsEmpty());
}

TEST_F(PoseFileTest, several_topics_are_listed_and_one_is_named) {
  Bag bag;
  bag.add("/pose", "geometry_msgs/PoseStamped", pose_at(kSecond, 1));
  msg::Odometry odometry;
  odometry.header = header_at(kSecond);
  odometry.pose.pose.position.x = 7;
  bag.add("/odom", "nav_msgs/Odometry", odometry);
  bag.add("/vicon", "geometry_msgs/TransformStamped", transform_at(kSecond, "body", 8));
  bag.add("/text", "std_msgs/Header", header_at(1));
  const TemporaryFile file("x.bag", bag.bytes());
  const std::string path = file.path().string();
  refuses(path, "x.bag",
          "several topics of poses; name one:\n  FILE?topic=/odom (nav_msgs/Odometry)\n  FILE?topic=/pose");
  EXPECT_EQ(read_pose_file(path + "?topic=/odom", {}).poses.at(0).T_world_body.translation().x(), 7);
  EXPECT_EQ(read_pose_file(path + "?topic=/vicon", {}).poses.at(0).T_world_body.translation().x(), 8);
  refuses(path + "?topic=/text", "x.bag", "is of type std_msgs/Header; expected: PoseStamped");
  refuses(path + "?topic=/absent", "x.bag", "has no topic /absent; its topics are:\n  /odom");
}

TEST_F(PoseFileTest, tf_is_read_by_child_frame) {
  Bag bag;
  for (int i = 1; i <= 3; ++i)
    bag.add("/tf", "tf2_msgs/TFMessage",
            msg::TFMessage{{transform_at(i * kSecond, "camera", i), transform_at(i * kSecond, "wheel", -i)}});
  const TemporaryFile file("x.bag", bag.bytes());
  const std::string path = file.path().string();
  refuses(path, "x.bag",
          "several frames; name one:\n  FILE?topic=/tf&child=camera (3 poses)\n  FILE?topic=/tf&child=wheel");
  refuses(path + "?child=lid", "x.bag", "/tf has no frame lid");
  EXPECT_EQ(read_pose_file(path + "?child=wheel", {}).poses.at(2).T_world_body.translation().x(), -3);
  EXPECT_THAT(read_pose_file(path + "?topic=/tf&child=camera", {}).poses, SizeIs(3));
}

TEST_F(PoseFileTest, a_frame_with_several_parents_is_refused) {
  Bag bag;
  bag.add("/tf", "tf2_msgs/TFMessage",
          msg::TFMessage{{transform_at(1, "camera", 1, "map"), transform_at(2, "camera", 1, "odom")}});
  const TemporaryFile file("x.bag", bag.bytes());
  refuses(file.path().string(), "x.bag", "several parents: map and odom");
}

TEST_F(PoseFileTest, damaged_messages_are_left_out_and_named) {
  Bag bag;
  bag.add("/pose", "geometry_msgs/PoseStamped", pose_at(kSecond, 1));
  bag.add_bytes("/pose", {1, 2, 3});
  const TemporaryFile file("x.bag", bag.bytes());
  const PoseFile read = read_pose_file(file.path().string(), {});
  EXPECT_THAT(read.poses, SizeIs(1));
  ASSERT_THAT(read.damages, SizeIs(1));
  EXPECT_THAT(read.damages[0], HasSubstr("message recorded at 2000000000 ns of /pose"));
}

TEST_F(PoseFileTest, a_pose_without_rotation_and_a_bag_without_poses_are_refused) {
  Bag bag;
  auto pose = pose_at(kSecond, 1);
  pose.pose.orientation.w = 0;
  bag.add("/pose", "geometry_msgs/PoseStamped", pose);
  const TemporaryFile file("x.bag", bag.bytes());
  refuses(file.path().string(), "/pose, stamp 1000000000 ns", "quaternion has length 0");
  Bag other;
  other.add("/text", "std_msgs/Header", header_at(1));
  const TemporaryFile none("y.bag", other.bytes());
  refuses(none.path().string(), "y.bag", "has no poses");
}

TEST_F(PoseFileTest, an_mcap_file_gives_poses_with_covariance) {
  io::MemorySink sink;
  mcap::Writer writer(sink, {});
  const auto schema = writer.add(mcap::Schema{0, "geometry_msgs/msg/PoseWithCovarianceStamped", "ros2msg", ""});
  const auto channel = writer.add(mcap::Channel{0, schema, "/pose", "cdr", {}});
  auto cdr = ros::encode<ros::Wire::kCdr>(pose_at(kSecond, 5));  // begins with the same fields
  cdr.resize(cdr.size() + 36 * sizeof(double));
  writer.write(mcap::Message{channel, 0, 9, 9, std::as_bytes(std::span(cdr))});
  writer.close();
  const TemporaryFile file("x.mcap", {reinterpret_cast<const char*>(sink.bytes().data()), sink.bytes().size()});
  EXPECT_EQ(read_pose_file(file.path().string(), {}).poses.at(0).T_world_body.translation().x(), 5);
}

/// A recording of the results of slam: three frames, the last one lost.
std::string recorded_results() {
  io::MemorySink sink;
  mcap::Writer writer(sink, {});
  const auto schema = writer.add(mcap::Schema{0, "rtd_msgs::TrackingResult", "omgidl", ""});
  const auto channel = writer.add(mcap::Channel{0, schema, "rtd/tracking", "cdr", {}});
  for (const std::int64_t stamp_ns : {2, 1, 2, 3}) {
    msg::TrackingResult result{};
    result.stamp_ns = stamp_ns * kSecond;
    result.state = stamp_ns == 3 ? msg::TrackingState::kLost : msg::TrackingState::kDoubtful;
    result.T_world_camera = {{static_cast<double>(stamp_ns), 0, 0}, {0, 0, 0, 1}};
    const auto cdr = ros::encode<ros::Wire::kCdr>(result);
    writer.write(mcap::Message{channel, 0, 9, 9, std::as_bytes(std::span(cdr))});
  }
  writer.close();
  return {reinterpret_cast<const char*>(sink.bytes().data()), sink.bytes().size()};
}

TEST_F(PoseFileTest, results_of_slam_come_with_their_states) {
  const TemporaryFile file("x.mcap", recorded_results());
  const PoseFile read = read_pose_file(file.path().string() + "?topic=rtd/tracking", {});
  ASSERT_THAT(read.published, SizeIs(3));
  EXPECT_EQ(read.published[0].stamp_ns, kSecond);
  EXPECT_EQ(read.published[1].state, msg::TrackingState::kDoubtful);
  EXPECT_EQ(read.published[2].state, msg::TrackingState::kLost);
  ASSERT_THAT(read.poses, SizeIs(2));
  EXPECT_EQ(read.poses[1].T_world_body.translation().x(), 2);
}

TEST_F(PoseFileTest, other_files_have_no_states) {
  EXPECT_THAT(read_pose_file(folder_.write("data.csv", kStates), {}).published, IsEmpty());
}

TEST_F(PoseFileTest, a_file_that_only_ends_as_a_recording_is_refused) {
  EXPECT_THROW(read_pose_file(folder_.write("x.mcap", "no recording"), {}), mcap::RecordingFileError);
}

}  // namespace
}  // namespace rtd::eval
