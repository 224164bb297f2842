// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/config.hpp"

#include <fstream>
#include <memory>

#include "common/service/config.hpp"
#include "services/slam/core/place/vocabulary.hpp"
#include "services/slam/robot_base.hpp"

namespace rtd::slam {
namespace {

/// At most one byte more than a vocabulary may have: a video named by mistake is not read to its end.
std::vector<std::byte> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw service::ConfigError("slam.place.vocabulary: cannot read '" + path +
                               "'; leave it empty for the built-in one");
  std::vector<std::byte> bytes(Vocabulary::kMaxBytes + 1);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

}  // namespace

SlamConfig core_config(const ServiceConfig& config) {
  SlamConfig core = config.core;
  if (config.base.gravity != "told") core.first_pose = level_camera();
  if (config.base.given()) core.first_pose = parse_mount(config.base.camera);
  if (config.base.gravity == "floor") core.gravity = Gravity::kFloor;
  if (config.base.gravity == "imu") core.gravity = Gravity::kGiven;
  core.gravity_wait_frames = config.base.gravity_wait_frames;
  if (config.vocabulary_file.empty()) return core;
  try {
    core.place.vocabulary = std::make_shared<const Vocabulary>(Vocabulary::parse(read_file(config.vocabulary_file)));
  } catch (const VocabularyError& error) {
    throw service::ConfigError("slam.place.vocabulary: '" + config.vocabulary_file + "': " + error.what());
  }
  return core;
}

void ServiceConfig::validate() const {
  if (base.given() && !base.from_tf()) parse_mount(base.camera);
  if (base.gravity == "imu")
    throw service::ConfigError(
        "slam.base.gravity=imu needs the topic of an IMU: --imu TOPIC; without one use floor or told");
  if (!core.localize_only) return;
  if (map.load.empty())
    throw service::ConfigError("slam.map.localize_only needs a map: name its file with --map (slam.map.load)");
  if (!map.save.empty())
    throw service::ConfigError("slam.map.save=" + map.save +
                               ": with slam.map.localize_only the map does not change; leave out one of the two");
}

}  // namespace rtd::slam
