// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/pose_file.hpp"

#include <algorithm>
#include <functional>
#include <map>

#include "common/msg/ros.hpp"
#include "common/msg/tracking.hpp"
#include "common/recordings/reader.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::msg {

struct PoseWithCovarianceStamped {
  Header header;
  PoseWithCovariance pose;
};
RTD_FIELDS(geometry_msgs, PoseWithCovarianceStamped, header, pose)

}  // namespace rtd::msg

namespace rtd::eval {
namespace {

using geometry::StampedPose;
using geometry::TrajectoryError;
using recordings::RecordedMessage;
using recordings::RecordedTopic;

/// A pose of a message, and the frames that it is between.
struct FramedPose {
  msg::Header header;
  std::string child;
  msg::Pose pose;
};
using Decode = std::vector<FramedPose> (*)(const RecordedMessage&);

msg::Pose pose_of(const msg::RosTransform& transform) {
  const auto& [x, y, z] = transform.translation;
  return {{x, y, z}, transform.rotation};
}

std::vector<FramedPose> from_pose(const RecordedMessage& message) {
  const auto pose = ros::decode<msg::PoseStamped>(message.wire, message.bytes);
  return {{pose.header, {}, pose.pose}};
}

std::vector<FramedPose> from_covariance(const RecordedMessage& message) {
  const auto pose = ros::decode<msg::PoseWithCovarianceStamped>(message.wire, message.bytes);
  return {{pose.header, {}, pose.pose.pose}};
}

std::vector<FramedPose> from_odometry(const RecordedMessage& message) {
  const auto odometry = ros::decode<msg::Odometry>(message.wire, message.bytes);
  return {{odometry.header, odometry.child_frame_id, odometry.pose.pose}};
}

std::vector<FramedPose> from_transform(const RecordedMessage& message) {
  const auto stamped = ros::decode<msg::TransformStamped>(message.wire, message.bytes);
  return {{stamped.header, stamped.child_frame_id, pose_of(stamped.transform)}};
}

std::vector<FramedPose> from_tf(const RecordedMessage& message) {
  std::vector<FramedPose> poses;
  for (const auto& stamped : ros::decode<msg::TFMessage>(message.wire, message.bytes).transforms)
    poses.push_back({stamped.header, stamped.child_frame_id, pose_of(stamped.transform)});
  return poses;
}

const std::map<std::string, Decode>& pose_types() {
  static const std::map<std::string, Decode> kTypes = {{"geometry_msgs/PoseStamped", from_pose},
                                                       {"geometry_msgs/PoseWithCovarianceStamped", from_covariance},
                                                       {"geometry_msgs/TransformStamped", from_transform},
                                                       {"nav_msgs/Odometry", from_odometry}};
  return kTypes;
}

/// As they are named in a recording of ROS, or with the prefix of DDS.
bool is_called(const std::string& topic, const std::string& name) {
  return topic == name || (topic.starts_with("rt/") && topic.substr(2) == name);
}

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += "\n  " + name;
  return text;
}

class PoseReader {
 public:
  PoseReader(recordings::Reader& recording, const PoseChoice& choice) : recording_(recording), choice_(choice) {}

