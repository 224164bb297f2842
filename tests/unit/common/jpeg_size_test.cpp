// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/jpeg_size.hpp"

#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

namespace rtd::vision {
namespace {

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

TEST(JpegSize, is_read_from_the_frame_header) {
  // Start of image, one comment segment of 4 bytes, baseline frame header of 640x480.
  const std::vector<std::uint8_t> jpeg{0xFF, 0xD8, 0xFF, 0xFE, 0x00, 0x04, 'h',  'i',  0xFF, 0xC0, 0x00,
                                       0x11, 0x08, 0x01, 0xE0, 0x02, 0x80, 0x03, 0x01, 0x22, 0x00};
  EXPECT_EQ(jpeg_size(jpeg).width, 640);
  EXPECT_EQ(jpeg_size(jpeg).height, 480);
  for (std::size_t length = 0; length < 17; ++length) {
    EXPECT_EQ(jpeg_size(std::span(jpeg).first(length)).width, 0) << length;
  }
  const std::vector<std::uint8_t> huffman_first{0xFF, 0xD8, 0xFF, 0xC4, 0x00, 0x08, 9,    9,    9,
                                                9,    9,    9,    0xFF, 0xC0, 0x00, 0x11, 0x08, 0x01,
                                                0xE0, 0x02, 0x80, 0x03, 0x01, 0x22, 0x00};
  EXPECT_EQ(jpeg_size(huffman_first).width, 640);
  EXPECT_EQ(jpeg_size(bytes_of("this is no image at all")).width, 0);
}

}  // namespace
}  // namespace rtd::vision
