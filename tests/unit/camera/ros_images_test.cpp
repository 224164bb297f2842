// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/ros_images.hpp"
#include "common/camera/recording/rvl.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "common/camera/frame_source.hpp"
#include "tests/unit/camera/image_bag.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kUnit_m = 0.0002;
const cv::Vec3b kOrange(30, 120, 220);  // BGR

template <class Message>
RecordedMessage recorded(const std::string& type, const Message& message) {
  return {"/image", 7, ros::Wire::kCdr, ros::encode<ros::Wire::kCdr>(message), type};
}

RecordedMessage image_of(const cv::Mat& pixels, const std::string& encoding) {
  return recorded("sensor_msgs/Image", ImageBag::image(pixels, encoding, 1));
}

/// Every pixel but those at the border has the colour.
void expect_color(const std::string& encoding, const cv::Mat& pixels, const cv::Vec3b& bgr, int tolerance) {
  const ImageRead read = decode_color(image_of(pixels, encoding));
  ASSERT_FALSE(read.problem) << encoding << ": " << read.problem->detail;
  ASSERT_EQ(read.image.type(), CV_8UC3) << encoding;
  ASSERT_EQ(read.image.size(), pixels.size()) << encoding;
  const cv::Mat inner = read.image(cv::Rect(1, 1, pixels.cols - 2, pixels.rows - 2));
  EXPECT_LE(cv::norm(inner, cv::Mat(inner.size(), CV_8UC3, cv::Scalar(bgr)), cv::NORM_INF), tolerance) << encoding;
}

/// A mosaic of the colour: `pattern` is the first row and then the second.
cv::Mat mosaic(const std::string& pattern, const cv::Vec3b& bgr) {
  cv::Mat pixels(8, 10, CV_8UC1);
  for (int y = 0; y < pixels.rows; ++y) {
    for (int x = 0; x < pixels.cols; ++x) {
      const char filter = pattern[static_cast<std::size_t>(y % 2 * 2 + x % 2)];
      pixels.at<std::uint8_t>(y, x) = bgr[filter == 'b' ? 0 : filter == 'g' ? 1 : 2];
    }
  }
  return pixels;
}

cv::Mat sixteen_bit(const cv::Mat& pixels) {
  cv::Mat wide;
  pixels.convertTo(wide, CV_16U, 256, 255);  // the lower byte must not count
  return wide;
}

TEST(RosColor, bayer_patterns_are_named_by_their_rows) {
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    expect_color("bayer_" + pattern + "8", mosaic(pattern, kOrange), kOrange, 0);
    expect_color("bayer_" + pattern + "16", sixteen_bit(mosaic(pattern, kOrange)), kOrange, 0);
  }
}

TEST(RosColor, reads_both_orders_of_yuv_422) {
  constexpr std::uint8_t kY = 81, kU = 90, kV = 240;  // red of BT.601, limited range
  cv::Mat uyvy(6, 8, CV_8UC2), yuyv(6, 8, CV_8UC2);
  for (int y = 0; y < uyvy.rows; ++y) {
    for (int x = 0; x < uyvy.cols; ++x) {
      const std::uint8_t chroma = x % 2 == 0 ? kU : kV;
      uyvy.at<cv::Vec2b>(y, x) = {chroma, kY};
      yuyv.at<cv::Vec2b>(y, x) = {kY, chroma};
    }
  }
  for (const char* encoding : {"yuv422", "uyvy"}) expect_color(encoding, uyvy, {0, 0, 255}, 2);
  for (const char* encoding : {"yuv422_yuy2", "yuy2", "yuyv", "YUYV"}) expect_color(encoding, yuyv, {0, 0, 255}, 2);
}

TEST(RosColor, reads_nv24_whose_colour_lies_below_the_grey) {
  cv::Mat planes(18, 8, CV_8UC1, cv::Scalar(81));
  planes.rowRange(6, 18).reshape(2, 6).setTo(cv::Scalar(90, 240));
  msg::Image image = ImageBag::image(planes, "nv24", 1);
  image.height = 6;
  const ImageRead read = decode_color(recorded("sensor_msgs/Image", image));
  ASSERT_FALSE(read.problem) << read.problem->detail;
  ASSERT_EQ(read.image.size(), cv::Size(8, 6));
  EXPECT_LE(cv::norm(read.image, cv::Mat(6, 8, CV_8UC3, cv::Scalar(0, 0, 255)), cv::NORM_INF), 2);
}