  PoseFile run() {
    const RecordedTopic* const results = recordings::topic_named(recording_, choice_.topic);
    if (results != nullptr && results->type == "rtd_msgs/TrackingResult") {
      read_results(results->name);
    } else {
      read_poses(choose());
    }
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(const std::string& cause) const { throw TrajectoryError(recording_.name() + ": " + cause); }

  const RecordedTopic& choose() const {
    if (!choice_.topic.empty()) return named();
    std::vector<const RecordedTopic*> poses, transforms;
    for (const RecordedTopic& topic : recording_.topics()) {
      if (topic.messages == 0 || topic.name.ends_with("/tf_static")) continue;
      if (pose_types().contains(topic.type)) poses.push_back(&topic);
      if (is_tf(topic)) transforms.push_back(&topic);
    }
    const auto& found = !choice_.child.empty() && !transforms.empty() ? transforms : poses.empty() ? transforms : poses;
    if (found.size() == 1) return *found.front();
    if (found.empty())
      fail("has no poses (PoseStamped, PoseWithCovarianceStamped, TransformStamped, Odometry, tf); its topics are:\n" +
           list_topics(recording_));
    std::vector<std::string> names;
    for (const auto* one : poses) names.push_back("FILE?topic=" + one->name + " (" + one->type + ")");
    for (const auto* one : transforms) names.push_back("FILE?topic=" + one->name + "&child=FRAME (" + one->type + ")");
    fail("has several topics of poses; name one:" + list_of(names));
  }

  const RecordedTopic& named() const {
    for (const RecordedTopic& topic : recording_.topics()) {
      if (!is_called(topic.name, choice_.topic)) continue;
      if (is_tf(topic) || pose_types().contains(topic.type)) return topic;
      fail("topic " + choice_.topic + " is of type " + topic.type +
           "; expected: PoseStamped, PoseWithCovarianceStamped, TransformStamped, Odometry or tf");
    }
    fail("has no topic " + choice_.topic + "; its topics are:\n" + list_topics(recording_));
  }

  void read_poses(const RecordedTopic& topic) {
    const Decode decode = is_tf(topic) ? from_tf : pose_types().at(topic.type);
    std::map<std::string, std::vector<FramedPose>> by_child;
    read(topic.name, [&](const RecordedMessage& message) {
      for (FramedPose& pose : decode(message)) by_child[pose.child].push_back(std::move(pose));
    });
    const bool framed = is_tf(topic) || !choice_.child.empty();
    const std::string wanted = framed ? choose_child(by_child, topic.name) : "";
    for (auto& [child, poses] : by_child) {
      if (!framed || child == wanted) add(poses, topic.name);
    }
    // By stamps: publishers overtake each other. Of equal stamps the last counts.
    std::ranges::stable_sort(file_.poses, {}, &StampedPose::stamp_ns);
    file_.poses = geometry::each_stamp_once(file_.poses);
    if (file_.poses.empty()) fail("topic " + topic.name + " has no poses that can be read");
  }

  void read_results(const std::string& topic) {
    std::vector<PublishedPose>& published = file_.published;
    read(topic, [&](const RecordedMessage& message) {
      published.push_back(published_pose(ros::decode<msg::TrackingResult>(message.wire, message.bytes)));
    });
    // A frame that was sent again has the same result again.
    std::ranges::stable_sort(published, {}, &PublishedPose::stamp_ns);
    const auto repeated = std::ranges::unique(published, {}, &PublishedPose::stamp_ns);
    published.erase(repeated.begin(), repeated.end());
    file_.poses = measured_poses(published);
    if (file_.poses.empty()) fail("topic " + topic + " has no measured pose");
  }

  void read(const std::string& topic, const auto& take) {
    recording_.play({topic});
    while (const auto message = recording_.next()) {
      try {
        take(*message);
      } catch (const ros::WireError& error) {
        note("message recorded at " + std::to_string(message->recorded_ns) + " ns of " + topic + ": " + error.what());
      }
    }
    for (const std::string& damage : recording_.take_damages()) note(damage);
  }

  void note(const std::string& damage) {
    constexpr std::size_t kMax = 20;
    if (file_.damages.size() < kMax) file_.damages.push_back(recording_.name() + ": " + damage);
  }

  std::string choose_child(const std::map<std::string, std::vector<FramedPose>>& by_child,
                           const std::string& topic) const {
    if (choice_.child.empty() && by_child.size() == 1) return by_child.begin()->first;
    if (by_child.contains(choice_.child)) return choice_.child;
    std::vector<std::string> names;
    for (const auto& [child, poses] : by_child)
      names.push_back("FILE?topic=" + topic + "&child=" + child + " (" + std::to_string(poses.size()) + " poses)");
    fail((choice_.child.empty() ? topic + " has the poses of several frames"
                                : topic + " has no frame " + choice_.child) +
         "; name one:" + list_of(names));
  }

  void add(const std::vector<FramedPose>& poses, const std::string& topic) {
    for (const FramedPose& one : poses) {
      if (one.header.frame_id != poses.front().header.frame_id)
        fail(topic + ": the poses of one body have several parents: " + poses.front().header.frame_id + " and " +
             one.header.frame_id);
      const auto& [x, y, z] = one.pose.position;
      const auto& q = one.pose.orientation;
      const std::int64_t stamp_ns = msg::to_ns(one.header.stamp);
      try {
        file_.poses.push_back({stamp_ns, geometry::make_pose({x, y, z}, {q.w, q.x, q.y, q.z})});
      } catch (const std::invalid_argument& error) {
        fail(topic + ", stamp " + std::to_string(stamp_ns) + " ns: " + error.what());
      }
    }
  }

  recordings::Reader& recording_;
  const PoseChoice& choice_;
  PoseFile file_;
};

}  // namespace

PoseFile read_recorded_poses(recordings::Reader& recording, const PoseChoice& choice) {
  return PoseReader(recording, choice).run();
}

}  // namespace rtd::eval
