// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/service/json_text.hpp"

namespace rtd::service {
namespace {

TEST(Log, a_quoted_text_can_forge_no_line_and_no_colour) {
  const auto before = spdlog::default_logger();
  testing::internal::CaptureStderr();
  init_logging("slam", "info");
  SPDLOG_WARN("event=peer message=\"{}\"", "x\"\n12:00:00.000 error slam event=disk_full\033[2J");
  spdlog::default_logger()->flush();
  const std::string text = testing::internal::GetCapturedStderr();
  spdlog::set_default_logger(before);
  EXPECT_EQ(std::ranges::count(text, '\n'), 1) << text;
  EXPECT_NE(text.find("\\x0a12:00:00.000 error slam event=disk_full\\x1b[2J"), std::string::npos) << text;
}

TEST(JsonText, holds_nothing_that_a_terminal_obeys) {
  const nlohmann::json json{{"name", "a\033\x7f\xc2\x9b\xe2\x80\xae\xc3\xbc"}};
  EXPECT_EQ(json_line(json), "{\"name\":\"a\\u001b\\u007f\\u009b\\u202e\xc3\xbc\"}");
  EXPECT_EQ(nlohmann::json::parse(json_text(json)), json) << "and stays the same JSON";
}

}  // namespace
}  // namespace rtd::service
