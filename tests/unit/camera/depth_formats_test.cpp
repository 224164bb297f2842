// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/depth_formats.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace rtd::camera {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

cv::Mat ramp(int type, int width = 70, int height = 50) {
  cv::Mat values(height, width, type);
  cv::randu(values, 0, type == CV_32FC1 ? 8 : 9000);
  values.rowRange(5, 20).setTo(cv::Scalar(type == CV_32FC1 ? 2.5 : 1234));  // runs
  return values;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_L1) == 0;
}

Bytes encoded(const std::string& extension, const cv::Mat& values, const std::vector<int>& options = {}) {
  Bytes bytes;
  cv::imencode(extension, values, bytes, options);
  return bytes;
}

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

void append(Bytes& bytes, const auto value) {
  const auto* const at = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), at, at + sizeof(value));
}

/// A scan-line EXR of one float channel without compression.
Bytes exr_of(const cv::Mat& values, const char* channel) {
  Bytes bytes = bytes_of(std::string("\x76\x2f\x31\x01\x02\x00\x00\x00", 8));
  const auto attribute = [&](const std::string& name, const std::string& type, const Bytes& value) {
    for (const std::string& text : {name, type}) {
      const Bytes part = bytes_of(text);
      bytes.insert(bytes.end(), part.begin(), part.end());
      bytes.push_back(0);
    }
    append(bytes, static_cast<std::uint32_t>(value.size()));
    bytes.insert(bytes.end(), value.begin(), value.end());
  };
  Bytes channels = bytes_of(channel);
  channels.push_back(0);
  for (const std::uint32_t number : {2U, 0U, 1U, 1U}) append(channels, number);
  channels.push_back(0);
  Bytes window;
  for (const std::int32_t number : {0, 0, values.cols - 1, values.rows - 1}) append(window, number);
  attribute("channels", "chlist", channels);
  attribute("compression", "compression", {0});
  attribute("dataWindow", "box2i", window);
  attribute("displayWindow", "box2i", window);
  attribute("lineOrder", "lineOrder", {0});
  attribute("pixelAspectRatio", "float", {0, 0, 0x80, 0x3F});
  attribute("screenWindowCenter", "v2f", Bytes(8));
  attribute("screenWindowWidth", "float", {0, 0, 0x80, 0x3F});
  bytes.push_back(0);
  const std::size_t line = 8 + static_cast<std::size_t>(values.cols) * 4, table = bytes.size();
  for (int row = 0; row < values.rows; ++row)
    append(bytes,
           std::uint64_t{table + static_cast<std::size_t>(values.rows) * 8 + static_cast<std::size_t>(row) * line});
  for (int row = 0; row < values.rows; ++row) {
    append(bytes, row);
    append(bytes, static_cast<std::uint32_t>(values.cols * 4));
    const auto* const at = values.ptr(row);
    bytes.insert(bytes.end(), at, at + values.cols * 4);
  }
  return bytes;
}

TEST(DepthFormats, read_tiff_in_the_ways_that_opencv_writes_it) {
  constexpr int kNone = 1, kLzw = 5, kDeflate = 32946, kPackBits = 32773;
  for (const int type : {CV_16UC1, CV_32FC1}) {
    const cv::Mat values = ramp(type);
    for (const int compression : {kNone, kLzw, kDeflate, kPackBits}) {
      for (const int predictor : {1, 2, 3}) {
        if (predictor == 3 && type == CV_16UC1) continue;
        if (predictor == 2 && type == CV_32FC1) continue;
        const Bytes bytes = encoded(".tiff", values, {cv::IMWRITE_TIFF_COMPRESSION, compression, 317, predictor});
        const auto read = decode_depth_values(bytes);
        EXPECT_TRUE(same(read.pixels, values)) << type << " " << compression << " " << predictor << read.problem;
      }
    }
  }
}

TEST(DepthFormats, read_long_lzw_streams) {
  const cv::Mat values = ramp(CV_16UC1, 640, 480);
  EXPECT_TRUE(same(decode_depth_values(encoded(".tiff", values, {cv::IMWRITE_TIFF_COMPRESSION, 5})).pixels, values));
}

TEST(DepthFormats, read_pgm_with_comments_and_both_widths) {
  const cv::Mat values = ramp(CV_16UC1);
  EXPECT_TRUE(same(decode_depth_values(encoded(".pgm", values)).pixels, values));
  const auto bytes = bytes_of(std::string("P5\n# by a script\n2 1\n# again\n65535\n\x01\x02\x03\x04", 39));
  const auto read = decode_depth_values(bytes);
  ASSERT_EQ(read.problem, "");
  EXPECT_EQ(read.pixels.at<std::uint16_t>(0, 1), 0x0304);
}

TEST(DepthFormats, read_exr_without_compression) {
  const cv::Mat values = ramp(CV_32FC1);
  for (const char* const channel : {"Z", "Y", "R", "depth.Z"})
    EXPECT_TRUE(same(decode_depth_values(exr_of(values, channel)).pixels, values)) << channel;
}

