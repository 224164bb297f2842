// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// What a build without liboctomap has in place of the writer.
#include <gmock/gmock.h>

#include <sstream>

#include "common/occupancy/octomap_file.hpp"

namespace rtd::occupancy {
namespace {

TEST(WithoutOctomap, says_what_to_install_and_writes_nothing) {
  EXPECT_THAT(octomap_left_out(), testing::HasSubstr("install liboctomap-dev"));
  std::ostringstream out;
  EXPECT_THROW(write_octomap(out, Volume{}), OctomapError);
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace rtd::occupancy
