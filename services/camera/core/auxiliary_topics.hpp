// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/msg/ros.hpp"
#include "common/recordings/reader.hpp"

namespace rtd::camera {

/// What a run asks for of a recording with its frames: messages of an IMU and of wheels, in the order of
/// recording, as far as the frames have come. Not thread-safe.
class AuxiliaryTopics {
 public:
  /// No message is read farther ahead of a frame: a topic may have ended long before another.
  static constexpr std::int64_t kAheadNs = 500'000'000;
  /// What is older than that before the first frame is left out.
  static constexpr std::int64_t kBeforeNs = 2'000'000'000;

  /// `topics`: sensor_msgs/Imu or nav_msgs/Odometry, by their names in the recording.
  AuxiliaryTopics(std::unique_ptr<recordings::Reader> recording, const std::vector<std::string>& topics);

  /// Those not given yet, of each topic up to its first message that is not before the frame of this stamp. In CDR,
  /// whatever the recording has.
  std::vector<recordings::RecordedMessage> until(std::int64_t stamp_ns);
  std::uint64_t unreadable() const { return unreadable_; }

 private:
  bool complete(std::int64_t stamp_ns) const;

  const std::unique_ptr<recordings::Reader> recording_;
  std::map<std::string, std::int64_t> newest_ns_;  ///< by topic: stamps
  bool begun_ = false, ended_ = false;
  std::uint64_t unreadable_ = 0;
};

/// The transforms of a recording that last: all of tf_static, and of tf the first of each frame that tf_static does not
/// have (ROS 1 knew no tf_static at first). Ends what was played before. Empty when there are none.
msg::TFMessage lasting_transforms(recordings::Reader& recording);

}  // namespace rtd::camera
