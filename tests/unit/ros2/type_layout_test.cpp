// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/type_description.hpp"

#include <gtest/gtest.h>

namespace rtd::ros2 {
namespace {

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

}  // namespace
}  // namespace rtd::ros2
