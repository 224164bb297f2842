// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/indexed_recording.hpp"

#include "common/camera/frame_source.hpp"
#include "common/rosbag1/bag_reader.hpp"

namespace rtd::camera {
namespace {

class BagRecording final : public IndexedRecording<rosbag1::BagReader, rosbag1::MessagePlace, rosbag1::BagError> {
 public:
  explicit BagRecording(const std::filesystem::path& file) : IndexedRecording(file) {
    for (const rosbag1::Topic& topic : reader_.topics())
      topics_.push_back({topic.name, topic.type, topic.messages, {}, "ros1msg", definition_of(topic)});
  }

 private:
  std::string definition_of(const rosbag1::Topic& topic) const {
    for (const auto& [id, connection] : reader_.connections()) {
      if (connection.topic == topic.name && connection.type == topic.type) return connection.definition;
    }
    return {};
  }

  RecordedMessage read(const rosbag1::MessagePlace& place) override {
    const ros::Bytes bytes = reader_.read(place);
    const rosbag1::Connection& from = reader_.connections().at(place.connection);
    return {from.topic, place.time_ns, ros::Wire::kRos1, {bytes.begin(), bytes.end()}, from.type};
  }
};

}  // namespace

std::unique_ptr<Recording> open_bag(const std::filesystem::path& file) {
  try {
    return std::make_unique<BagRecording>(file);
  } catch (const rosbag1::BagError& error) {
    throw SourceError(error.what());
  }
}

}  // namespace rtd::camera
