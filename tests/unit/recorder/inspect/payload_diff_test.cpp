// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/payload_diff.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <memory>

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/tracking.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::recordings {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <class T>
std::vector<std::byte> payload(const T& message) {
  std::vector<std::byte> bytes(4 + sizeof(T));
  bytes[1] = std::byte{1};
  std::memcpy(bytes.data() + 4, &message, sizeof(T));
  return bytes;
}

TEST(PayloadDiff, names_the_field_of_a_feature_that_differs) {
  auto a = std::make_unique<msg::FeatureFrame>();
  auto b = std::make_unique<msg::FeatureFrame>();
  b->count = 7;
  b->features[12].static_probability = 0.5F;
  b->features[13].static_probability = 0.25F;
  b->features[2047].descriptor[31] = 9;
  b->stage_ms[2] = 1.5F;
  EXPECT_THAT(
      differences("rtd_msgs/msg/FeatureFrame", payload(*a), payload(*b)),
      ElementsAre("count: 0 | 7", "stage_ms:[2] 0 | 1.5 (of the run)",
                  "features.static_probability: 2 values, first[12] 0 | 0.5", "features.descriptor:[2047][31] 0 | 9"));
}

/// The last field of each type of ours is found where the compiler has it.
TEST(PayloadDiff, fits_the_structs_of_the_wire) {
  auto frame = std::make_unique<msg::RgbdFrame>(), other_frame = std::make_unique<msg::RgbdFrame>();
  other_frame->depth.back() = 3;
  EXPECT_THAT(differences("rtd_msgs/msg/RgbdFrame", payload(*frame), payload(*other_frame)),
              ElementsAre("depth:[307199] 0 | 3"));
  msg::TrackingResult result{}, other_result{};
  other_result.stage_ms.back() = 2;
  EXPECT_THAT(differences("rtd_msgs/msg/TrackingResult", payload(result), payload(other_result)),
              ElementsAre("stage_ms:[7] 0 | 2 (of the run)"));
  msg::KeyframeEvent event{}, other_event{};
  other_event.kind = msg::KeyframeEventKind::kRemoved;
  EXPECT_THAT(differences("rtd_msgs::msg::dds_::KeyframeEvent_", payload(event), payload(other_event)),
              ElementsAre("kind: 0 | 2"));
}

TEST(PayloadDiff, knows_where_the_fields_of_the_run_are) {
  msg::TrackingResult result{};
  std::vector<std::byte> bytes = payload(result);
  for (const ByteRange& range : run_ranges("rtd_msgs/msg/TrackingResult"))
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(range.begin),
              bytes.begin() + static_cast<std::ptrdiff_t>(range.end), std::byte{1});
  std::memcpy(&result, bytes.data() + 4, sizeof(result));
  EXPECT_NE(result.published_ns, 0);
  EXPECT_NE(result.finished_ns, 0);
  EXPECT_NE(result.stage_ms[7], 0);
  EXPECT_EQ(result.stamp_ns, 0);
  EXPECT_EQ(result.T_world_camera.translation_m[0], 0);
  EXPECT_EQ(result.landmarks, 0U);
}

TEST(PayloadDiff, other_types_and_sizes_are_compared_by_bytes) {
  const auto bytes = [](const char* text) { return std::as_bytes(std::span(text, std::strlen(text))); };
  EXPECT_THAT(run_ranges("std_msgs/msg/String"), IsEmpty());
  EXPECT_THAT(differences("std_msgs/msg/String", bytes("abcd"), bytes("abXdef")),
              ElementsAre("size: 4 | 6 bytes", "first at byte 2 of the payload"));
  const std::vector<std::byte> cut(10, std::byte{1});
  EXPECT_THAT(differences("rtd_msgs/msg/TrackingResult", cut, payload(msg::TrackingResult{})),
              testing::Contains(HasSubstr("too short")));
}

TEST(PayloadDiff, names_fields_and_lengths_of_standard_messages) {
  msg::TFMessage a, b;
  a.transforms.resize(2);
  b.transforms.resize(3);
  b.transforms[1].header.frame_id = "map";
  b.transforms[1].transform.rotation.w = 0.5;
  const auto cdr = [](const msg::TFMessage& message) { return ros::encode<ros::Wire::kCdr>(message); };
  const auto bytes_a = cdr(a), bytes_b = cdr(b);
  EXPECT_THAT(
      differences("tf2_msgs/msg/TFMessage", std::as_bytes(std::span(bytes_a)), std::as_bytes(std::span(bytes_b))),
      ElementsAre("transforms: 2 | 3 elements", "transforms.header.frame_id:[1] \"\" | \"map\"",
                  "transforms.transform.rotation.w:[1] 1 | 0.5"));
}

}  // namespace
}  // namespace rtd::recordings