TEST(DepthFormats, read_exr_as_opencv_writes_it) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  const cv::Mat values = ramp(CV_32FC1, 64, 50);
  for (const int compression : {cv::IMWRITE_EXR_COMPRESSION_NO, cv::IMWRITE_EXR_COMPRESSION_RLE,
                                cv::IMWRITE_EXR_COMPRESSION_ZIPS, cv::IMWRITE_EXR_COMPRESSION_ZIP}) {
    for (const int type : {cv::IMWRITE_EXR_TYPE_FLOAT, cv::IMWRITE_EXR_TYPE_HALF}) {
      Bytes bytes;
      try {
        cv::imencode(".exr", values, bytes, {cv::IMWRITE_EXR_COMPRESSION, compression, cv::IMWRITE_EXR_TYPE, type});
      } catch (const cv::Exception&) {
        GTEST_SKIP() << "this OpenCV writes no EXR";
      }
      const auto read = decode_depth_values(bytes);
      ASSERT_EQ(read.problem, "") << compression;
      const double largest = cv::norm(read.pixels, values, cv::NORM_INF);
      EXPECT_LE(largest, type == cv::IMWRITE_EXR_TYPE_HALF ? 4e-3 : 0) << compression;
    }
  }
  Bytes piz;
  cv::imencode(".exr", values, piz, {cv::IMWRITE_EXR_COMPRESSION, cv::IMWRITE_EXR_COMPRESSION_PIZ});
  EXPECT_THAT(decode_depth_values(piz).problem, HasSubstr("ZIP"));
}

TEST(DepthFormats, read_one_of_the_channels_of_exr) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  std::vector<cv::Mat> channels = {ramp(CV_32FC1), ramp(CV_32FC1), ramp(CV_32FC1)};  // B, G, R
  cv::Mat color;
  cv::merge(channels, color);
  for (const int compression : {cv::IMWRITE_EXR_COMPRESSION_NO, cv::IMWRITE_EXR_COMPRESSION_RLE,
                                cv::IMWRITE_EXR_COMPRESSION_ZIPS, cv::IMWRITE_EXR_COMPRESSION_ZIP}) {
    Bytes bytes;
    try {
      cv::imencode(".exr", color, bytes, {cv::IMWRITE_EXR_COMPRESSION, compression, cv::IMWRITE_EXR_TYPE, 2});
    } catch (const cv::Exception&) {
      GTEST_SKIP() << "this OpenCV writes no EXR";
    }
    const auto read = decode_depth_values(bytes);
    EXPECT_TRUE(same(read.pixels, channels[2])) << compression << read.problem;
  }
}

TEST(DepthFormats, exr_whose_channels_are_far_too_many_is_refused) {
  const Bytes bytes = exr_of(ramp(CV_32FC1, 3840, 2160), "Z");
  EXPECT_EQ(decode_depth_values(bytes).problem, "");
  Bytes named_often = bytes;
  Bytes channel = {'d', 0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  constexpr std::size_t kSizeOfChannels = 8 + 9 + 7;  // behind the magic, "channels" and "chlist"
  for (int i = 0; i < 4; ++i, ++channel[0])
    named_often.insert(named_often.begin() + kSizeOfChannels + 4, channel.begin(), channel.end());
  named_often[kSizeOfChannels] = static_cast<std::uint8_t>(named_often[kSizeOfChannels] + 4 * channel.size());
  EXPECT_THAT(decode_depth_values(named_often).problem, HasSubstr("5 channels"));
}

TEST(DepthFormats, a_packed_piece_that_is_too_short_takes_no_memory) {
  const Bytes packed(100);
  EXPECT_THAT(inflate_at_most(packed, std::size_t{1} << 60), ::testing::IsEmpty());
}

TEST(DepthFormats, read_the_number_types_of_npy) {
  const std::string header = "{'descr': 'TYPE', 'fortran_order': False, 'shape': (1, 2), }\n";
  const auto npy = [&](const std::string& type, const auto first, const auto second) {
    std::string text = header;
    text.replace(text.find("TYPE"), 4, type);
    Bytes bytes = bytes_of("\x93NUMPY");
    for (const std::uint8_t byte : {std::uint8_t{1}, std::uint8_t{0}}) bytes.push_back(byte);
    append(bytes, static_cast<std::uint16_t>(text.size()));
    bytes.insert(bytes.end(), text.begin(), text.end());
    append(bytes, first);
    append(bytes, second);
    return decode_depth_values(bytes);
  };
  EXPECT_EQ(npy("<f4", 1.5F, 2.5F).pixels.at<float>(0, 1), 2.5F);
  EXPECT_EQ(npy("<f8", 1.5, 2.5).pixels.at<float>(0, 1), 2.5F);
  EXPECT_EQ(npy("<f2", std::uint16_t{0x3C00}, std::uint16_t{0x4100}).pixels.at<float>(0, 1), 2.5F);
  EXPECT_EQ(npy("<u2", std::uint16_t{7}, std::uint16_t{9}).pixels.at<std::uint16_t>(0, 1), 9);
  EXPECT_EQ(npy("<i4", 7, 9).pixels.at<float>(0, 1), 9.0F);
  EXPECT_THAT(npy("|O", 7, 9).problem, HasSubstr("'|O'"));
}

TEST(DepthFormats, damaged_bytes_end_with_a_problem) {
  const cv::Mat values = ramp(CV_16UC1), floats = ramp(CV_32FC1);
  std::vector<Bytes> originals = {encoded(".tiff", values, {cv::IMWRITE_TIFF_COMPRESSION, 5}),
                                  encoded(".tiff", floats, {cv::IMWRITE_TIFF_COMPRESSION, 32946}),
                                  encoded(".pgm", values), exr_of(floats, "Z")};
  cv::RNG random(7);
  for (const Bytes& original : originals) {
    const Bytes half(original.begin(), original.begin() + static_cast<std::ptrdiff_t>(original.size() / 2));
    EXPECT_NE(decode_depth_values(half).problem, "");
    for (int i = 0; i < 400; ++i) {
      Bytes changed = original;
      for (int k = 0; k < 4; ++k)
        changed[static_cast<std::size_t>(random.uniform(0, k < 2 ? 64 : static_cast<int>(changed.size())))] =
            static_cast<std::uint8_t>(random.uniform(0, 256));
      decode_depth_values(changed);  // an image or a problem, nothing else
    }
  }
}

}  // namespace
}  // namespace rtd::camera
