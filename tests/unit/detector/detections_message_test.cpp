// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/detector_service.hpp"

#include <gmock/gmock.h>

namespace rtd::detector {
namespace {

TEST(DetectionsMessage, carries_the_stamp_and_frame_of_the_image) {
  const msg::Detection2DArray message = to_message({}, 1'341'846'313'654'184'001);
  EXPECT_EQ(msg::to_ns(message.header.stamp), 1'341'846'313'654'184'001);
  EXPECT_EQ(message.header.frame_id, "camera_color_optical_frame");
  EXPECT_TRUE(message.detections.empty());
}

TEST(DetectionsMessage, gives_boxes_by_centre_and_size) {
  const msg::Detection2DArray message = to_message({{"person", 0.5F, 10, 20, 30, 50}}, 7);
  ASSERT_EQ(message.detections.size(), 1U);
  const msg::Detection2D& box = message.detections[0];
  EXPECT_EQ(msg::to_ns(box.header.stamp), 7);
  EXPECT_DOUBLE_EQ(box.bbox.center.position.x, 25.0);
  EXPECT_DOUBLE_EQ(box.bbox.center.position.y, 45.0);
  EXPECT_DOUBLE_EQ(box.bbox.size_x, 30.0);
  EXPECT_DOUBLE_EQ(box.bbox.size_y, 50.0);
  ASSERT_EQ(box.results.size(), 1U);
  EXPECT_EQ(box.results[0].hypothesis.class_id, "person");
  EXPECT_DOUBLE_EQ(box.results[0].hypothesis.score, 0.5);
}

}  // namespace
}  // namespace rtd::detector