TEST(RosColor, reads_grey_and_colours_of_8_and_16_bits) {
  const cv::Mat bgr(4, 5, CV_8UC3, cv::Scalar(kOrange)), rgb(4, 5, CV_8UC3, cv::Scalar(220, 120, 30));
  const cv::Mat bgra(4, 5, CV_8UC4, cv::Scalar(30, 120, 220, 9)), rgba(4, 5, CV_8UC4, cv::Scalar(220, 120, 30, 9));
  const cv::Mat grey(4, 5, CV_8UC1, cv::Scalar(77));
  for (const char* encoding : {"bgr8", "8UC3"}) expect_color(encoding, bgr, kOrange, 0);
  for (const char* encoding : {"bgra8", "8UC4"}) expect_color(encoding, bgra, kOrange, 0);
  for (const char* encoding : {"mono8", "8UC1"}) expect_color(encoding, grey, {77, 77, 77}, 0);
  expect_color("rgb8", rgb, kOrange, 0);
  expect_color("rgba8", rgba, kOrange, 0);
  expect_color("bgr16", sixteen_bit(bgr), kOrange, 0);
  expect_color("rgb16", sixteen_bit(rgb), kOrange, 0);
  expect_color("bgra16", sixteen_bit(bgra), kOrange, 0);
  expect_color("rgba16", sixteen_bit(rgba), kOrange, 0);
  expect_color("mono16", sixteen_bit(grey), {77, 77, 77}, 0);
}

TEST(RosColor, refuses_sizes_that_the_encoding_cannot_have) {
  const auto problem = [](const cv::Mat& pixels, const std::string& encoding) {
    const ImageRead read = decode_color(image_of(pixels, encoding));
    return read.problem ? read.problem->detail : std::string();
  };
  EXPECT_THAT(problem(cv::Mat(4, 5, CV_8UC2, cv::Scalar(0)), "yuv422"), HasSubstr("5 x 4 px in yuv422"));
  EXPECT_THAT(problem(cv::Mat(1, 1, CV_8UC1, cv::Scalar(0)), "bayer_rggb8"), HasSubstr("3 x 3"));
  msg::Image short_image = ImageBag::image(cv::Mat(4, 6, CV_8UC2, cv::Scalar(0)), "yuv422", 1);
  short_image.data.pop_back();
  EXPECT_TRUE(decode_color(recorded("sensor_msgs/Image", short_image)).problem);
}

TEST(RosColor, refuses_big_endian_pixels_of_16_bits) {
  msg::Image image = ImageBag::image(cv::Mat(4, 6, CV_16UC1, cv::Scalar(0)), "mono16", 1);
  image.is_bigendian = 1;
  EXPECT_THAT([&] { decode_color(recorded("sensor_msgs/Image", image)); },
              ThrowsMessage<SourceError>(HasSubstr("big endian")));
}

TEST(RosDepth, mono16_is_millimetres) {
  const RecordedMessage message = image_of(ImageBag::depth(1234), "mono16");
  EXPECT_EQ(decode_depth(message, kUnit_m).image.at<std::uint16_t>(3, 3), 1234);
  EXPECT_EQ(depth_unit_m(message, kUnit_m), 0.001);
}

/// Writes what decode_rvl() reads.
class RvlEncoder {
 public:
  std::vector<std::uint8_t> encode(const cv::Mat& depth) {
    raw(static_cast<std::uint32_t>(depth.cols));
    raw(static_cast<std::uint32_t>(depth.rows));
    const auto* at = depth.ptr<std::uint16_t>();
    const auto* const end = at + depth.total();
    for (int previous = 0; at != end;) {
      const auto* const values = std::find_if(at, end, [](std::uint16_t value) { return value != 0; });
      const auto* const zeros = std::find(values, end, std::uint16_t{0});
      number(static_cast<std::uint32_t>(values - at));
      number(static_cast<std::uint32_t>(zeros - values));
      for (at = values; at != zeros; previous = *at++) {
        const int difference = *at - previous;
        number(static_cast<std::uint32_t>(difference >= 0 ? 2 * difference : -2 * difference - 1));
      }
    }
    while (nibbles_ != 0) nibble(0);
    return bytes_;
  }

 private:
  void raw(std::uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) bytes_.push_back(static_cast<std::uint8_t>(word >> shift));
  }
  void number(std::uint32_t value) {
    for (; value > 7; value >>= 3) nibble((value & 7) | 8);
    nibble(value);
  }
  void nibble(std::uint32_t value) {
    word_ = word_ << 4 | value;
    if (++nibbles_ < 8) return;
    raw(word_);
    nibbles_ = 0;
  }
  std::vector<std::uint8_t> bytes_;
  std::uint32_t word_ = 0;
  int nibbles_ = 0;
};

cv::Mat depth_with_holes() {
  cv::Mat depth(24, 32, CV_16UC1);
  cv::randu(depth, 1, 65535);
  depth(cv::Rect(0, 0, 7, 9)) = 0;
  depth(cv::Rect(20, 20, 12, 4)) = 0;
  return depth;
}

msg::CompressedImage compressed_depth(const std::string& format, const std::vector<std::uint8_t>& payload, float a = 0,
                                      float b = 0) {
  msg::CompressedImage image;
  image.format = format;
  image.data.assign(12, 0);
  std::memcpy(image.data.data() + 4, &a, sizeof a);
  std::memcpy(image.data.data() + 8, &b, sizeof b);
  image.data.insert(image.data.end(), payload.begin(), payload.end());
  return image;
}

