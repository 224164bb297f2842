// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "tests/bench/rtd_bench/transport/transport_case.hpp"
#include "tests/support/frame_header.hpp"

namespace rtd::bench {

/// What a message is for.
enum class Phase : std::uint64_t { kWarmUp = 0, kLatency = 1, kFlood = 2 };

/// Rides in each message.
struct Tag {
  Phase phase = Phase::kWarmUp;
  std::uint64_t number = 0;
  std::int64_t sent_ns = 0;  ///< CLOCK_MONOTONIC

  std::uint64_t packed() const { return number << 2U | static_cast<std::uint64_t>(phase); }
  static Tag unpack(std::uint64_t packed, std::int64_t sent_ns) {
    return {static_cast<Phase>(packed & 3U), packed >> 2U, sent_ns};
  }
};

constexpr std::int64_t kNsPerS = 1'000'000'000;

inline msg::Header header_of(const Tag& tag) {
  return {{static_cast<std::int32_t>(tag.sent_ns / kNsPerS), static_cast<std::uint32_t>(tag.sent_ns % kNsPerS)},
          std::to_string(tag.packed())};
}
inline Tag tag_of(const msg::Header& header) {
  return Tag::unpack(std::stoull(header.frame_id), header.stamp.sec * kNsPerS + header.stamp.nanosec);
}

template <std::uint32_t kWidth, std::uint32_t kHeight>
void put(const Tag& tag, msg::SizedFrame<kWidth, kHeight>& frame) {
  frame.seq = tag.packed();
  frame.published_ns = tag.sent_ns;
}
inline void put(const Tag& tag, msg::FeatureFrame& features) {
  features.seq = tag.packed();
  features.published_ns = tag.sent_ns;
}
inline void put(const Tag& tag, msg::CompressedImage& image) {
  image.header = header_of(tag);
}
inline void put(const Tag& tag, msg::PoseStamped& pose) {
  pose.header = header_of(tag);
}

template <std::uint32_t kWidth, std::uint32_t kHeight>
Tag tag_of(const msg::SizedFrame<kWidth, kHeight>& frame) {
  return Tag::unpack(frame.seq, frame.published_ns);
}
inline Tag tag_of(const msg::FeatureFrame& features) {
  return Tag::unpack(features.seq, features.published_ns);
}
inline Tag tag_of(const msg::CompressedImage& image) {
  return tag_of(image.header);
}
inline Tag tag_of(const msg::PoseStamped& pose) {
  return tag_of(pose.header);
}

/// New content for every message, as a producer writes it.
template <std::uint32_t kWidth, std::uint32_t kHeight>
void fill(msg::SizedFrame<kWidth, kHeight>& frame, std::uint64_t number) {
  test_support::fill_header(frame, kWidth, kHeight);
  std::memset(frame.color_bgr.data(), static_cast<int>(number), sizeof(frame.color_bgr));
  std::memset(frame.depth.data(), static_cast<int>(number), sizeof(frame.depth));
}
inline void fill(msg::FeatureFrame& features, std::uint64_t number) {
  features = {};
  test_support::fill_camera(features, 640, 480);
  features.count = msg::kMaxFeatures;
  for (msg::Feature& feature : features.features) feature.descriptor.fill(static_cast<std::uint8_t>(number));
}
inline void fill(msg::CompressedImage& image, std::uint64_t number) {
  image.format = "jpeg";
  image.data.assign(300'000, static_cast<std::uint8_t>(number));
}
inline void fill(msg::PoseStamped&, std::uint64_t) {}

template <class T>
std::size_t payload_bytes(const T& message) {
  if constexpr (std::is_same_v<T, msg::CompressedImage>) {
    return message.data.size();
  } else {
    return sizeof(T);
  }
}

inline constexpr bus::Topic<msg::TrackingResult> kAckTopic{"rtd/bench/ack", bus::QosProfile::kTracking};

/// Runs `use` with the topic of a case: its message type and a profile that leads along its path.
template <class Use>
auto with_topic(const TransportCase& what, const Use& use) {
  const bool raw = what.path == Path::kSharing;
  const auto fixed = raw ? bus::QosProfile::kRawFrame : bus::QosProfile::kFeatures;
  switch (what.payload) {
    case Payload::kFrame:
      return use(bus::Topic<msg::RgbdFrame>{"rtd/bench/frame", fixed});
    case Payload::kFrame848:
      return use(bus::Topic<msg::RgbdFrame848>{"rtd/bench/frame_848x480", fixed});
    case Payload::kFrame1280:
      return use(bus::Topic<msg::RgbdFrame1280>{"rtd/bench/frame_1280x720", fixed});
    case Payload::kFrame1920:
      return use(bus::Topic<msg::RgbdFrame1920>{"rtd/bench/frame_1920x1200", fixed});
    case Payload::kJpeg:
      return use(bus::Topic<msg::CompressedImage>{"rtd/bench/jpeg", bus::QosProfile::kNetworkFrame});
    case Payload::kFeatures:
      return use(bus::Topic<msg::FeatureFrame>{"rtd/bench/features", fixed});
    case Payload::kPose:
      break;
  }
  return use(bus::Topic<msg::PoseStamped>{"rtd/bench/pose", bus::QosProfile::kPose});
}

}  // namespace rtd::bench
