// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/indexed_reader.hpp"

#include "common/mcap/recording_file.hpp"
#include "common/rosbag1/bag_reader.hpp"
#include "common/rosbag2/db3_reader.hpp"

namespace rtd::recordings {
namespace {

/// File::messages(topics) gives the places in the order of recording. A message whose reading throws Error is left out
/// and reported.
template <class File, class Place, class Error>
class PlacesReader : public IndexedReader {
 public:
  std::vector<std::int64_t> first_times_ns(const std::string& topic, std::size_t most) final {
    std::vector<std::int64_t> times_ns;
    for (const Place& place : file_.messages({topic})) {
      if (times_ns.size() == most) break;
      times_ns.push_back(place.time_ns);
    }
    return times_ns;
  }

  void play(const std::vector<std::string>& topics) final {
    playing_ = file_.messages(topics);
    next_ = 0;
  }

  std::size_t play_all() final {
    std::vector<std::string> topics;
    for (const auto& [id, channel] : channels_) topics.push_back(channel.topic);
    play(topics);
    return playing_.size();
  }

  std::optional<StoredMessage> next_stored() final {
    while (next_ < playing_.size()) {
      const Place& place = playing_[next_++];
      try {
        return read(place);
      } catch (const Error& error) {
        damages_.emplace_back(error.what());
      }
    }
    return std::nullopt;
  }

  std::optional<RecordedMessage> next() final {
    const std::optional<StoredMessage> stored = next_stored();
    if (!stored) return std::nullopt;
    const StoredChannel& from = channels_.at(stored->channel);
    const ros::Wire wire = from.encoding == "ros1" ? ros::Wire::kRos1 : ros::Wire::kCdr;
    auto unpacked = wire == ros::Wire::kCdr ? unpacked_message(stored->bytes) : std::nullopt;
    if (!unpacked) unpacked.emplace(stored->bytes.begin(), stored->bytes.end());
    return RecordedMessage{from.topic, stored->recorded_ns, wire, std::move(*unpacked), plain_type(from.type)};
  }

  std::vector<std::string> take_damages() final { return std::exchange(damages_, {}); }

 protected:
  explicit PlacesReader(const std::filesystem::path& file)
      : IndexedReader(file.string()), file_(file), damages_(file_.damages()) {}

  /// Throws Error.
  virtual StoredMessage read(const Place& place) = 0;

  File file_;

 private:
  std::vector<std::string> damages_;
  std::vector<Place> playing_;
  std::size_t next_ = 0;
};

class Bag final : public PlacesReader<rosbag1::BagReader, rosbag1::MessagePlace, rosbag1::BagError> {
 public:
  explicit Bag(const std::filesystem::path& file) : PlacesReader(file) {
    std::map<std::string, const rosbag1::Connection*> firsts;  // several publishers share a topic
    for (const auto& [id, from] : file_.connections()) {
      channels_[id] = {from.topic, from.type, "ros1", "ros1msg", from.definition, {{"md5sum", from.md5sum}}};
      firsts.try_emplace(from.topic, &from);
    }
    for (const rosbag1::Topic& topic : file_.topics()) {
      topics_.push_back({topic.name, topic.type, topic.messages, {}, "ros1msg", firsts.at(topic.name)->definition});
    }
  }

 private:
  StoredMessage read(const rosbag1::MessagePlace& place) override {
    return {place.connection, place.time_ns, file_.read(place)};
  }
};

class Db3 final : public PlacesReader<rosbag2::Db3Reader, rosbag2::Db3Place, rosbag2::Db3Error> {
 public:
  explicit Db3(const std::filesystem::path& file) : PlacesReader(file) {
    for (const auto& [id, topic] : file_.topics()) {
      StoredChannel& channel = channels_[id];
      channel = {topic.name, topic.type, topic.serialization_format, topic.definition_encoding, topic.definition, {}};
      if (!topic.offered_qos.empty()) channel.metadata["offered_qos_profiles"] = topic.offered_qos;
      if (topic.serialization_format != "cdr") continue;
      topics_.push_back(
          {topic.name, plain_type(topic.type), topic.messages, {}, topic.definition_encoding, topic.definition});
    }
  }

 private:
  StoredMessage read(const rosbag2::Db3Place& place) override {
    bytes_ = file_.read(place);
    return {place.topic, place.time_ns, bytes_};
  }

  std::vector<std::uint8_t> bytes_;
};

template <class Kind, class Error>
std::unique_ptr<IndexedReader> open_as(const std::filesystem::path& file) {
  try {
    return std::make_unique<Kind>(file);
  } catch (const Error& error) {
    throw mcap::RecordingFileError(error.what());
  }
}

}  // namespace

std::unique_ptr<IndexedReader> open_indexed(const std::filesystem::path& file, Form form) {
  return form == Form::kBag ? open_as<Bag, rosbag1::BagError>(file) : open_as<Db3, rosbag2::Db3Error>(file);
}

}  // namespace rtd::recordings
