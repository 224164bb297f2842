// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/model_locator.hpp"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

namespace rtd::service {
namespace {

constexpr const char* kAdvice =
    "run `deploy/setup.sh --models` (downloads 3.6 MB and converts them), or point RTD_MODEL_DIR at a folder that has "
    "them";

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

std::vector<std::filesystem::path> search_folders(const EnvironmentReader& environment) {
  const auto value = [&environment](const char* name) { return environment(name).value_or(""); };
  std::vector<std::filesystem::path> folders;
  if (const std::string folder = value("RTD_MODEL_DIR"); !folder.empty()) folders.emplace_back(folder);
  if (const std::string cache = value("XDG_CACHE_HOME"); !cache.empty()) {
    folders.push_back(std::filesystem::path(cache) / "rtd-slam");
  } else if (const std::string home = value("HOME"); !home.empty()) {
    folders.push_back(std::filesystem::path(home) / ".cache" / "rtd-slam");
  }
  // For all users of this computer: deploy/install.sh puts them into the first one.
  std::istringstream shared(environment("XDG_DATA_DIRS").value_or("/usr/local/share:/usr/share"));
  for (std::string folder; std::getline(shared, folder, ':');)
    if (!folder.empty()) folders.push_back(std::filesystem::path(folder) / "rtd-slam" / "models");
  return folders;
}

}  // namespace

ModelSearch find_model(const std::string& configured, const EnvironmentReader& environment) {
  const std::string name = configured.empty() ? kDefaultModelFile : configured;
  if (name.find('/') != std::string::npos) {
    if (is_file(name)) return {name, {}};
    return {{}, "no detector weights: detector.model is '" + name + "', which is no file; correct it, or " + kAdvice};
  }
  std::string looked;
  for (const std::filesystem::path& folder : search_folders(environment)) {
    if (is_file(folder / name)) return {(folder / name).string(), {}};
    looked += looked.empty() ? "" : ", ";
    looked += folder.string();
  }
  return {{}, "no detector weights: looked for " + name + " in " + looked + "; " + kAdvice};
}

std::string kernel_cache_folder(const EnvironmentReader& environment) {
  if (const auto cache = environment("XDG_CACHE_HOME"); cache && !cache->empty()) return *cache + "/rtd-slam/opencl";
  const auto home = environment("HOME");
  return home && !home->empty() ? *home + "/.cache/rtd-slam/opencl" : std::string();
}

std::string state_folder(const EnvironmentReader& environment) {
  const std::string folders = environment("STATE_DIRECTORY").value_or("");
  return folders.substr(0, folders.find(':'));  // of several the first
}

EnvironmentReader process_environment() {
  return [](const std::string& name) -> std::optional<std::string> {
    const char* const value = std::getenv(name.c_str());
    return value == nullptr ? std::nullopt : std::optional<std::string>(value);
  };
}

}  // namespace rtd::service
