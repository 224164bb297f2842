// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/core/topic_report.hpp"

#include <gtest/gtest.h>

namespace rtd::topics {
namespace {

TEST(MessageText, is_yaml_for_people) {
  const auto message = nlohmann::ordered_json::parse(R"({
    "header": {"stamp": {"sec": 1, "nanosec": 5}, "frame_id": "map"},
    "k": [1.0, 0.25, "nan"], "none": [], "ok": true,
    "data": {"count": 921600, "first": [1, 2]},
    "boxes": [{"id": "a", "at": {"x": 1.5}}, {"id": "b", "at": {"x": 2}}],
    "poses": {"count": 9, "first": [{"x": 1}]}})");
  EXPECT_EQ(message_text(message),
            "header:\n"
            "  stamp:\n"
            "    sec: 1\n"
            "    nanosec: 5\n"
            "  frame_id: \"map\"\n"
            "k: [1, 0.25, .nan]\n"
            "none: []\n"
            "ok: true\n"
            "data: [1, 2, ... 921600 values]\n"
            "boxes:\n"
            "- id: \"a\"\n"
            "  at:\n"
            "    x: 1.5\n"
            "- id: \"b\"\n"
            "  at:\n"
            "    x: 2\n"
            "poses:  # the first of 9\n"
            "- x: 1\n"
            "---\n");
}

TEST(MessageText, for_people_has_dates_few_digits_and_short_arrays) {
  const auto message = nlohmann::ordered_json::parse(R"({
    "header": {"stamp": {"sec": 1764171062, "nanosec": 123000000}, "frame_id": "map"},
    "x": 1.23456789012, "tiny": 1e-12,
    "covariance": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    "data": {"count": 9, "first": [1, 1, 1, 1, 1, 1]},
    "few": [2, 2]})");
  EXPECT_EQ(message_text(message, Detail::kReadable),
            "header:\n"
            "  stamp: 2025-11-26 15:31:02.123 UTC\n"
            "  frame_id: \"map\"\n"
            "x: 1.234568\n"
            "tiny: 1e-12\n"
            "covariance: [6 x 0]\n"
            "data: [1, 1, 1, 1, 1, 1, ... 9 values]\n"
            "few: [2, 2]\n"
            "---\n");
  EXPECT_NE(message_text(message, Detail::kAll).find("nanosec: 123000000"), std::string::npos);
}

}  // namespace
}  // namespace rtd::topics
