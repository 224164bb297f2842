// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/detector.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <span>
#include <stdexcept>

#include "services/detector/core/detector_config.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::detector {
namespace {

using namespace ::testing;

class DetectorTest : public ::testing::Test {
 protected:
  std::string write(const std::string& bytes) const { return folder_.write("model.onnx", bytes); }
  /// One anchor size for all heads would collide in NMS: only the stride-8 head can pass (anchors of the others too
  /// big).
  DetectorConfig config(const test::TinyNetwork& network) const {
    DetectorConfig config;
    config.model_path = write(test::tiny_network_onnx(network));
    config.class_names = {"person", "box"};
    return config;
  }
  const rtd::test::TemporaryFolder folder_;
};

/// A black image in which exactly the cell (row, col) of stride 8 is white: too little for the larger strides.
cv::Mat one_white_cell(cv::Size size, int row, int col) {
  cv::Mat image = cv::Mat::zeros(size, CV_8UC3);
  image(cv::Rect(8 * col, 8 * row, 8, 8)).setTo(cv::Scalar::all(255));
  return image;
}

void expect_the_white_cell(const std::vector<vision::Detection>& found) {
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].class_name, "person");
  EXPECT_GT(found[0].score, 0.99F);
  EXPECT_NEAR(found[0].x_px, 5 * 8 + 4 - 5.0F, 0.01F);  // anchor 10 x 13 centred on the cell
  EXPECT_NEAR(found[0].y_px, 3 * 8 + 4 - 6.5F, 0.01F);
  EXPECT_NEAR(found[0].width_px, 10.0F, 0.01F);
  EXPECT_NEAR(found[0].height_px, 13.0F, 0.01F);
}

TEST_F(DetectorTest, finds_the_white_cell) {
  expect_the_white_cell(Detector(config({})).detect(one_white_cell({64, 64}, 3, 5)));
}

TEST_F(DetectorTest, finds_in_a_batch_what_it_finds_in_each_image) {
  Detector detector(config({.free_batch = true}));
  const std::vector<cv::Mat> images = {one_white_cell({64, 64}, 3, 5), cv::Mat::zeros(64, 64, CV_8UC3),
                                       one_white_cell({128, 128}, 4, 2), one_white_cell({64, 64}, 0, 7)};
  const auto found = detector.detect_batch(images);
  ASSERT_THAT(found, SizeIs(4));
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::vector<vision::Detection> alone = detector.detect(images[i]);
    ASSERT_THAT(found[i], SizeIs(alone.size())) << i;
    for (std::size_t k = 0; k < alone.size(); ++k) {
      EXPECT_EQ(found[i][k].x_px, alone[k].x_px) << i;
      EXPECT_EQ(found[i][k].score, alone[k].score) << i;
    }
  }
  expect_the_white_cell(found[0]);
  EXPECT_THAT(found[1], SizeIs(0));
  EXPECT_THAT(detector.detect_batch({}), SizeIs(0));
}

TEST_F(DetectorTest, finds_the_same_in_batches_of_any_size_up_to_sixteen) {
  Detector detector(config({.free_batch = true}));
  std::vector<cv::Mat> images;
  std::vector<std::vector<vision::Detection>> alone;
  for (int i = 0; i < 16; ++i) {
    images.push_back(one_white_cell({64, 64}, i % 8, i / 2));
    alone.push_back(detector.detect(images.back()));
    ASSERT_THAT(alone.back(), SizeIs(1)) << i;
  }
  for (std::size_t size = 1; size <= images.size(); ++size) {
    const auto together = detector.detect_batch(std::span(images).first(size));
    ASSERT_THAT(together, SizeIs(size));
    for (std::size_t i = 0; i < size; ++i) {
      ASSERT_THAT(together[i], SizeIs(1)) << i << " of " << size;
      EXPECT_EQ(together[i][0].x_px, alone[i][0].x_px) << i << " of " << size;
      EXPECT_EQ(together[i][0].y_px, alone[i][0].y_px) << i << " of " << size;
      EXPECT_EQ(together[i][0].score, alone[i][0].score) << i << " of " << size;
    }
  }
}

TEST_F(DetectorTest, refuses_a_batch_for_a_network_of_one_image) {
  Detector detector(config({}));
  const std::vector<cv::Mat> images(2, one_white_cell({64, 64}, 3, 5));
  EXPECT_THAT(detector.detect_batch(std::span(images).first(1)), SizeIs(1));
  EXPECT_THAT([&] { detector.detect_batch(images); },
              ::testing::ThrowsMessage<std::invalid_argument>(::testing::HasSubstr("--free-batch")));
}

