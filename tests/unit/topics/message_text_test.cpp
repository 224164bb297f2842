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

}  // namespace
}  // namespace rtd::topics
