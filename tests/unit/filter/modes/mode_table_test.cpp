// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/mode_table.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace rtd::filter {
namespace {

TEST(ModeTable, names_every_technique) {
  std::set<std::string> names;
  for (const NamedTechnique& technique : kTechniques) names.insert(technique.name);
  EXPECT_EQ(names.size(), sizeof(Techniques)) << "one switch, one name";
}

TEST(ModeTable, gives_every_mode_a_name_and_rtd_everything) {
  std::set<std::string> names;
  for (const ModeEntry& entry : all_modes()) {
    names.insert(msg::name_of(entry.mode));
    EXPECT_EQ(&entry_of(entry.mode), &entry);
  }
  EXPECT_EQ(names.size(), all_modes().size());
  for (const NamedTechnique& technique : kTechniques) {
    EXPECT_TRUE(entry_of(FilterMode::kRtd).techniques.*technique.on) << technique.name;
    EXPECT_FALSE(entry_of(FilterMode::kOff).techniques.*technique.on) << technique.name;
  }
}

TEST(ModeTable, knows_which_modes_need_the_detector) {
  for (const ModeEntry& entry : all_modes()) {
    const bool blind = entry.mode == FilterMode::kOff || entry.mode == FilterMode::kGeometry;
    EXPECT_NE(looks_at_boxes(entry.mode), blind) << msg::name_of(entry.mode);
  }
}

TEST(ModeTable, lets_a_mode_use_only_what_is_its_own_and_not_switched_off) {
  FilterConfig chosen;
  chosen.mode = FilterMode::kGeometry;
  chosen.techniques.feature_votes = false;
  const FilterConfig config = effective_config(chosen);
  EXPECT_FALSE(config.techniques.motion_levels) << "not part of the mode";
  EXPECT_FALSE(config.techniques.feature_votes) << "switched off";
  EXPECT_TRUE(config.techniques.depth_check);
}

}  // namespace
}  // namespace rtd::filter
