// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/live_uri.hpp"

#include <gmock/gmock.h>

#include "common/camera/source_factory.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(LiveOptionsTest, name_their_topics) {
  const LiveOptions options = parse_live_options("ros2:/cam/color/image_raw/compressed,cam/depth?tolerance_ms=5");
  EXPECT_EQ(options.topics.color, "/cam/color/image_raw/compressed");
  EXPECT_EQ(options.topics.depth, "/cam/depth");
  EXPECT_EQ(options.topics.info, "/cam/color/camera_info");
  EXPECT_EQ(options.tolerance_ns, 5'000'000);
  EXPECT_EQ(parse_live_options("ros2:/a/x,/b,/c").topics.info, "/c");
  EXPECT_EQ(parse_live_options("ros2:/a/x,/b/depth/compressedDepth").topics.depth_info, "/b/camera_info");
  EXPECT_EQ(parse_live_options("ros2:/a/x,/b/y?depth_info=e").topics.depth_info, "/e");
  EXPECT_TRUE(parse_live_options("ros2:/a,/b?registered=1").registered);
  for (const char* uri : {"ros2:", "ros2:/a", "ros2:/a,/b,/c,/d", "ros2:/a,,/c", "ros2:/a,/a"}) {
    EXPECT_THAT([&] { parse_live_options(uri); }, ThrowsMessage<SourceError>(HasSubstr("ros2:COLOR_TOPIC,DEPTH_TOPIC")))
        << uri;
  }
  EXPECT_THAT([] { parse_live_options("ros2:/a,/b?tolerance_ms=x"); }, ThrowsMessage<SourceError>(HasSubstr("'x'")));
  EXPECT_THAT([] { parse_live_options("ros2:/a,/b?fps=3"); }, ThrowsMessage<SourceError>(HasSubstr("'fps'")));
  EXPECT_TRUE(test::refuses("ros2:/a,/b", {"running camera"}));
}

}  // namespace
}  // namespace rtd::camera
