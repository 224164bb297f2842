// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <unistd.h>
#include <zlib.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "common/msg/largest_sample.hpp"
#include "common/msg/ros.hpp"
#include "common/vision/image_codecs.hpp"
#include "common/vision/image_decoders.hpp"
#include "common/vision/jpeg_size.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/time_bounds.hpp"

namespace rtd::vision {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

/// Soft edges, so that chroma is interpolated and every frequency occurs.
cv::Mat scene(int type, cv::Size size = {93, 71}) {
  cv::Mat noise(size, CV_MAKETYPE(CV_16U, CV_MAT_CN(type)));
  cv::RNG random(7);
  random.fill(noise, cv::RNG::UNIFORM, 0, 65536);
  cv::GaussianBlur(noise, noise, {5, 5}, 1.5);
  cv::Mat image;
  noise.convertTo(image, type, CV_MAT_DEPTH(type) == CV_8U ? 1.0 / 257 : 1.0);
  return image;
}

Bytes encoded(const std::string& extension, const cv::Mat& image, const std::vector<int>& parameters = {}) {
  Bytes bytes;
  cv::imencode(extension, image, bytes, parameters);
  return bytes;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && !a.empty() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// With each way to read it. "" when all are equal.
std::string difference_from_opencv(const Bytes& bytes) {
  const std::pair<DecodeRules, int> ways[] = {
      {{.pixels = PixelsAs::kBgr, .upright = true}, cv::IMREAD_COLOR},
      {{.pixels = PixelsAs::kBgr}, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION},
      {{.pixels = PixelsAs::kGrey, .upright = true}, cv::IMREAD_GRAYSCALE},
      {{.pixels = PixelsAs::kStored}, cv::IMREAD_UNCHANGED}};
  for (const auto& [rules, flags] : ways) {
    const DecodedImage ours = decode_image(bytes, rules);
    if (!ours.problem.empty()) return ours.problem;
    if (!same(ours.pixels, cv::imdecode(bytes, flags))) return "other pixels with flags " + std::to_string(flags);
  }
  return {};
}

std::size_t position_of(const Bytes& bytes, const Bytes& what) {
  return static_cast<std::size_t>(std::ranges::search(bytes, what).begin() - bytes.begin());
}

/// A JPEG whose header claims another size.
Bytes with_jpeg_size(Bytes jpeg, int width, int height) {
  const std::size_t header = position_of(jpeg, {0xFF, 0xC0, 0x00});
  jpeg[header + 5] = static_cast<std::uint8_t>(height >> 8);
  jpeg[header + 6] = static_cast<std::uint8_t>(height);
  jpeg[header + 7] = static_cast<std::uint8_t>(width >> 8);
  jpeg[header + 8] = static_cast<std::uint8_t>(width);
  return jpeg;
}

Bytes with_png_size(Bytes png, std::uint32_t width, std::uint32_t height) {
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
      png[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  };
  put(16, width);
  put(20, height);
  put(29, static_cast<std::uint32_t>(crc32(0, &png[12], 17)));
  return png;
}

TEST(ImageCodecs, decode_to_the_pixels_of_opencv) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4})
    EXPECT_EQ(difference_from_opencv(encoded(".png", scene(type))), "") << type;
  EXPECT_EQ(difference_from_opencv(encoded(".png", scene(CV_8UC1) > 127, {cv::IMWRITE_PNG_BILEVEL, 1})), "");
  for (const int type : {CV_8UC1, CV_8UC3})
    for (const std::vector<int>& parameters : {std::vector<int>{},
                                               {cv::IMWRITE_JPEG_QUALITY, 30},
                                               {cv::IMWRITE_JPEG_PROGRESSIVE, 1},
                                               {cv::IMWRITE_JPEG_OPTIMIZE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 3}})
      EXPECT_EQ(difference_from_opencv(encoded(".jpg", scene(type), parameters)), "") << type;
}

