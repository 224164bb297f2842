// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The lists of fields against the IDL files, and the texts that recordings carry.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <openssl/sha.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "common/ros2/names.hpp"
#include "common/ros2/schema_texts.hpp"
#include "common/ros2/type_description.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::ros2 {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string sha256(const std::string& text) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest);
  std::string hex;
  for (const unsigned char byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

std::string dds_name(const std::string& type) {
  const std::size_t slash = type.find('/');
  return type.substr(0, slash) + "::msg::dds_::" + type.substr(slash + 1) + '_';
}

/// A field as the IDL of `package` has it.
std::string idl_of(const MessageField& field, const std::string& package) {
  static const std::map<std::string, std::string> kWords = {
      {"uint8", "octet"},           {"byte", "octet"},           {"bool", "boolean"},
      {"int16", "short"},           {"int32", "long"},           {"int64", "long long"},
      {"uint16", "unsigned short"}, {"uint32", "unsigned long"}, {"uint64", "unsigned long long"},
      {"float32", "float"},         {"float64", "double"}};
  const auto word = kWords.find(field.type);
  std::string type = word != kWords.end() ? word->second : field.type;
  if (field.is_message()) {
    const bool local = field.type.starts_with(package + '/');
    type = local ? field.type.substr(package.size() + 1) + '_' : dds_name(field.type);
  }
  if (field.kind == MessageField::Kind::kSequence) type = "sequence<" + type + '>';
  const bool array = field.kind == MessageField::Kind::kArray;
  return "  " + type + ' ' + field.name + (array ? '[' + std::to_string(field.capacity) + ']' : "") + ";\n";
}

/// Both vendors' generators compile this very text, so equal text is equal names and types.
TEST(MessageFields, are_the_structs_of_the_idl_files) {
  std::map<std::string, std::string> idl;
  std::size_t structs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(IDL_FOLDER)) {
    if (entry.path().extension() != ".idl") continue;
    const std::string text = idl[entry.path().stem()] = text_of(entry.path());
    for (std::size_t at = 0; (at = text.find("\nstruct ", at)) != std::string::npos; ++at) ++structs;
  }
  for (const auto& [type, fields] : message_fields()) {
    const std::string package = type.substr(0, type.find('/'));
    std::string text = "@final\nstruct " + type.substr(package.size() + 1) + "_ {\n";
    for (const MessageField& field : fields) text += idl_of(field, package);
    EXPECT_THAT(idl[package], HasSubstr(text + "};\n")) << type;
    EXPECT_THAT(idl[package], HasSubstr("module " + package + " { module msg { module dds_ {\n"));
  }
  EXPECT_EQ(structs, message_fields().size()) << "a struct of the IDL is not checked";
}

TEST(TypeDefinitions, texts_and_hashes_are_the_recorded_ones) {
  std::istringstream recorded(text_of(std::string(IDENTITY_FOLDER) + "/schema_hashes.txt"));
  std::set<std::string> compared;
  for (std::string line; std::getline(recorded, line);) {
    if (line.starts_with('#')) continue;
    const std::string type = line.substr(0, line.find(' '));
    const TypeDefinition definition = definition_of(type);
    const std::string hash = type_hash(type);
    EXPECT_EQ(line, fmt::format("{} {} {} {} {}", type, definition.name, definition.encoding, sha256(definition.text),
                                hash.empty() ? "-" : hash))
        << definition.text;
    compared.insert(type);
  }
  for (const auto& [type, fields] : message_fields()) EXPECT_TRUE(compared.contains(dds_name(type))) << type;
}

/// idl/ros2/rtd_msgs, from which a workspace of ROS 2 makes the types that we announce by their hashes.
TEST(TypeDefinitions, the_package_of_ros2_has_each_type_of_ours) {
  const std::filesystem::path folder = std::filesystem::path(IDL_FOLDER) / "ros2/rtd_msgs/msg";
  std::set<std::string> missing;
  for (const auto& [type, fields] : message_fields()) {
    if (type.starts_with("rtd_msgs/")) missing.insert(type.substr(type.find('/') + 1) + ".msg");
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    ASSERT_EQ(missing.erase(name), 1U) << name << " is no message of ours";
    const std::string text = text_of(entry.path()), type = "rtd_msgs/" + entry.path().stem().string();
    EXPECT_EQ(text, msg_file(type)) << name << " is to be this text";
    const MessageFields read = ros::parse_definition(type, ros2msg_text(type, message_fields()));
    EXPECT_EQ(type_hash(type, read), type_hash(type, message_fields())) << "the hash that ROS 2 computes of the file";
  }
  EXPECT_TRUE(missing.empty()) << *missing.begin() << " is missing";
}

TEST(TypeDefinitions, are_complete) {
  const TypeDefinition odometry = definition_of("nav_msgs::msg::dds_::Odometry_");
  EXPECT_EQ(odometry.name, "nav_msgs/msg/Odometry");
  EXPECT_EQ(odometry.encoding, "ros2msg");
  EXPECT_TRUE(odometry.text.starts_with("std_msgs/Header header\n"));
  for (const char* part : {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/PoseWithCovariance",
                           "geometry_msgs/Pose", "geometry_msgs/Point", "geometry_msgs/Vector3"}) {
    EXPECT_THAT(odometry.text, HasSubstr(std::string(80, '=') + "\nMSG: " + part + '\n'));
  }
}

