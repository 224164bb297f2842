// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/ros_codec/byte_cursor.hpp"
#include "services/recorder/people/people_regions.hpp"

namespace rtd::recorder {

/// What becomes of a message.
enum class Fate {
  kKept,      ///< as it is: no image of colour or grey, or one without people
  kBlurred,   ///< people are pixelated
  kHidden,    ///< all of it is pixelated, because it is not known where people are
  kWithheld,  ///< not to be written: images that cannot be pixelated, coloured point clouds of others
};
inline constexpr std::size_t kFates = 4;

/// A topic by its name in DDS, and its type as recordings::plain_type() has it ("sensor_msgs/Image").
struct BlurTopic {
  std::string name, type;
};

/// Makes people in recorded images unrecognisable: those of the detector's camera are pixelated where its boxes and
/// masks have people, other images of colour or grey as a whole. Depth, masks and our own maps stay. All bytes are CDR.
/// Not thread-safe.
class PeopleBlur {
 public:
  struct Result {
    Fate fate = Fate::kKept;
    std::vector<std::uint8_t> cdr = {};  ///< of kBlurred and kHidden
  };

  /// Of each robot, so many of the newest batches of detections are kept.
  explicit PeopleBlur(std::size_t most_batches = std::numeric_limits<std::size_t>::max()) : most_(most_batches) {}

  /// Every message, in the order in which they came: detections, masks and the size of images are taken from it.
  void learn(const BlurTopic& topic, ros::Bytes cdr);
  /// Whether detections have come.
  bool knows_people() const;
  /// Whether a message needs no detections that may still come.
  bool settled(const BlurTopic& topic, ros::Bytes cdr) const;
  Result apply(const BlurTopic& topic, ros::Bytes cdr);
  /// How many messages met which fate, by a word for each but kKept.
  std::map<std::string, std::uint64_t> counts() const;

 private:
  struct Image;

  Result fate_of(const BlurTopic& topic, ros::Bytes cdr) const;
  template <class Message>
  Result image(const BlurTopic& topic, ros::Bytes cdr) const;
  const PeopleRegions* regions_of(const BlurTopic& topic) const;
  Fate pixelate(const BlurTopic& topic, const Image& image) const;

  std::size_t most_;
  std::map<std::string, PeopleRegions> regions_;  ///< by robot
  std::array<std::uint64_t, kFates> counts_{};
};

}  // namespace rtd::recorder
