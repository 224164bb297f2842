// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "common/security/keystore.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::security {

inline constexpr std::int64_t kDay_s = 86400;
inline constexpr std::int64_t kNow_s = 1'800'000'000;  // January 2027

/// Folders of one test, removed at the end.
class KeystoreTest : public ::testing::Test {
 protected:
  /// A keystore for the ten days around kNow_s with the enclaves /a, which publishes topic t, and /b, which subscribes
  /// rt/*.
  std::string create(const std::string& name, DomainRange domains = {}) const {
    const std::string folder = scratch_.file(name);
    const Validity validity{kNow_s - 5 * kDay_s, kNow_s + 5 * kDay_s};
    create_keystore(folder, {validity, validity, {domains, {"t"}}});
    add_enclaves(folder, {{"/a", {{"t"}, {}}}, {"/b", {{}, {"rt/*"}}}}, validity, domains);
    return folder;
  }

  const rtd::test::TemporaryFolder scratch_;
};

/// What() of the SecurityError that `action` throws; a failure when it throws none.
template <class Action>
std::string error_of(Action action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing thrown";
  return {};
}

}  // namespace rtd::security
