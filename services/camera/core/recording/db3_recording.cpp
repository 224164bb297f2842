// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "common/rosbag2/db3_reader.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/camera/core/recording/recording.hpp"

namespace rtd::camera {
namespace {

class Db3Recording final : public Recording {
 public:
  explicit Db3Recording(const std::filesystem::path& file) : Recording(file.string()), reader_(file) {
    for (const auto& [id, topic] : reader_.topics()) {
      if (topic.serialization_format == "cdr")
        topics_.push_back({topic.name, plain_type(topic.type), topic.messages, {}});
    }
    damages_ = reader_.damages();
  }

  std::optional<RecordedMessage> first(const std::string& topic) override {
    for (const rosbag2::Db3Place& place : reader_.messages({topic})) {
      if (std::optional<RecordedMessage> message = read(place)) return message;
    }
    return std::nullopt;
  }

  std::vector<std::int64_t> first_times_ns(const std::string& topic, std::size_t most) override {
    std::vector<std::int64_t> times_ns;
    for (const rosbag2::Db3Place& place : reader_.messages({topic})) {
      if (times_ns.size() == most) break;
      times_ns.push_back(place.time_ns);
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
  std::optional<RecordedMessage> read(const rosbag2::Db3Place& place) try {
    const rosbag2::Db3Topic& topic = reader_.topics().at(place.topic);
    return RecordedMessage{topic.name, place.time_ns, ros::Wire::kCdr, reader_.read(place), plain_type(topic.type)};
  } catch (const rosbag2::Db3Error& error) {
    damages_.emplace_back(error.what());
    return std::nullopt;
  }

  rosbag2::Db3Reader reader_;
  std::vector<rosbag2::Db3Place> playing_;
  std::size_t next_ = 0;
  std::vector<std::string> damages_;
};

}  // namespace

std::unique_ptr<Recording> open_db3(const std::filesystem::path& file) try {
  return std::make_unique<Db3Recording>(file);
} catch (const rosbag2::Db3Error& error) {
  throw SourceError(error.what());
}

}  // namespace rtd::camera