TEST_F(DetectorTest, maps_boxes_of_a_letterboxed_frame_back) {
  Detector detector(config({}));
  cv::Mat image;
  cv::resize(one_white_cell({64, 32}, 2, 3), image, {128, 64}, 0, 0, cv::INTER_NEAREST);
  const std::vector<vision::Detection> found = detector.detect(image);  // 128x64 -> 64x32 + bars of 16
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_NEAR(found[0].x_px + found[0].width_px / 2, 2 * (3 * 8 + 4), 0.01F);
  EXPECT_NEAR(found[0].y_px + found[0].height_px / 2, 2 * (2 * 8 + 4), 0.01F);
  EXPECT_NEAR(found[0].width_px, 20.0F, 0.01F);
}

TEST_F(DetectorTest, clips_boxes_to_the_image) {
  Detector detector(config({}));
  const std::vector<vision::Detection> found = detector.detect(one_white_cell({64, 64}, 0, 0));
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_FLOAT_EQ(found[0].x_px, 0.0F);
  EXPECT_FLOAT_EQ(found[0].y_px, 0.0F);
  EXPECT_NEAR(found[0].width_px, 9.0F, 0.01F);
}

TEST_F(DetectorTest, takes_the_input_size_from_the_configuration_when_the_file_leaves_it_free) {
  DetectorConfig free_size = config({.fixed_size = false});
  free_size.input_width_px = 96;
  free_size.input_height_px = 32;
  Detector detector(free_size);
  EXPECT_EQ(detector.input_size().width_px, 96);
  EXPECT_THAT(detector.detect(one_white_cell({96, 32}, 1, 10)), SizeIs(1));
}

TEST_F(DetectorTest, takes_class_names_and_anchors_from_the_file_when_none_are_configured) {
  DetectorConfig described = config({.metadata = {{"rtd.class_names", "robot\nbox"},
                                                  {"rtd.heads", "8: 20,6 1,1 1,1\n16: 1,1 1,1 1,1\n32: 1,1 1,1 1,1"}}});
  described.class_names.clear();
  const std::vector<vision::Detection> found = Detector(described).detect(one_white_cell({64, 64}, 3, 5));
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].class_name, "robot");
  EXPECT_NEAR(found[0].width_px, 20.0F, 0.01F);
}

TEST_F(DetectorTest, accepts_grey_and_four_channel_images) {
  Detector detector(config({}));
  const cv::Mat color = one_white_cell({64, 64}, 3, 5);
  cv::Mat grey, bgra;
  cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(color, bgra, cv::COLOR_BGR2BGRA);
  EXPECT_THAT(detector.detect(grey), SizeIs(1));
  EXPECT_THAT(detector.detect(bgra), SizeIs(1));
}

TEST_F(DetectorTest, finds_nothing_in_an_empty_image) {
  EXPECT_THAT(Detector(config({})).detect({}), IsEmpty());
}

TEST_F(DetectorTest, refuses_a_pixel_type_that_it_cannot_read) {
  Detector detector(config({}));
  EXPECT_THROW(detector.detect(cv::Mat::zeros(64, 64, CV_16UC1)), std::invalid_argument);
}

TEST_F(DetectorTest, gives_the_same_detections_twice) {
  Detector detector(config({}));
  const cv::Mat image = one_white_cell({64, 64}, 3, 5);
  const std::vector<vision::Detection> first = detector.detect(image), second = detector.detect(image);
  ASSERT_EQ(first.size(), second.size());
  EXPECT_EQ(first[0].score, second[0].score);
  EXPECT_EQ(first[0].x_px, second[0].x_px);
}

void load(const std::string& path, DetectorConfig config = {}) {
  config.model_path = path;
  const Detector detector(config);
}

TEST_F(DetectorTest, names_the_missing_file_and_the_fix) {
  EXPECT_THAT(
      [] { load("/nowhere/model.onnx"); },
      ThrowsMessage<ModelError>(AllOf(HasSubstr("/nowhere/model.onnx"), HasSubstr("deploy/setup.sh --models"))));
}