/// A PNG of noise whose rows use all five filters in turn, in two chunks, with one that says nothing about pixels.
Bytes filtered_png(int type, cv::Size size) {
  const auto bits = static_cast<std::uint8_t>(CV_MAT_DEPTH(type) == CV_8U ? 8 : 16);
  const std::size_t row_bytes = static_cast<std::size_t>(size.width) * CV_ELEM_SIZE(type);
  std::mt19937 random(3);
  Bytes rows;
  for (int y = 0; y < size.height; ++y) {
    rows.push_back(static_cast<std::uint8_t>((y + 4) % 5));
    for (std::size_t i = 0; i < row_bytes; ++i) rows.push_back(static_cast<std::uint8_t>(random() % 64));
  }
  Bytes packed(compressBound(rows.size()));
  uLongf packed_size = packed.size();
  compress(packed.data(), &packed_size, rows.data(), rows.size());
  const auto middle = packed.begin() + static_cast<std::ptrdiff_t>(packed_size / 2);
  Bytes header(13, 0);
  header[3] = static_cast<std::uint8_t>(size.width);
  header[7] = static_cast<std::uint8_t>(size.height);
  header[8] = bits;
  header[9] = CV_MAT_CN(type) == 3 ? 2 : 0;
  Bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  const auto add = [&png](const std::string& kind, const Bytes& data) {
    for (int shift = 24; shift >= 0; shift -= 8) png.push_back(static_cast<std::uint8_t>(data.size() >> shift));
    const std::size_t begin = png.size();
    png.insert(png.end(), kind.begin(), kind.end());
    png.insert(png.end(), data.begin(), data.end());
    const auto crc = static_cast<std::uint32_t>(crc32(0, &png[begin], static_cast<uInt>(png.size() - begin)));
    for (int shift = 24; shift >= 0; shift -= 8) png.push_back(static_cast<std::uint8_t>(crc >> shift));
  };
  add("IHDR", header);
  add("tEXt", {'a', 0, 'b'});
  add("IDAT", Bytes(packed.begin(), middle));
  add("IDAT", Bytes(middle, packed.begin() + static_cast<std::ptrdiff_t>(packed_size)));
  add("IEND", {});
  return png;
}

TEST(ImageCodecs, decode_every_filter_of_png_to_the_pixels_of_opencv) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1})
    for (const cv::Size size : {cv::Size(93, 71), cv::Size(1, 40), cv::Size(40, 1), cv::Size(3, 11)})
      EXPECT_EQ(difference_from_opencv(filtered_png(type, size)), "") << type << ", " << size;
}

TEST(ImageCodecs, leave_to_libpng_what_is_not_plain) {
  const DecodeRules stored{.pixels = PixelsAs::kStored};
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    const Bytes png = encoded(".png", scene(type));
    const std::optional<cv::Mat> plain = decode_plain_png(png, stored);
    EXPECT_TRUE(plain && same(*plain, scene(type)));
    Bytes damaged = png;
    damaged[png.size() / 2] ^= 1;
    EXPECT_FALSE(decode_plain_png(damaged, stored));
    EXPECT_FALSE(decode_plain_png(std::span(png).first(png.size() - 1), stored));
    EXPECT_FALSE(decode_plain_png(png, {.pixels = PixelsAs::kStored, .max_pixels = 100}));
  }
  EXPECT_FALSE(decode_plain_png(encoded(".png", scene(CV_8UC4)), stored)) << "transparency";
  EXPECT_FALSE(decode_plain_png(encoded(".png", scene(CV_16UC3)), stored));
  EXPECT_FALSE(decode_plain_png(encoded(".png", scene(CV_8UC1)), {.pixels = PixelsAs::kBgr})) << "to be converted";
  EXPECT_FALSE(decode_plain_png({}, stored));
}

TEST(ImageCodecs, decode_motion_jpeg_without_its_huffman_tables) {
  Bytes jpeg = encoded(".jpg", scene(CV_8UC3));
  for (std::size_t table; (table = position_of(jpeg, {0xFF, 0xC4})) < jpeg.size();)
    jpeg.erase(jpeg.begin() + static_cast<std::ptrdiff_t>(table),
               jpeg.begin() + static_cast<std::ptrdiff_t>(table) + 2 + (jpeg[table + 2] << 8 | jpeg[table + 3]));
  EXPECT_EQ(difference_from_opencv(jpeg), "");
}

