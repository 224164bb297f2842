// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/camera/recording/recording.hpp"

namespace rtd::camera {

/// A recording whose reader knows the places of all messages: Reader::messages(topics) gives them in the order of
/// recording. A message whose reading throws Error is left out and reported.
template <class Reader, class Place, class Error>
class IndexedRecording : public Recording {
 public:
  explicit IndexedRecording(const std::filesystem::path& file)
      : Recording(file.string()), reader_(file), damages_(reader_.damages()) {}

  std::optional<RecordedMessage> first(const std::string& topic) final {
    for (const Place& place : reader_.messages({topic})) {
      if (std::optional<RecordedMessage> message = try_read(place)) return message;
    }
    return std::nullopt;
  }

  std::vector<std::int64_t> first_times_ns(const std::string& topic, std::size_t most) final {
    std::vector<std::int64_t> times_ns;
    for (const Place& place : reader_.messages({topic})) {
      if (times_ns.size() == most) break;
      times_ns.push_back(place.time_ns);
    }
    return times_ns;
  }

  void play(const std::vector<std::string>& topics) final {
    playing_ = reader_.messages(topics);
    next_ = 0;
  }

  std::optional<RecordedMessage> next() final {
    while (next_ < playing_.size()) {
      if (std::optional<RecordedMessage> message = try_read(playing_[next_++])) return message;
    }
    return std::nullopt;
  }

  std::vector<std::string> take_damages() final { return std::exchange(damages_, {}); }

 protected:
  /// Throws Error.
  virtual RecordedMessage read(const Place& place) = 0;

  Reader reader_;

 private:
  std::optional<RecordedMessage> try_read(const Place& place) {
    try {
      return read(place);
    } catch (const Error& error) {
      damages_.emplace_back(error.what());
      return std::nullopt;
    }
  }

  std::vector<std::string> damages_;
  std::vector<Place> playing_;
  std::size_t next_ = 0;
};

}  // namespace rtd::camera
