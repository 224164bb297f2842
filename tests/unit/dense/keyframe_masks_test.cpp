// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/keyframe_masks.hpp"

#include <gmock/gmock.h>

namespace rtd::dense {
namespace {

using ::testing::IsEmpty;

msg::KeyframeEvent event_of(std::int64_t stamp_ns, msg::KeyframeEventKind kind = msg::KeyframeEventKind::kCreated) {
  msg::KeyframeEvent event{};
  event.stamp_ns = stamp_ns;
  event.kind = kind;
  return event;
}

TEST(KeyframeMasks, are_found_whichever_comes_first_and_given_once) {
  KeyframeMasks masks;
  masks.put(1, all_static());
  masks.put(2, all_static());
  masks.put(event_of(1));
  masks.put(event_of(3));
  masks.put(event_of(2, msg::KeyframeEventKind::kCorrected));
  masks.put(3, {1, 1, {DynamicMask::kDynamic}});
  const auto found = masks.take();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found.at(1).cells.at(0), DynamicMask::kStatic);
  EXPECT_EQ(found.at(3).cells.at(0), DynamicMask::kDynamic);
  EXPECT_THAT(masks.take(), IsEmpty());
}

TEST(KeyframeMasks, keeps_only_the_newest_frames) {
  KeyframeMasks masks;
  for (std::size_t i = 0; i <= KeyframeMasks::kRecent; ++i) masks.put(static_cast<std::int64_t>(i), all_static());
  masks.put(event_of(0));
  masks.put(event_of(1));
  EXPECT_EQ(masks.take().count(1), 1U);
  EXPECT_THAT(masks.take(), IsEmpty());
}

}  // namespace
}  // namespace rtd::dense
