// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/model_locator.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace rtd::service {
namespace {

namespace fs = std::filesystem;

class OnnxruntimeLocator : public ::testing::Test {
 protected:
  OnnxruntimeLocator() { fs::remove_all(folder_); }
  ~OnnxruntimeLocator() override { fs::remove_all(folder_); }
  std::string make(const std::string& relative) const {
    const fs::path path = folder_ / relative;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << "library";
    return path.string();
  }
  std::string find(const std::string& named = {}) const {
    return find_onnxruntime([&](const std::string&) { return std::optional(named); },
                            {folder_ / "missing", folder_ / "first", folder_ / "second"});
  }
  const fs::path folder_ = fs::path(::testing::TempDir()) / "rtd_onnxruntime_locator";
};

TEST_F(OnnxruntimeLocator, finds_none_where_there_is_none) {
  make("first/libonnxruntime_providers_shared.so");
  fs::create_directories(folder_ / "second/libonnxruntime.so");
  EXPECT_EQ(find(), "");
}

TEST_F(OnnxruntimeLocator, takes_the_first_folder_that_has_it) {
  make("second/libonnxruntime.so");
  const std::string first = make("first/libonnxruntime.so");
  EXPECT_EQ(find(), first);
}

TEST_F(OnnxruntimeLocator, takes_the_newest_of_those_with_a_version) {
  make("first/libonnxruntime.so.1.9.0");
  const std::string newest = make("first/libonnxruntime.so.1.21");
  make("first/libonnxruntime.so.1.20.1");
  EXPECT_EQ(find(), newest);
}

TEST_F(OnnxruntimeLocator, takes_what_the_environment_names_as_it_is) {
  make("first/libonnxruntime.so");
  EXPECT_EQ(find("/opt/mine.so"), "/opt/mine.so");
}

}  // namespace
}  // namespace rtd::service