TEST(RosDepth, rvl_gives_back_every_pixel) {
  cv::Mat all_zero(3, 5, CV_16UC1, cv::Scalar(0)), none_zero(3, 5, CV_16UC1, cv::Scalar(65534));
  for (const cv::Mat& depth : {depth_with_holes(), all_zero, none_zero}) {
    const RecordedMessage message = recorded(
        "sensor_msgs/CompressedImage", compressed_depth("16UC1; compressedDepth rvl", RvlEncoder().encode(depth)));
    const ImageRead read = decode_depth(message, kUnit_m);
    ASSERT_FALSE(read.problem) << read.problem->detail;
    EXPECT_EQ(cv::norm(read.image, depth, cv::NORM_INF), 0);
    EXPECT_EQ(depth_unit_m(message, kUnit_m), 0.001);
  }
}

TEST(RosDepth, rvl_follows_its_description) {
  // 3 x 1 px: no zeros, two values: 5 (+5 = 10: nibbles 2|8, 1), 4 (-1 = 1); one zero, no values.
  const std::vector<std::uint8_t> bytes = {3, 0, 0, 0, 1, 0, 0, 0, 0x00, 0x11, 0xA1, 0x02};
  const cv::Mat depth = decode_rvl(bytes);
  EXPECT_EQ(depth.at<std::uint16_t>(0, 0), 5);
  EXPECT_EQ(depth.at<std::uint16_t>(0, 1), 4);
  EXPECT_EQ(depth.at<std::uint16_t>(0, 2), 0);
}

TEST(RosDepth, cut_rvl_is_refused_wherever_it_is_cut) {
  const std::vector<std::uint8_t> whole = RvlEncoder().encode(depth_with_holes());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::vector<std::uint8_t> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(decode_rvl(cut), ros::WireError) << size;
    const auto message = recorded("sensor_msgs/CompressedImage", compressed_depth("16UC1; compressedDepth rvl", cut));
    ASSERT_EQ(decode_depth(message, kUnit_m).problem->reason, SkipReason::kDepthUnreadable);
  }
}

TEST(RosDepth, rvl_that_lies_about_its_size_is_refused) {
  std::vector<std::uint8_t> bytes = RvlEncoder().encode(depth_with_holes());
  bytes[0] = 31;
  EXPECT_THAT([&] { decode_rvl(bytes); }, ThrowsMessage<ros::WireError>(HasSubstr("RVL: a run of")));
  std::fill_n(bytes.begin(), 8, std::uint8_t{255});
  EXPECT_THAT([&] { decode_rvl(bytes); }, ThrowsMessage<ros::WireError>(HasSubstr("4294967295 x 4294967295 px")));
  std::fill_n(bytes.begin(), 8, std::uint8_t{0});
  EXPECT_THROW(decode_rvl(bytes), ros::WireError);
  bytes.assign(64, 255);
  bytes[1] = bytes[2] = bytes[3] = bytes[5] = bytes[6] = bytes[7] = 0;
  EXPECT_THAT([&] { decode_rvl(bytes); }, ThrowsMessage<ros::WireError>(HasSubstr("too long")));
}

TEST(RosDepth, floats_are_kept_as_inverse_depth) {
  constexpr float kA = 100 * 101, kB = 1 - kA / 10;  // as the driver: quantisation 100, farthest 10 m
  cv::Mat inverse(24, 32, CV_16UC1);
  for (int x = 0; x < inverse.cols; ++x) {
    const double depth_m = 0.5 + 0.25 * x;
    inverse.col(x) = x == 3 ? 0 : std::round(kA / depth_m + kB);
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", inverse, png);
  const std::vector<std::uint8_t> rvl = RvlEncoder().encode(inverse);
  for (const auto& [codec, payload] : {std::pair("png", png), std::pair("rvl", rvl), std::pair("", png)}) {
    const auto message = recorded("sensor_msgs/CompressedImage",
                                  compressed_depth(std::string("32FC1; compressedDepth ") + codec, payload, kA, kB));
    const ImageRead read = decode_depth(message, kUnit_m);
    ASSERT_FALSE(read.problem) << codec << read.problem->detail;
    EXPECT_EQ(depth_unit_m(message, kUnit_m), kUnit_m);
    EXPECT_EQ(read.image.at<std::uint16_t>(5, 3), 0);
    EXPECT_NEAR(read.image.at<std::uint16_t>(5, 0) * kUnit_m, 0.5, 0.0003);
    EXPECT_NEAR(read.image.at<std::uint16_t>(5, 31) * kUnit_m, 8.25, 0.005);
  }
}

TEST(RosDepth, names_a_codec_that_it_does_not_know) {
  const auto message = recorded("sensor_msgs/CompressedImage", compressed_depth("16UC1; compressedDepth zdepth", {1}));
  EXPECT_THAT([&] { decode_depth(message, kUnit_m); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("zdepth"), HasSubstr("PNG, RVL"))));
}

}  // namespace
}  // namespace rtd::camera
