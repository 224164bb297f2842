// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The texts that recordings carry against the IDL that the messages are generated from.
#include "common/ros2/type_definition.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "common/ros2/definition_texts.hpp"
#include "common/ros2/names.hpp"

namespace rtd::ros2 {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Fields = std::vector<std::string>;  ///< "type name", the type in the words of .msg files

std::string read_idl(const std::string& package) {
  std::ifstream file(std::string(IDL_FOLDER) + '/' + package + ".idl");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string msg_type(std::string idl_type, const std::string& package) {
  static const std::map<std::string, std::string> kWords = {{"octet", "uint8"},
                                                            {"boolean", "bool"},
                                                            {"long", "int32"},
                                                            {"unsigned long", "uint32"},
                                                            {"float", "float32"},
                                                            {"double", "float64"},
                                                            {"string", "string"},
                                                            {"unsigned short", "uint16"},
                                                            {"short", "int16"},
                                                            {"long long", "int64"},
                                                            {"unsigned long long", "uint64"}};
  if (const auto word = kWords.find(idl_type); word != kWords.end()) return word->second;
  const std::string name = ros_type(idl_type);  // a/msg/B, or B_ of the same package
  const std::size_t infix = name.find("/msg/");
  if (infix != std::string::npos) return name.substr(0, infix) + name.substr(infix + 4);
  return package + '/' + name.substr(0, name.size() - 1);
}

/// The structs of an IDL file by name without the final underscore.
std::map<std::string, Fields> structs_of(const std::string& package) {
  static const std::regex kStruct(R"(struct (\w+)_ \{([^}]*)\})");
  static const std::regex kField(R"((sequence<)?([\w: ]+?)(>)? (\w+)(\[\d+\])?;)");
  const std::string text = read_idl(package);
  std::map<std::string, Fields> structs;
  for (std::sregex_iterator s(text.begin(), text.end(), kStruct), end; s != end; ++s) {
    const std::string body = (*s)[2];
    Fields& fields = structs[(*s)[1]];
    for (std::sregex_iterator f(body.begin(), body.end(), kField); f != end; ++f) {
      std::string idl_type = (*f)[2];
      idl_type.erase(0, idl_type.find_first_not_of(' '));
      const std::string array = (*f)[1].matched ? "[]" : (*f)[5].str();
      fields.push_back(msg_type(idl_type, package) + array + ' ' + (*f)[4].str());
    }
  }
  return structs;
}

/// The fields of a .msg text: without constants and default values, types with their package.
Fields fields_of(const std::string& text, const std::string& package) {
  Fields fields;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string type, name;
    if (!(words >> type >> name) || name.find('=') != std::string::npos) continue;
    if (type == "byte") type = "uint8";
    if (std::isupper(static_cast<unsigned char>(type[0])) != 0) type = package + '/' + type;
    fields.push_back(type + ' ' + name);
  }
  return fields;
}

TEST(TypeDefinitions, texts_have_the_fields_of_our_idl) {
  std::size_t compared = 0;
  for (const char* package : {"builtin_interfaces", "std_msgs", "geometry_msgs", "nav_msgs", "tf2_msgs", "sensor_msgs",
                              "vision_msgs", "diagnostic_msgs"}) {
    for (const auto& [name, fields] : structs_of(package)) {
      const std::string full_name = std::string(package) + '/' + name;
      ASSERT_TRUE(message_texts().contains(full_name)) << full_name;
      EXPECT_EQ(fields_of(message_texts().at(full_name), package), fields) << full_name;
      ++compared;
    }
  }
  EXPECT_EQ(compared, message_texts().size()) << "a text without IDL is not checked";
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

}  // namespace
}  // namespace rtd::ros2