TEST_F(DetectorTest, refuses_files_that_are_no_model) {
  for (const std::string& bytes : {std::string(), std::string("<html>404</html>"), std::string(5000, '\xff')}) {
    const std::string path = write(bytes);
    EXPECT_THAT([&] { load(path); }, ThrowsMessage<ModelError>(HasSubstr(path)));
  }
  EXPECT_THAT([&] { load(folder_.path().string()); }, ThrowsMessage<ModelError>(HasSubstr(folder_.path().string())));
}

TEST_F(DetectorTest, refuses_a_model_cut_off_anywhere) {
  const std::string bytes = test::tiny_network_onnx({.width_px = 32, .height_px = 32});
  for (std::size_t size = 1; size + 8 < bytes.size(); size += bytes.size() / 23) {
    const std::string path = write(bytes.substr(0, size));
    EXPECT_THROW(load(path), ModelError) << size << " of " << bytes.size() << " bytes";
  }
}

TEST_F(DetectorTest, names_the_shapes_when_the_outputs_do_not_fit) {
  DetectorConfig coco = config({});
  coco.class_names = coco_class_names();
  EXPECT_THAT([&] { load(coco.model_path, coco); },
              ThrowsMessage<ModelError>(AllOf(HasSubstr("1x21x8x8"), HasSubstr("1x255x8x8"))));
}

TEST_F(DetectorTest, refuses_a_model_with_other_outputs_than_one_per_stride) {
  const DetectorConfig two_heads = config({.strides = {8, 16}});
  EXPECT_THAT([&] { load(two_heads.model_path, two_heads); }, ThrowsMessage<ModelError>(HasSubstr("2 outputs")));
}

TEST_F(DetectorTest, names_the_classes_that_the_outputs_have) {
  const DetectorConfig coco = config({});
  EXPECT_THAT([&] { load(coco.model_path); }, ThrowsMessage<ModelError>(HasSubstr("YOLOv5 with 2 classes")));
}

TEST_F(DetectorTest, takes_the_decoder_that_the_file_names_and_no_other) {
  const DetectorConfig named = config({.metadata = {{"rtd.decoder", "yolov5"}}});
  EXPECT_EQ(Detector(named).family(), "YOLOv5");
  const DetectorConfig wrong = config({.metadata = {{"rtd.decoder", "yolox"}}});
  EXPECT_THAT([&] { load(wrong.model_path, wrong); }, ThrowsMessage<ModelError>(HasSubstr("is of no known kind")));
  const DetectorConfig unknown = config({.metadata = {{"rtd.decoder", "detr"}}});
  EXPECT_THAT([&] { load(unknown.model_path, unknown); },
              ThrowsMessage<ModelError>(AllOf(HasSubstr("'detr'"), HasSubstr("there are yolov5, yolox, nanodet"))));
}

TEST_F(DetectorTest, refuses_other_classes_than_the_file_says) {
  const DetectorConfig three = config({.metadata = {{"rtd.class_count", "3"}}});
  EXPECT_THAT([&] { load(three.model_path, three); },
              ThrowsMessage<ModelError>(AllOf(HasSubstr("has 3 classes"), HasSubstr("2 are named"))));
  const DetectorConfig two = config({.metadata = {{"rtd.class_count", "2"}}});
  EXPECT_EQ(Detector(two).config().class_names.size(), 2U);
}

TEST_F(DetectorTest, refuses_an_input_that_the_strides_do_not_divide) {
  DetectorConfig odd = config({.fixed_size = false});
  odd.input_width_px = 100;
  EXPECT_THAT([&] { load(odd.model_path, odd); },
              ThrowsMessage<ModelError>(AllOf(HasSubstr("100x480"), HasSubstr("multiples of 32"))));
}

TEST_F(DetectorTest, refuses_the_real_model_cut_off_anywhere) {
  const char* const folder = std::getenv("RTD_MODEL_DIR");
  if (folder == nullptr) GTEST_SKIP() << "RTD_MODEL_DIR is not set";
  std::ifstream file(std::filesystem::path(folder) / "v5lite-e-raw-320x320.onnx", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.empty()) GTEST_SKIP() << "no v5lite-e-raw-320x320.onnx in RTD_MODEL_DIR";
  for (std::size_t size = 1000; size + 8 < bytes.size(); size += bytes.size() / 7) {
    const std::string path = write(bytes.substr(0, size));
    EXPECT_THROW(load(path), ModelError) << size << " of " << bytes.size() << " bytes";
  }
}

}  // namespace
}  // namespace rtd::detector
