// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/onnxruntime_locator.hpp"

#include <system_error>

namespace rtd::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLibrary = "libonnxruntime.so";

/// The library of a folder; empty when it has none.
std::string library_in(const fs::path& folder) {
  std::error_code ignored;
  if (fs::is_regular_file(folder / kLibrary, ignored)) return (folder / kLibrary).string();
  std::string newest;
  for (fs::directory_iterator entry(folder, ignored), end; entry != end; entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(std::string(kLibrary) + ".") || !entry->is_regular_file(ignored)) continue;
    if (strverscmp(name.c_str(), newest.c_str()) > 0) newest = name;
  }
  return newest.empty() ? std::string() : (folder / newest).string();
}

}  // namespace

std::vector<fs::path> onnxruntime_folders() {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);  // of a build: build/release/bin/NAME
  std::vector<fs::path> folders;
  if (!program.empty()) {
    const fs::path build = program.parent_path().parent_path().parent_path();
    folders.push_back(build / "onnxruntime" / "lib");
  }
  for (const char* folder : {"/usr/local/lib/rtd-slam", "/usr/local/lib", "/usr/lib/x86_64-linux-gnu",
                             "/usr/lib/aarch64-linux-gnu", "/usr/lib64", "/usr/lib"})
    folders.emplace_back(folder);
  return folders;
}

std::string find_onnxruntime(const EnvironmentReader& environment, const std::vector<fs::path>& folders) {
  if (const auto named = environment("RTD_ONNXRUNTIME"); named && !named->empty()) return *named;
  for (const fs::path& folder : folders) {
    if (const std::string library = library_in(folder); !library.empty()) return library;
  }
  return {};
}

std::string find_onnxruntime() {
  return find_onnxruntime(process_environment(), onnxruntime_folders());
}

}  // namespace rtd::service
