// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/evaluation_page/rendered.hpp"

#include <gtest/gtest.h>

#include "common/io/atomic_file.hpp"
#include "tests/support/run_command.hpp"

namespace rtd::eval::testing_support {

bool has_node() {
  return ::rtd::testing::run_command("node --version").exit_code == 0;
}

std::string rendered(const std::string& html, const std::string& scratch_file, int width_px, int turned_px) {
  io::write_file(scratch_file, html);
  const auto result =
      ::rtd::testing::run_command("timeout 60 node " RTD_RENDER_PAGE " " + scratch_file + " " +
                                  std::to_string(width_px) + (turned_px == 0 ? "" : " " + std::to_string(turned_px)));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  return result.output;
}

}  // namespace rtd::eval::testing_support