TEST(ImageCodecs, turn_photos_upright_as_opencv_does) {
  const Bytes jpeg = encoded(".jpg", scene(CV_8UC3));
  for (std::uint8_t orientation = 0; orientation < 10; ++orientation) {
    Bytes photo = jpeg;
    const Bytes exif = {0xFF, 0xE1, 0,    34,   'E', 'x', 'i', 'f', 0, 0, 'I',         'I', 42, 0, 8, 0, 0, 0,
                        1,    0,    0x12, 0x01, 3,   0,   1,   0,   0, 0, orientation, 0,   0,  0, 0, 0, 0, 0};
    photo.insert(photo.begin() + 2, exif.begin(), exif.end());
    EXPECT_EQ(difference_from_opencv(photo), "") << int{orientation};
  }
}

TEST(ImageCodecs, make_no_jpeg_that_is_too_large_to_be_sent) {
  constexpr std::size_t kRest = 1024;  // of the message
  cv::Mat noise(1200, 1920, CV_8UC3);
  cv::randu(noise, 0, 256);
  EXPECT_LE(encode_jpeg(noise, 100).size() + kRest, msg::largest_sample<msg::CompressedImage>());
}

TEST(ImageCodecs, encode_to_the_bytes_of_opencv) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    EXPECT_EQ(encode_jpeg(scene(type)), encoded(".jpg", scene(type)));
    EXPECT_EQ(encode_jpeg(scene(type), 40), encoded(".jpg", scene(type), {cv::IMWRITE_JPEG_QUALITY, 40}));
  }
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3})
    EXPECT_EQ(encode_png(scene(type)), encoded(".png", scene(type), {cv::IMWRITE_PNG_COMPRESSION, 1}));
  const cv::Mat part = scene(CV_8UC3)(cv::Rect(5, 6, 40, 30));
  EXPECT_TRUE(same(decode_image(encode_png(part)).pixels, part)) << "rows that do not follow each other";
  EXPECT_THAT(encode_jpeg(scene(CV_16UC1)), IsEmpty());
  EXPECT_THAT(encode_jpeg({}), IsEmpty());
  EXPECT_THAT(encode_png(cv::Mat(3, 3, CV_32FC1)), IsEmpty());
}

TEST(ImageCodecs, write_and_read_files_by_their_extension) {
  const rtd::test::TemporaryFolder folder;
  const cv::Mat depth = scene(CV_16UC1);
  ASSERT_TRUE(write_image(folder / "a.PNG", depth));
  EXPECT_TRUE(same(read_image(folder / "a.PNG", {.pixels = PixelsAs::kStored}).pixels, depth));
  EXPECT_TRUE(write_image(folder / "a.jpeg", scene(CV_8UC3)));
  EXPECT_FALSE(write_image(folder / "a.bmp", scene(CV_8UC3)));
  EXPECT_THAT(read_image("/nowhere.png").problem, testing::HasSubstr("cannot be read"));
}

TEST(ImageCodecs, refuse_sizes_that_the_bytes_cannot_hold_before_memory_is_taken) {
  const Bytes small = encoded(".jpg", cv::Mat(8, 8, CV_8UC1, cv::Scalar(0)));
  const Bytes bomb = with_jpeg_size(small, 32760, 32700);
  const auto began = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i)
    EXPECT_THAT(decode_image(bomb).problem, HasSubstr("has 32760 x 32700 px, the most that is read is"));
  if (test_support::checks_time()) {
    EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::milliseconds(100)) << "1 ms each";
  }
  EXPECT_THAT(decode_image(with_jpeg_size(small, 1920, 1200)).problem,
              HasSubstr("claims 1920 x 1200 px, which its " + std::to_string(small.size()) + " bytes cannot hold"));
  EXPECT_THAT(decode_image(with_png_size(encoded(".png", scene(CV_8UC1, {8, 8})), 8000, 8000)).problem,
              HasSubstr("cannot hold"));
  EXPECT_THAT(decode_image(with_png_size(encoded(".png", scene(CV_8UC1, {8, 8})), 40000, 4)).problem,
              HasSubstr("cannot be decoded"));
}

TEST(ImageCodecs, read_the_emptiest_images_of_full_size) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const cv::Mat black = cv::Mat::zeros(1200, 1920, type);
    EXPECT_EQ(decode_image(encode_jpeg(black, 1)).problem, "");
    EXPECT_EQ(
        decode_image(encoded(".jpg", black, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_OPTIMIZE, 1})).problem,
        "");
    EXPECT_EQ(decode_image(encoded(".png", black, {cv::IMWRITE_PNG_COMPRESSION, 9})).problem, "");
  }
}

