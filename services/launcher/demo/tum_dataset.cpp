// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/demo/tum_dataset.hpp"

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <regex>
#include <stdexcept>

#include "common/service/config.hpp"
#include "services/launcher/process/executable.hpp"

namespace rtd::launcher {
namespace fs = std::filesystem;
namespace {

constexpr char kPublicUrl[] = "https://cvg.cit.tum.de/rgbd/dataset";

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

fs::path cache_folder() {
  const std::string cache = environment("XDG_CACHE_HOME"), home = environment("HOME");
  if (!cache.empty()) return fs::path(cache) / "rtd-slam" / "datasets";
  if (!home.empty()) return fs::path(home) / ".cache" / "rtd-slam" / "datasets";
  throw std::runtime_error("no folder for the data set: set HOME or XDG_CACHE_HOME");
}

void run_tool(const std::string& tool, const std::vector<std::string>& arguments, const std::string& failure) {
  const std::string executable = find_executable(tool);
  if (executable.empty()) throw std::runtime_error(tool + " is not installed: apt-get install " + tool);
  if (run_in_foreground(executable, arguments) != 0) throw std::runtime_error(failure);
}

void unpack(const fs::path& archive, const fs::path& folder, const std::string& name) {
  const fs::path unpacking = folder / ".unpacking";
  fs::remove_all(unpacking);
  fs::create_directories(unpacking);
  run_tool("tar", {"-xzf", archive.string(), "-C", unpacking.string()},
           archive.string() + " is not a complete archive: try again");
  if (!fs::is_directory(unpacking / name)) {
    throw std::runtime_error(archive.string() + " has no folder " + name + ": is RTD_TUM_URL right?");
  }
  fs::rename(unpacking / name, folder / name);
  fs::remove_all(unpacking);
  fs::remove(archive);
}

}  // namespace

TumDataset tum_dataset(const std::string& name, const std::string& base_url) {
  static const std::regex kName("(?:rgbd_dataset_)?fr(?:eiburg)?([123])_([a-z0-9_]+)");
  std::smatch parts;
  if (!std::regex_match(name, parts, kName)) {
    throw service::ConfigError("--dataset " + name + ": not a TUM RGB-D sequence, use a name such as fr3_walking_xyz");
  }
  const std::string family = "freiburg" + parts[1].str();
  const std::string folder = "rgbd_dataset_" + family + "_" + parts[2].str();
  return {base_url + "/" + family + "/" + folder + ".tgz", folder};
}

std::string fetch_tum_dataset(const std::string& name) {
  const std::string mirror = environment("RTD_TUM_URL");
  const TumDataset dataset = tum_dataset(name, mirror.empty() ? kPublicUrl : mirror);
  const fs::path cache = cache_folder(), folder = cache / dataset.folder, archive = folder.string() + ".tgz.part";
  if (fs::is_directory(folder)) return folder.string();

  fs::create_directories(cache);
  std::cerr << "rtd: downloading " << dataset.url << " (several hundred MB) into " << cache.string() << '\n';
  run_tool(
      "curl", {"--fail", "--location", "--show-error", "--progress-bar", "--output", archive.string(), dataset.url},
      "cannot download " + dataset.url + ": without a network use 'rtd demo' (no download), or unpack the sequence " +
          "yourself and 'rtd run --source tum:FOLDER'; set RTD_TUM_URL to use a mirror");
  unpack(archive, cache, dataset.folder);
  return folder.string();
}

}  // namespace rtd::launcher