TEST(TypeDefinitions, our_own_types_come_as_idl_under_the_name_in_it) {
  const TypeDefinition frame = definition_of("rtd_msgs::msg::dds_::RgbdFrame_");
  EXPECT_EQ(frame.name, "rtd_msgs::msg::dds_::RgbdFrame_");
  EXPECT_EQ(frame.encoding, "omgidl");
  EXPECT_THAT(frame.text, HasSubstr("module rtd_msgs { module msg { module dds_ {"));
  EXPECT_THAT(frame.text, HasSubstr("octet color_bgr[921600];"));
  EXPECT_THAT(frame.text, Not(HasSubstr("#")));
}

TEST(TypeDefinitions, an_unknown_type_has_a_name_and_nothing_else) {
  for (const char* type : {"unknown_msgs::msg::dds_::Thing_", "rtd_msgs::msg::dds_::Nothing_", "KeyedSeq", ""}) {
    const TypeDefinition definition = definition_of(type);
    EXPECT_FALSE(definition.known()) << type;
    EXPECT_EQ(definition.text, "");
    EXPECT_EQ(definition.name, ros_type(type));
  }
}

TEST(SchemaTexts, come_back_from_their_sample_and_garbage_is_refused) {
  const std::vector<std::byte> cdr = encode_schemas({{"a::msg::dds_::B_", {"a/msg/B", "ros2msg", "int32 x\n"}}});
  const std::vector<SchemaText> schemas = decode_schemas(cdr);
  ASSERT_EQ(schemas.size(), 1U);
  EXPECT_EQ(schemas[0].dds_type, "a::msg::dds_::B_");
  EXPECT_EQ(schemas[0].definition.name, "a/msg/B");
  EXPECT_EQ(schemas[0].definition.encoding, "ros2msg");
  EXPECT_EQ(schemas[0].definition.text, "int32 x\n");
  EXPECT_THROW(decode_schemas(std::span(cdr).first(cdr.size() / 2)), ros::WireError);
}

constexpr const char* kIdl = R"(
// struct Frame_ { of former times
module m { struct Point_ { double x; };  // metres
@final struct Frame_ { unsigned long long seq; sequence<Point_> points; octet data[16]; };
struct Other_ { long a; }; };)";

TEST(TypeLayout, is_the_same_for_other_comments_blanks_and_neighbours) {
  constexpr const char* kOther = R"(module m {
  struct Point_ {
    double x;
  };
  struct Frame_ {
    unsigned long long seq; // counts from 0
    sequence< Point_ > points;
    octet data [ 16 ];
  };
};)";
  EXPECT_FALSE(layout_in(kIdl, "Frame_").empty());
  EXPECT_EQ(layout_in(kIdl, "Frame_"), layout_in(kOther, "Frame_"));
}

TEST(TypeLayout, changes_with_fields_of_the_type_and_of_those_that_it_is_made_of) {
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string idl = kIdl;
    idl.replace(idl.find(from), from.size(), to);
    return layout_in(idl, "Frame_") != layout_in(kIdl, "Frame_");
  };
  EXPECT_TRUE(changed("octet data[16]", "octet data[17]"));
  EXPECT_TRUE(changed("octet data[16]; ", ""));
  EXPECT_TRUE(changed("double x", "float x"));
  EXPECT_FALSE(changed("long a", "double a"));
}

TEST(TypeLayout, is_empty_without_a_definition_and_ends_in_damaged_texts) {
  EXPECT_EQ(layout_in("", "Frame_"), "");
  EXPECT_EQ(layout_in(kIdl, "Image_"), "");
  EXPECT_FALSE(layout_in("struct Frame_ { Frame_ again", "Frame_").empty());
}

TEST(Ros2Names, topics_go_there_and_back) {
  EXPECT_EQ(ros_topic("rt/slam/odometry"), "/slam/odometry");
  EXPECT_EQ(ros_topic("rtd/frame"), "rtd/frame");
  EXPECT_EQ(ros_topic("rt"), "rt");
  for (const char* topic : {"rt/slam/odometry", "rtd/frame", "rt/a", "rq/add_two_intsRequest", "rt", "DDSPerfRData"}) {
    EXPECT_EQ(dds_topic(ros_topic(topic)), topic);
  }
}

TEST(Ros2Names, types_go_there_and_back) {
  EXPECT_EQ(ros_type("nav_msgs::msg::dds_::Odometry_"), "nav_msgs/msg/Odometry");
  EXPECT_EQ(ros_type("example_interfaces::srv::dds_::AddTwoInts_Request_"),
            "example_interfaces/srv/AddTwoInts_Request");
  for (const char* type : {"nav_msgs::msg::dds_::Odometry_", "KeyedSeq", "a::b::C", "x::msg::dds_::No", "dds_", ""}) {
    EXPECT_EQ(dds_type(ros_type(type)), type);
  }
}

TEST(Names, patterns_fit_either_spelling_of_a_topic) {
  for (const char* topic : {"/slam/pose", "rt/slam/pose"}) {
    for (const char* pattern : {"/slam/*", "rt/slam/pose", "rt/*", "*"}) EXPECT_TRUE(matches_topic(pattern, topic));
    for (const char* pattern : {"slam/pose", "/slam", "rtd/*"}) EXPECT_FALSE(matches_topic(pattern, topic));
  }
  EXPECT_TRUE(matches_topic("rtd/*", "rtd/anna/frame"));
}

}  // namespace
}  // namespace rtd::ros2