TEST(ImageCodecs, keep_the_rules_of_the_bus) {
  const DecodeRules bus{.jpeg_only = true, .max_pixels = 100 * 100};
  EXPECT_EQ(decode_image(encoded(".jpg", scene(CV_8UC3)), bus).problem, "");
  EXPECT_EQ(decode_image(encoded(".png", scene(CV_8UC3)), bus).problem, "is not a JPEG image");
  EXPECT_THAT(decode_image(encoded(".jpg", scene(CV_8UC3, {101, 100})), bus).problem, HasSubstr("most that is read"));
}

TEST(ImageCodecs, read_no_other_format) {
  for (const char* extension : {".bmp", ".pgm", ".tiff", ".jp2"})
    EXPECT_THAT(decode_image(encoded(extension, scene(CV_8UC1))).problem, HasSubstr("readable: JPEG and PNG"))
        << extension;
  const std::string nitf = "NITF02.10" + std::string(400, '0');
  EXPECT_THAT(decode_image(Bytes(nitf.begin(), nitf.end())).problem, HasSubstr("readable: JPEG and PNG"));
  EXPECT_EQ(decode_image({}).problem, "is empty");
}

TEST(ImageCodecs, refuse_a_progressive_jpeg_of_thousands_of_scans) {
  const Bytes jpeg = encoded(".jpg", scene(CV_8UC3, {640, 480}), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  const auto last = std::ranges::find_end(jpeg, Bytes{0xFF, 0xDA});
  const Bytes scan(last.begin(), jpeg.end() - 2);
  Bytes bomb(jpeg.begin(), jpeg.end() - 2);
  for (int i = 0; i < 5000; ++i) bomb.insert(bomb.end(), scan.begin(), scan.end());
  bomb.insert(bomb.end(), {0xFF, 0xD9});
  const auto began = std::chrono::steady_clock::now();
  EXPECT_THAT(decode_image(bomb).problem, HasSubstr("cannot be decoded"));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(1));
}

TEST(ImageCodecs, refuse_every_truncated_image) {
  for (const Bytes& whole : {encoded(".jpg", scene(CV_8UC3, {24, 24})), encoded(".png", scene(CV_8UC3, {24, 24}))})
    for (std::size_t length = 0; length + 12 < whole.size(); ++length)  // a PNG's pixels end before its last chunk
      EXPECT_NE(decode_image(std::span(whole).first(length)).problem, "") << length << " of " << whole.size();
}

TEST(ImageCodecs, survive_any_damage) {
  std::mt19937 random(1);
  for (const Bytes& whole : {encoded(".jpg", scene(CV_8UC3)), encoded(".png", scene(CV_16UC1)),
                             encoded(".jpg", scene(CV_8UC3), {cv::IMWRITE_JPEG_PROGRESSIVE, 1})}) {
    for (int i = 0; i < 1000; ++i) {
      Bytes damaged = whole;
      for (int changes = 0; changes < 1 + i % 8; ++changes)
        damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
      const DecodedImage image = decode_image(damaged, {.upright = true});
      EXPECT_EQ(image.pixels.empty(), !image.problem.empty());
    }
  }
}

/// Every 25th image of the data that is there: camera images, depth, masks and photos.
TEST(ImageCodecs, decode_the_data_to_the_pixels_of_opencv) {
  const char* const data = std::getenv("RTD_DATA_DIR");
  if (data == nullptr) GTEST_SKIP() << "RTD_DATA_DIR is not set";
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(data))
    if (entry.path().extension() == ".png" || entry.path().extension() == ".jpg") files.push_back(entry.path());
  std::ranges::sort(files);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < files.size(); i += 25, ++compared) {
    std::ifstream file(files[i], std::ios::binary);
    EXPECT_EQ(difference_from_opencv(Bytes(std::istreambuf_iterator<char>(file), {})), "") << files[i];
  }
  EXPECT_GT(compared, 0U);
  RecordProperty("compared", static_cast<int>(compared));
}

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
