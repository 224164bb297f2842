// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "common/security/keystore.hpp"

namespace rtd::security {

inline constexpr std::int64_t kDay_s = 86400;
inline constexpr std::int64_t kNow_s = 1'800'000'000;  // January 2027

/// Folders of one test, removed at the end.
class KeystoreTest : public ::testing::Test {
 protected:
  KeystoreTest() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    scratch_ = std::filesystem::path(::testing::TempDir()) / (std::string(test->name()) + std::to_string(getpid()));
    std::filesystem::remove_all(scratch_);
    std::filesystem::create_directories(scratch_);
  }
  ~KeystoreTest() override { std::filesystem::remove_all(scratch_); }

  /// A keystore for the ten days around kNow_s with the enclaves /a, which publishes topic t, and /b, which subscribes
  /// rt/*.
  std::string create(const std::string& name, DomainRange domains = {}) const {
    const std::string folder = (scratch_ / name).string();
    const Validity validity{kNow_s - 5 * kDay_s, kNow_s + 5 * kDay_s};
    create_keystore(folder, {validity, validity, {domains, {"t"}}});
    add_enclaves(folder, {{"/a", {{"t"}, {}}}, {"/b", {{}, {"rt/*"}}}}, validity, domains);
    return folder;
  }

  std::filesystem::path scratch_;
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
