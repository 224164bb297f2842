// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/library_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace rtd::bus {
namespace {

std::string printed(const auto& work) {
  testing::internal::CaptureStderr();
  work();
  return testing::internal::GetCapturedStderr();
}

TEST(LibraryLog, quotes_what_a_peer_made_of_itself_as_text) {
  LibraryLog log("DDS");
  EXPECT_EQ(printed([&] { log.print("topic \033[31mRED\nforged \n"); }), "DDS: topic \\x1b[31mRED\\x0aforged\n");
}

TEST(LibraryLog, is_short_however_much_a_peer_causes) {
  LibraryLog log("DDS");
  const std::string text = printed([&] {
    for (int i = 0; i < 100; ++i) log.print(std::string(10'000, 'x'));
  });
  EXPECT_EQ(std::ranges::count(text, '\n'), 10);
  EXPECT_LT(text.size(), 2600U);
}

}  // namespace
}  // namespace rtd::bus
