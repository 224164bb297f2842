// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/model_locator.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <vector>

#include "common/io/printable.hpp"
#include "common/service/config.hpp"

namespace rtd::service {

std::string known_model_names() {
  std::string text;
  for (const KnownModel& model : kKnownModels) text += (text.empty() ? "" : ", ") + std::string(model.name);
  return text;
}

const KnownModel* find_known_model(const std::string& name_or_path) {
  const std::string file = std::filesystem::path(name_or_path).filename().string();
  const auto is_meant = [&](const KnownModel& model) { return name_or_path == model.name || file == model.file; };
  if (is_meant(kMaskModel)) return &kMaskModel;
  const auto found = std::ranges::find_if(kKnownModels, is_meant);
  return found == kKnownModels.end() ? nullptr : found;
}

std::string describe_model(const std::string& path) {
  if (const KnownModel* const model = find_known_model(path)) return std::string(model->title) + ", " + model->licence;
  return std::filesystem::path(path).filename().string() + ", licence not known";
}

namespace {

/// The command that fetches what is missing.
std::string advice(const std::string& configured) {
  const KnownModel* const known = find_known_model(configured);
  const std::string option = known == nullptr || known->usual ? "" : std::string(" --model ") + known->name;
  return "run `deploy/setup.sh --models" + option + "`, or point RTD_MODEL_DIR at a folder that has them";
}

/// The file names that are looked for.
std::vector<std::string> names_of(const std::string& configured) {
  if (const KnownModel* const known = find_known_model(configured)) return {known->file};
  if (!configured.empty()) return {configured};
  std::vector<std::string> names;
  for (const KnownModel& model : kKnownModels)
    if (model.usual) names.emplace_back(model.file);
  return names;
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

std::vector<std::filesystem::path> search_folders(const EnvironmentReader& environment) {
  const auto value = [&environment](const char* name) { return environment(name).value_or(""); };
  std::vector<std::filesystem::path> folders;
  if (const std::string folder = value("RTD_MODEL_DIR"); !folder.empty()) {
    folders.emplace_back(folder);
    folders.push_back(std::filesystem::path(folder) / "permissive");
  }
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

/// `masks`: the network for these.
ModelSearch find(const std::string& configured, bool masks, const EnvironmentReader& environment) {
  const std::string missing = masks ? "no network for masks" : "no detector weights";
  if (configured.find('/') != std::string::npos) {
    if (is_file(configured)) return {configured, {}};
    return {{},
            missing + ": " + (masks ? "detector.mask_model" : "detector.model") + " is '" + io::abridged(configured) +
                "', which is no file; correct it, or " + advice(configured)};
  }
  const std::vector<std::string> names = names_of(configured);
  std::vector<std::string> looked;
  for (const std::filesystem::path& folder : search_folders(environment)) {
    for (const std::string& name : names)
      if (is_file(folder / name)) return {(folder / name).string(), {}};
    looked.push_back(folder.string());
  }
  return {
      {},
      missing + ": looked for " + joined(names, " or ") + " in " + joined(looked, ", ") + "; " + advice(configured)};
}

}  // namespace

ModelSearch find_model(const std::string& configured, const EnvironmentReader& environment) {
  return find(configured, find_known_model(configured) == &kMaskModel, environment);
}

ModelSearch find_mask_model(const std::string& use, const std::string& configured,
                            const EnvironmentReader& environment) {
  if (use == "off") return {};
  ModelSearch found = find(configured.empty() ? kMaskModel.file : configured, true, environment);
  if (!found && (use == "on" || !configured.empty()))
    throw ConfigError(found.message + "; without masks: detector.masks: off (--masks off)");
  return found;
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
