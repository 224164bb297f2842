// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// The files of the joint map: docs/atlas.md, "Files".
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/io/input_file.hpp"
#include "common/service/config.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/atlas/atlas_service.hpp"
#include "services/slam/map_file.hpp"

namespace rtd::atlas {
namespace {

/// Whose keyframes those of a map file are: a file next to it.
std::filesystem::path owners_file(const std::string& map_file) {
  return map_file + ".robots.json";
}

std::map<std::string, std::vector<KeyframeId>> read_owners(const std::string& map_file) {
  constexpr io::ReadAs kOwners{"owners of keyframes", 64 * io::kMegabyte};
  const std::filesystem::path file = owners_file(map_file);
  if (!std::filesystem::exists(file)) return {};
  std::string cause;
  try {
    return nlohmann::json::parse(io::read_file(file, kOwners)).get<std::map<std::string, std::vector<KeyframeId>>>();
  } catch (const io::IoError& error) {
    cause = error.what();
  } catch (const nlohmann::json::exception&) {
    cause = "it is not JSON as atlas writes it";
  }
  SPDLOG_WARN(
      "event=owners_unreadable file={} cause=\"{}\" effect=\"robots in this map cannot be forgotten one by one\"",
      file.string(), cause);
  return {};
}

}  // namespace

io::NamedFiles AtlasService::maps_in(const std::string& folder) {
  return {folder, {"map", ".rtdmap", slam::map_format::kMagic, "--maps-dir"}};
}

void AtlasService::load_at_start() {
  if (config_.map_file.empty() || !std::filesystem::exists(config_.map_file)) return;
  try {
    load(config_.map_file);
  } catch (const std::runtime_error& error) {  // it cannot be read, or is no map
    throw service::ConfigError(std::string("atlas.map: ") + error.what());
  }
}

void AtlasService::load(const std::string& file) {
  slam::MapContents contents = slam::load_map_file(file);
  const std::size_t keyframes = contents.keyframes.size();
  atlas_.emplace(config_.core);
  atlas_->restore(std::move(contents), read_owners(file));
  saved_ = atlas_->revision();
  shown_.reset();
  SPDLOG_INFO("event=map_loaded file={} keyframes={}", file, keyframes);
}

/// The owners are written second: those of keyframes that are not in a map are passed over.
bus::CommandAnswer AtlasService::save(const std::string& file, io::NamedBy named_by) {
  slam::MapContents contents = atlas_->contents();
  const std::size_t keyframes = contents.keyframes.size();
  if (keyframes == 0) return {false, "nothing has been mapped yet"};
  const std::uint64_t bytes = slam::save_map_file(file, slam::take_snapshot(slam::Map(std::move(contents))), named_by);
  io::write_file(owners_file(file), nlohmann::json(atlas_->owners()).dump(), {.named_by = named_by});
  return {true,
          fmt::format("{} keyframes, {:.1f} MB, saved to {}", keyframes, static_cast<double>(bytes) * 1e-6, file)};
}

bus::CommandAnswer AtlasService::save_by_command(const std::string& name) {
  if (name.empty() && config_.map_file.empty()) return {false, "name a map: atlas was started without --map"};
  return name.empty() ? save(config_.map_file, io::NamedBy::kOperator)
                      : save(maps_.to_write(name).string(), io::NamedBy::kProgram);
}

/// To new readers, robots send all that they have once more.
bus::CommandAnswer AtlasService::load_by_command(const std::string& name) {
  if (name.empty() && config_.map_file.empty()) return {false, "name a map: atlas was started without --map"};
  load(name.empty() ? config_.map_file : maps_.to_read(name).string());
  lanes_.clear();
  transforms_.clear();
  return {true, fmt::format("{} keyframes loaded", atlas_->map().keyframes().size())};
}

void AtlasService::checkpoint() {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  if (service::monotonic_ns() - checkpoint_ns_ < config_.checkpoint_s * kSecondNs) return;
  save_changes();
  checkpoint_ns_ = service::monotonic_ns();
}

void AtlasService::save_changes() {
  if (config_.map_file.empty() || saved_ == atlas_->revision()) return;
  try {
    if (atlas_->map().empty()) {
      remove_map();
    } else {
      save(config_.map_file, io::NamedBy::kOperator);
    }
    saved_ = atlas_->revision();
    trouble_.clear();
  } catch (const std::exception& error) {
    trouble_ = error.what();
    SPDLOG_ERROR("event=map_not_saved cause=\"{}\"", trouble_);
  }
}

/// The only robot was forgotten: what the file holds is true no more, and a restart begins as without one.
void AtlasService::remove_map() {
  std::filesystem::remove(config_.map_file);
  std::filesystem::remove(owners_file(config_.map_file));
  SPDLOG_INFO("event=map_removed file={} cause=\"no keyframe is left\"", config_.map_file);
}

}  // namespace rtd::atlas
