// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/rvl.hpp"

#include <algorithm>
#include <span>
#include <string>

namespace rtd::camera {
namespace {

/// The numbers of variable length.
class RvlNumbers {
 public:
  explicit RvlNumbers(ros::ByteCursor cursor) : cursor_(cursor) {}

  std::uint32_t next() {
    constexpr unsigned kBits = 3, kMore = 8, kMaxShift = 27;  // 30 bits are more than any run or difference needs
    std::uint32_t value = 0;
    for (unsigned shift = 0;; shift += kBits) {
      if (shift > kMaxShift) throw ros::WireError("RVL: a number is too long" + place());
      const unsigned nibble = next_nibble();
      value |= (nibble & (kMore - 1)) << shift;
      if ((nibble & kMore) == 0) return value;
    }
  }

  std::string place() const { return " before byte " + std::to_string(cursor_.position()); }

 private:
  unsigned next_nibble() {
    if (left_ == 0) {
      word_ = cursor_.read<std::uint32_t>();
      left_ = 8;
    }
    const unsigned nibble = word_ >> 28;
    word_ <<= 4;
    --left_;
    return nibble;
  }

  ros::ByteCursor cursor_;
  std::uint32_t word_ = 0;
  int left_ = 0;  ///< nibbles in the word
};

/// 0, -1, 1, -2, ... are 0, 1, 2, 3, ...
std::uint16_t add_difference(std::uint16_t previous, std::uint32_t number) {
  const std::uint32_t difference = (number >> 1) ^ (0U - (number & 1U));  // modulo 2^32, as the sum modulo 2^16
  return static_cast<std::uint16_t>(previous + difference);
}

/// The first pixels of `left` that a run takes.
std::span<std::uint16_t> take_run(std::span<std::uint16_t>& left, RvlNumbers& numbers) {
  const std::uint32_t length = numbers.next();
  if (length > left.size()) {
    throw ros::WireError("RVL: a run of " + std::to_string(length) + " pixels, where " + std::to_string(left.size()) +
                         " are left" + numbers.place());
  }
  const std::span<std::uint16_t> run = left.first(length);
  left = left.subspan(length);
  return run;
}

void fill_image(std::span<std::uint16_t> left, RvlNumbers& numbers) {
  std::uint16_t previous = 0;
  while (!left.empty()) {
    std::ranges::fill(take_run(left, numbers), std::uint16_t{0});
    for (std::uint16_t& value : take_run(left, numbers)) value = previous = add_difference(previous, numbers.next());
  }
}

}  // namespace

cv::Mat decode_rvl(ros::Bytes bytes) {
  ros::ByteCursor cursor(bytes);
  const auto width = cursor.read<std::uint32_t>(), height = cursor.read<std::uint32_t>();
  if (width == 0 || height == 0 || std::uint64_t{width} * height > kMaxRecordedPixels) {
    throw ros::WireError("RVL: an image of " + std::to_string(width) + " x " + std::to_string(height) + " px");
  }
  cv::Mat depth(static_cast<int>(height), static_cast<int>(width), CV_16UC1);
  RvlNumbers numbers(cursor);
  fill_image({depth.ptr<std::uint16_t>(), depth.total()}, numbers);
  return depth;
}

}  // namespace rtd::camera
