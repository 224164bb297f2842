// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/type_hash.hpp"

#include <gtest/gtest.h>

#include "common/ros2/message_fields.hpp"

namespace rtd::ros2 {
namespace {

struct Published {
  const char* dds_type;
  const char* hash;  ///< as ROS 2 (Iron, Jazzy) prints it: ros2 topic info --verbose
};

constexpr Published kPublished[] = {
    {"builtin_interfaces::msg::dds_::Time_", "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197"},
    {"std_msgs::msg::dds_::Header_", "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"},
    {"geometry_msgs::msg::dds_::PoseStamped_", "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"},
    {"nav_msgs::msg::dds_::Odometry_", "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
    {"nav_msgs::msg::dds_::Path_", "1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b"},
    {"tf2_msgs::msg::dds_::TFMessage_", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
    {"sensor_msgs::msg::dds_::Image_", "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
    {"sensor_msgs::msg::dds_::CompressedImage_", "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"},
    {"sensor_msgs::msg::dds_::CameraInfo_", "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"},
    {"sensor_msgs::msg::dds_::PointCloud2_", "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
    {"vision_msgs::msg::dds_::Detection2DArray_", "214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968"},
    {"diagnostic_msgs::msg::dds_::DiagnosticArray_",
     "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"}};

TEST(TypeHash, of_each_standard_type_is_the_one_that_ros2_has) {
  for (const Published& published : kPublished) {
    EXPECT_EQ(type_hash(published.dds_type), std::string("RIHS01_") + published.hash) << published.dds_type;
  }
}

TEST(TypeHash, knows_every_primitive_and_kind_of_field) {
  EXPECT_EQ(type_hash("std_msgs/String", {{"std_msgs/String", "string data\n"}}),
            "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
  const std::map<std::string, std::string> texts = {
      {"a/All",
       "bool a\nbyte b\nchar c\nint8 d\nuint16 e\nint64 f\nuint64 g\nfloat32 h\nwstring i\nB[<=3] j\nB[2] k\n"},
      {"a/B", "int16 value\n"}};
  EXPECT_EQ(type_hash("a/All", texts).size(), 7U + 64U);
}

TEST(TypeHash, is_told_of_types_of_ros2_only) {
  for (const char* type : {"rtd_msgs::msg::dds_::RgbdFrame_", "unknown_msgs::msg::dds_::Thing_", "KeyedSeq", ""}) {
    EXPECT_EQ(type_hash(type), "") << type;
    EXPECT_EQ(user_data_of(type), "") << type;
  }
}

TEST(TypeHash, goes_into_user_data_and_is_found_in_that_of_others) {
  const std::string hash = type_hash("nav_msgs::msg::dds_::Odometry_");
  EXPECT_EQ(user_data_of("nav_msgs::msg::dds_::Odometry_"), "typehash=" + hash + ";");
  EXPECT_EQ(hash_in("typehash=" + hash + ";"), hash);
  EXPECT_EQ(hash_in("enclave=/;typehash=" + hash + ";more=1;"), hash);
  EXPECT_EQ(hash_in("typehash=" + hash), hash);
  EXPECT_EQ(hash_in("mytypehash=" + hash + ";"), "");
  EXPECT_EQ(hash_in(""), "");
}

TEST(MessageFields, have_kinds_and_packages_and_leave_out_constants) {
  const auto fields = fields_of(
      "# a comment\nuint8 OK=0\nuint8 BAD = 1\nfloat64 x 0.5 # default\nHeader[] many\nstd_msgs/Header[<=4] few\n"
      "float64[36] covariance\n",
      "mine");
  ASSERT_EQ(fields.size(), 4U);
  using Kind = MessageField::Kind;
  EXPECT_EQ(fields[0].type, "float64");
  EXPECT_EQ(fields[0].kind, Kind::kOne);
  EXPECT_EQ(fields[1].type, "mine/Header");
  EXPECT_EQ(fields[1].kind, Kind::kSequence);
  EXPECT_EQ(fields[2].type, "std_msgs/Header");
  EXPECT_EQ(fields[2].kind, Kind::kBoundedSequence);
  EXPECT_EQ(fields[2].capacity, 4U);
  EXPECT_EQ(fields[3].name, "covariance");
  EXPECT_EQ(fields[3].capacity, 36U);
  EXPECT_FALSE(fields[3].is_message());
}

}  // namespace
}  // namespace rtd::ros2
