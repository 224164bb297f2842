// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/frame_source.hpp"
#include "common/camera/recording/indexed_recording.hpp"
#include "common/rosbag2/db3_reader.hpp"

namespace rtd::camera {
namespace {

class Db3Recording final : public IndexedRecording<rosbag2::Db3Reader, rosbag2::Db3Place, rosbag2::Db3Error> {
 public:
  explicit Db3Recording(const std::filesystem::path& file) : IndexedRecording(file) {
    for (const auto& [id, topic] : reader_.topics()) {
      if (topic.serialization_format == "cdr")
        topics_.push_back(
            {topic.name, plain_type(topic.type), topic.messages, {}, topic.definition_encoding, topic.definition});
    }
  }

 private:
  RecordedMessage read(const rosbag2::Db3Place& place) override {
    const rosbag2::Db3Topic& topic = reader_.topics().at(place.topic);
    return {topic.name, place.time_ns, ros::Wire::kCdr, reader_.read(place), plain_type(topic.type)};
  }
};

}  // namespace

std::unique_ptr<Recording> open_db3(const std::filesystem::path& file) {
  try {
    return std::make_unique<Db3Recording>(file);
  } catch (const rosbag2::Db3Error& error) {
    throw SourceError(error.what());
  }
}

}  // namespace rtd::camera
