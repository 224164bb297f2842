// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/io/byte_sink.hpp"
#include "common/io/byte_source.hpp"
#include "common/io/bytes.hpp"
#include "services/slam/core/map/map.hpp"
#include "services/slam/core/store/map_format.hpp"

namespace rtd::slam {

/// What a map file needs of a map, copied out of it in moments so that mapping can continue while it is written: poses,
/// links and landmarks are copies, the features of the keyframes are shared.
struct MapSnapshot {
  struct StoredKeyframe {
    FramePtr frame;
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    KeyframeId id = kNoKeyframe, parent = kNoKeyframe;
    MapId map = 0;
    double way_m = 0;
    std::optional<geometry::Matrix6d> covariance;
    std::uint16_t camera = 0;          ///< index into head.cameras
    std::size_t observations_end = 0;  ///< in `observations`; they begin where those of the keyframe before end
  };
  struct Observation {
    LandmarkId landmark = kNoLandmark;
    std::uint16_t feature = 0;
  };

  map_format::Head head;
  io::Bytes landmarks;                    ///< records of blocks LAND
  std::vector<LandmarkId> landmark_ids;   ///< of these records
  std::vector<StoredKeyframe> keyframes;  ///< by id
  std::vector<Observation> observations;
  io::Bytes removed;  ///< records of blocks REMV
  io::Bytes loops;    ///< records of blocks LOOP
};

/// Leaves out landmarks whose position is not finite and covariances that cannot be, which no reader would take.
MapSnapshot take_snapshot(const Map& map);

/// Writes a map file (docs/map_file.md) in blocks of about 1 MiB: needs no more memory than that. Throws io::IoError,
/// and std::runtime_error when the map could not be read back.
void write_map(const MapSnapshot& snapshot, io::ByteSink& sink);

/// What is kept of the features: all are read and checked.
enum class StoredFeatures { kKeep, kSkip };

struct MapReadOptions {
  /// kSkip: frames have stamp and camera only.
  StoredFeatures features = StoredFeatures::kKeep;
  std::function<void(std::uint64_t)> on_progress;  ///< called with the bytes read so far; may be empty
};

/// Reads a map file (docs/map_file.md). What it returns is sound: every number is possible, every cross reference
/// holds. Throws MapFileError for everything else, whatever the bytes are; holds a bounded multiple of their size.
MapContents read_map(const io::ByteSource& source, const MapReadOptions& options = {});

}  // namespace rtd::slam
