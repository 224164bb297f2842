// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/frame_topics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/bus_factory.hpp"
#include "common/msg/plausible.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/support/frame_header.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::bus {
namespace {

using test_support::fill_header;
using testing::HasSubstr;
using testing::ThrowsMessage;

class FrameTopics : public testing::Test {
 protected:
  static std::shared_ptr<Bus> connect_inprocess() {
    BusOptions options;
    options.vendor = inprocess::vendor();
    options.domain = 8;
    return connect(options);
  }

  /// Sends an image of this size whose last pixels are marked.
  void send(std::uint32_t width, std::uint32_t height) {
    FrameWriter writer(*bus_, width, height);
    EXPECT_TRUE(writer.write([&](auto& frame) {
      fill_header(frame, width, height);
      frame.color_bgr[3 * std::size_t{width} * height - 1] = 77;
      frame.depth[std::size_t{width} * height - 1] = 1234;
    }));
  }

  const std::shared_ptr<Bus> bus_ = connect_inprocess();
};

TEST_F(FrameTopics, take_images_of_every_size_to_the_last_pixel) {
  Collector<msg::FrameView> frames;
  const FrameReader reader(*bus_, frames.callback());
  constexpr std::pair<std::uint32_t, std::uint32_t> kSizes[] = {{320, 240},  {480, 640},  {640, 576},
                                                                {1280, 720}, {1280, 800}, {1920, 1200}};
  for (const auto& [width, height] : kSizes) {
    send(width, height);
    const auto frame = frames.next();
    EXPECT_EQ(frame->width, width);
    EXPECT_EQ(frame->color_bgr[3 * std::size_t{width} * height - 1], 77) << width << "x" << height;
    EXPECT_EQ(frame->depth[std::size_t{width} * height - 1], 1234) << width << "x" << height;
    EXPECT_TRUE(is_plausible(*frame));
  }
}

TEST_F(FrameTopics, are_chosen_by_the_number_of_pixels) {
  Collector<msg::RgbdFrame848> middle;
  Collector<msg::RgbdFrame1920> large;
  const auto middle_reader = bus_->reader(topics::kFrame848, middle.callback());
  const auto large_reader = bus_->reader(topics::kFrame1920, large.callback());
  send(640, 576);
  EXPECT_EQ(middle.next()->height, 576U);
  send(1280, 800);
  EXPECT_EQ(large.next()->height, 800U);
  EXPECT_EQ(middle.size() + large.size(), 0U);
}

TEST_F(FrameTopics, refuse_images_that_fit_into_none) {
  EXPECT_THAT([&] { send(1920, 1201); }, ThrowsMessage<BusError>(HasSubstr("1920 x 1201")));
  EXPECT_THAT([&] { send(2000, 100); }, ThrowsMessage<BusError>(HasSubstr("2000 x 100")));
  EXPECT_THROW(send(0, 480), BusError);
}

TEST_F(FrameTopics, a_frame_that_claims_more_pixels_than_its_message_has_is_implausible) {
  const auto frame = std::make_unique<msg::RgbdFrame>();
  frame->width = 848;
  frame->height = 480;
  EXPECT_FALSE(is_plausible(*frame));
  EXPECT_FALSE(is_plausible(msg::FrameView(*frame)));
}

}  // namespace
}  // namespace rtd::bus
