// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "common/ros2/type_description.hpp"
#include "tests/support/rmw_user_data.hpp"

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
    {"nav_msgs::msg::dds_::MapMetaData_", "2772d4b2000ef2b35dbaeb80fd3946c1369f817fb4f75677d916d27c17d763c8"},
    {"nav_msgs::msg::dds_::OccupancyGrid_", "8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
    {"geometry_msgs::msg::dds_::TransformStamped_", "0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206"},
    {"tf2_msgs::msg::dds_::TFMessage_", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
    {"sensor_msgs::msg::dds_::Image_", "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
    {"sensor_msgs::msg::dds_::CompressedImage_", "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"},
    {"sensor_msgs::msg::dds_::CameraInfo_", "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"},
    {"sensor_msgs::msg::dds_::Imu_", "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
    {"sensor_msgs::msg::dds_::PointCloud2_", "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
    {"vision_msgs::msg::dds_::Detection2DArray_", "214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968"},
    {"vision_msgs::msg::dds_::Detection3DArray_", "793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"},
    {"visualization_msgs::msg::dds_::MarkerArray_", "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"},
    {"diagnostic_msgs::msg::dds_::DiagnosticArray_",
     "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"}};

TEST(TypeHash, of_each_standard_type_is_the_one_that_ros2_has) {
  for (const Published& published : kPublished) {
    EXPECT_EQ(type_hash(published.dds_type), std::string("RIHS01_") + published.hash) << published.dds_type;
  }
}

TEST(TypeHash, knows_every_primitive_and_kind_of_field) {
  using Kind = MessageField::Kind;
  EXPECT_EQ(type_hash("std_msgs/String", {{"std_msgs/String", {{"string", "data"}}}}),
            "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
  MessageFields types = {{"a/B", {{"int16", "value"}}}, {"a/All", {{"a/B", "one"}}}};
  std::set<std::string> hashes = {type_hash("a/All", types)};
  for (const char* type : {"bool", "byte", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
                           "float32", "float64", "string", "a/B"}) {
    for (const MessageField& field : {MessageField{type, "x"}, MessageField{type, "x", Kind::kSequence},
                                      MessageField{type, "x", Kind::kArray, 2}}) {
      types["a/All"] = {field};
      EXPECT_TRUE(hashes.insert(type_hash("a/All", types)).second) << type << " is like another";
    }
  }
  EXPECT_EQ(hashes.begin()->size(), 7U + 64U);
  types["a/All"] = {{"a/Unknown", "x"}};
  EXPECT_THROW(type_hash("a/All", types), std::out_of_range);
}

TEST(TypeHash, of_a_service_is_that_of_both_its_messages) {
  for (const char* part : {"_Request_", "_Response_"}) {
    const auto hash = [&](const std::string& service) { return type_hash(service + part); };
    EXPECT_EQ(hash("std_srvs::srv::dds_::Trigger"),
              "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f");
    EXPECT_EQ(hash("std_srvs::srv::dds_::SetBool"),
              "RIHS01_abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a");
    EXPECT_EQ(hash("rcl_interfaces::srv::dds_::ListParameters"),
              "RIHS01_3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d");
    EXPECT_EQ(hash("rcl_interfaces::srv::dds_::DescribeParameters"),
              "RIHS01_845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff");
  }
  EXPECT_EQ(type_hash("rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"),
            "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e");
}

TEST(TypeHash, exists_for_our_own_types_too) {
  for (const auto& [type, fields] : message_fields()) {
    const std::size_t slash = type.find('/');
    const std::string dds = type.substr(0, slash) + "::msg::dds_::" + type.substr(slash + 1) + '_';
    EXPECT_EQ(type_hash(dds).size(), 7U + 64U) << type;
  }
  EXPECT_EQ(type_hash("rtd_msgs::srv::dds_::Command_Request_").size(), 7U + 64U);
  // Fields of ROS 2 have small letters.
  EXPECT_EQ(type_hash("a/B", {{"a/B", {{"int16", "T_world_camera"}}}}),
            type_hash("a/B", {{"a/B", {{"int16", "t_world_camera"}}}}));
}

TEST(TypeHash, of_an_unknown_type_is_none_but_its_endpoints_announce_something) {
  for (const char* type :
       {"unknown_msgs::msg::dds_::Thing_", "unknown_srvs::srv::dds_::Thing_Request_", "KeyedSeq", ""}) {
    EXPECT_EQ(type_hash(type), "") << type;
    EXPECT_EQ(rtd::testing::parse_user_data(user_data_of(type)), rtd::testing::UserData::kNoHash) << type;
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

TEST(TypeHash, is_read_by_a_parser_as_rmw_cyclonedds_has_it) {
  using rtd::testing::parse_user_data;
  using rtd::testing::UserData;
  EXPECT_EQ(parse_user_data(user_data_of("nav_msgs::msg::dds_::Odometry_")), UserData::kHash);
  EXPECT_EQ(parse_user_data(""), UserData::kWarning) << "an endpoint without USER_DATA";
  EXPECT_EQ(parse_user_data("typehash=RIHS01_12;"), UserData::kWarning);
  EXPECT_EQ(parse_user_data("serviceid=01.02;"), UserData::kNoHash);
  EXPECT_EQ(parse_user_data("not a list"), UserData::kNoHash);
}

TEST(MessageFields, have_kinds_and_words_of_ros2) {
  using Kind = MessageField::Kind;
  const std::vector<MessageField>& info = *fields_of("sensor_msgs/CameraInfo");
  ASSERT_EQ(info.size(), 11U);
  EXPECT_EQ(info[0].type, "std_msgs/Header");
  EXPECT_TRUE(info[0].is_message());
  EXPECT_EQ(info[1].type, "uint32");
  EXPECT_EQ(info[4].type, "float64");
  EXPECT_EQ(info[4].name, "d");
  EXPECT_EQ(info[4].kind, Kind::kSequence);
  EXPECT_EQ(info[7].kind, Kind::kArray);
  EXPECT_EQ(info[7].capacity, 12U);
  EXPECT_FALSE(info[7].is_message());
  EXPECT_EQ(fields_of("rtd_msgs/TrackingResult")->at(7).type, "uint32") << "an enum goes as its number";
  EXPECT_EQ(fields_of("rtd_msgs/RgbdFrame")->at(0).type, "uint64");
  EXPECT_EQ(fields_of("rtd_msgs/Nothing"), nullptr);
}

}  // namespace
}  // namespace rtd::ros2
