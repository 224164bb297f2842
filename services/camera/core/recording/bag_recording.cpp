// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/recording/recording.hpp"

#include <utility>

#include "common/rosbag1/bag_reader.hpp"
#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {
namespace {

class BagRecording final : public Recording {
 public:
  explicit BagRecording(const std::filesystem::path& file) : Recording(file.string()), reader_(file) {
    for (const rosbag1::Topic& topic : reader_.topics()) topics_.push_back({topic.name, topic.type, topic.messages});
    damages_ = reader_.damages();
  }

  std::optional<RecordedMessage> first(const std::string& topic) override {
    for (const rosbag1::MessagePlace& place : reader_.messages({topic})) {
      if (std::optional<RecordedMessage> message = read(place)) return message;
    }
    return std::nullopt;
  }

  std::vector<std::int64_t> first_times_ns(const std::string& topic, std::size_t most) override {
    std::vector<std::int64_t> times_ns;
    for (const rosbag1::MessagePlace& place : reader_.messages({topic})) {
      if (times_ns.size() < most) times_ns.push_back(place.time_ns);
    }
    return times_ns;
  }

  void play(const std::vector<std::string>& topics) override {
    playing_ = reader_.messages(topics);
    next_ = 0;
  }

  std::optional<RecordedMessage> next() override {
    while (next_ < playing_.size()) {
      if (std::optional<RecordedMessage> message = read(playing_[next_++])) return message;
    }
    return std::nullopt;
  }

  std::vector<std::string> take_damages() override { return std::exchange(damages_, {}); }

 private:
  std::optional<RecordedMessage> read(const rosbag1::MessagePlace& place) try {
    const ros::Bytes bytes = reader_.read(place);
    const rosbag1::Connection& from = reader_.connections().at(place.connection);
    return RecordedMessage{from.topic, place.time_ns, ros::Wire::kRos1, {bytes.begin(), bytes.end()}, from.type};
  } catch (const rosbag1::BagError& error) {
    damages_.emplace_back(error.what());
    return std::nullopt;
  }

  rosbag1::BagReader reader_;
  std::vector<rosbag1::MessagePlace> playing_;
  std::size_t next_ = 0;
  std::vector<std::string> damages_;
};

}  // namespace

std::unique_ptr<Recording> open_bag(const std::filesystem::path& file) try {
  return std::make_unique<BagRecording>(file);
} catch (const rosbag1::BagError& error) {
  throw SourceError(error.what());
}

}  // namespace rtd::camera
