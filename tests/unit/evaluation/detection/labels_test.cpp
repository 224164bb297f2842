// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/evaluation/core/detection/labels.hpp"

namespace rtd::eval {
namespace {

using namespace ::testing;

constexpr ImageSize kImage{200, 100};
const std::vector<std::string> kNames = {"person", "chair"};

ImageLabels yolo(const std::string& text) {
  return parse_yolo_labels({"a.txt", text}, kImage, kNames);
}

ImageLabels voc(const std::string& objects, const std::string& size = "") {
  return parse_voc_labels({"a.xml", "<annotation>\n" + size + objects + "</annotation>"}, kImage);
}

std::string object(const std::string& corners, const std::string& more = "") {
  return "<object><name>person</name>" + more + "<bndbox>" + corners + "</bndbox></object>\n";
}

const std::string kCorners = "<xmin>11</xmin><ymin>21</ymin><xmax>50</xmax><ymax>60</ymax>";

void expect_box(const LabelledBox& box, double x_px, double y_px, double width_px, double height_px) {
  EXPECT_NEAR(box.x_px, x_px, 1e-9);
  EXPECT_NEAR(box.y_px, y_px, 1e-9);
  EXPECT_NEAR(box.width_px, width_px, 1e-9);
  EXPECT_NEAR(box.height_px, height_px, 1e-9);
}

TEST(YoloLabels, are_shares_of_the_image) {
  const ImageLabels labels = yolo("1 0.5 0.5 0.2 0.4\r\n\n0 0.1 0.2 0.1 0.1\n");
  EXPECT_THAT(labels.problems, IsEmpty());
  ASSERT_THAT(labels.boxes, SizeIs(2));
  EXPECT_EQ(labels.boxes[0].class_name, "chair");
  expect_box(labels.boxes[0], 80, 30, 40, 40);
}

TEST(YoloLabels, of_an_empty_file_are_no_objects) {
  EXPECT_THAT(yolo("").boxes, IsEmpty());
  EXPECT_THAT(yolo("").problems, IsEmpty());
}

TEST(YoloLabels, name_file_line_and_value_of_what_is_wrong) {
  const ImageLabels labels = yolo(
      "0 0.5 0.5 0.2 0.4\n0 0.5 x 0.2 0.4\n0 0.5 0.5\n2 0.5 0.5 0.2 0.4\n-1 0.5 0.5 0.2 0.4\n0 nan 0.5 0.2 0.4\n0 0.5 "
      "0.5 0 0.4\n0 0.5 0.5 -0.2 0.4\n0 3 0.5 0.2 0.4\n0.5 0.5 0.5 0.2 0.4\n0 0.5 0.5 0.2 0.4 0.9\n");
  EXPECT_THAT(labels.boxes, SizeIs(1));
  EXPECT_THAT(labels.problems, ElementsAre(AllOf(HasSubstr("a.txt:2: "), HasSubstr("'x' is not a number")),
                                           AllOf(HasSubstr("a.txt:3: "), HasSubstr("3 columns, expected 5")),
                                           AllOf(HasSubstr("a.txt:4: "), HasSubstr("'2' is not one of 0..1")),
                                           AllOf(HasSubstr("a.txt:5: "), HasSubstr("'-1' is not one of 0..1")),
                                           AllOf(HasSubstr("a.txt:6: "), HasSubstr("'nan' is not a number")),
                                           AllOf(HasSubstr("a.txt:7: "), HasSubstr("has no area")),
                                           AllOf(HasSubstr("a.txt:8: "), HasSubstr("has no area")),
                                           AllOf(HasSubstr("a.txt:9: "), HasSubstr("outside the image of 200 x 100")),
                                           AllOf(HasSubstr("a.txt:10: "), HasSubstr("'0.5' is not one of")),
                                           AllOf(HasSubstr("a.txt:11: "), HasSubstr("6 columns"))));
}

TEST(YoloLabels, are_clipped_to_the_image) {
  expect_box(yolo("0 0.0 0.5 0.2 2\n").boxes.at(0), 0, 0, 20, 100);
}

TEST(YoloLabels, count_an_object_once_that_is_there_twice) {
  const ImageLabels labels = yolo("0 0.5 0.5 0.2 0.4\n0 0.500001 0.5 0.2 0.4\n1 0.5 0.5 0.2 0.4\n");
  EXPECT_THAT(labels.boxes, SizeIs(2));
  EXPECT_THAT(labels.problems, ElementsAre(AllOf(HasSubstr("a.txt:2"), HasSubstr("twice"))));
}

TEST(VocLabels, count_pixels_from_one_to_the_last_inside) {
  const ImageLabels labels = voc(object(kCorners));
  EXPECT_THAT(labels.problems, IsEmpty());
  expect_box(labels.boxes.at(0), 10, 20, 40, 40);
  EXPECT_EQ(labels.boxes[0].class_name, "person");
  EXPECT_FALSE(labels.boxes[0].difficult);
}

TEST(VocLabels, know_difficult_objects) {
  EXPECT_TRUE(voc(object(kCorners, "<difficult>1</difficult>")).boxes.at(0).difficult);
}

TEST(VocLabels, are_scaled_when_the_image_has_another_size) {
  const ImageLabels labels = voc(object(kCorners), "<size><width>400</width><height>50</height></size>");
  expect_box(labels.boxes.at(0), 5, 40, 20, 60);  // clipped at the lower edge
}

TEST(VocLabels, ignore_a_size_of_zero) {
  expect_box(voc(object(kCorners), "<size><width>0</width><height>0</height></size>").boxes.at(0), 10, 20, 40, 40);
}

TEST(VocLabels, name_file_line_and_value_of_what_is_wrong) {
  const ImageLabels labels = voc(object("<xmin>left</xmin><ymin>1</ymin><xmax>2</xmax>") +
                                 "<object><bndbox/></object>\n<object><name>person</name></object>\n" +
                                 object("<xmin>50</xmin><ymin>1</ymin><xmax>20</xmax><ymax>9</ymax>") +
                                 object("<xmin>500</xmin><ymin>1</ymin><xmax>520</xmax><ymax>9</ymax>"));
  EXPECT_THAT(labels.boxes, IsEmpty());
  EXPECT_THAT(labels.problems, ElementsAre(AllOf(HasSubstr("a.xml:2"), HasSubstr("<xmin> is 'left'")),
                                           AllOf(HasSubstr("a.xml:2"), HasSubstr("<ymax> is ''")),
                                           AllOf(HasSubstr("a.xml:3"), HasSubstr("without <name>")),
                                           AllOf(HasSubstr("a.xml:4"), HasSubstr("without <bndbox>")),
                                           AllOf(HasSubstr("a.xml:5"), HasSubstr("has no area")),
                                           AllOf(HasSubstr("a.xml:6"), HasSubstr("outside the image"))));
}

TEST(VocLabels, survive_what_is_no_annotation) {
  for (const std::string text : {"", "<annotation><object>", "<html/>", "0 0.5 0.5 0.1 0.1", "\xff\xfe"}) {
    const ImageLabels labels = parse_voc_labels({"a.xml", text}, kImage);
    EXPECT_THAT(labels.boxes, IsEmpty()) << text;
    EXPECT_THAT(labels.problems, ElementsAre(HasSubstr("a.xml:"))) << text;
  }
}

}  // namespace
}  // namespace rtd::eval
