// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/store/map_store.hpp"

#include <algorithm>
#include <stdexcept>

#include "services/slam/core/store/block_io.hpp"
#include "services/slam/core/store/map_format.hpp"

namespace rtd::slam {
namespace {

using map_format::FieldWriter;
using map_format::StoredCamera;

constexpr double kReserved = 0;  ///< a field of each landmark

/// Index of the camera of a frame, added when it is new. Nearly always all frames have one camera.
std::uint16_t find_camera(std::vector<StoredCamera>& cameras, const Frame& frame) {
  const auto found =
      std::find_if(cameras.rbegin(), cameras.rend(), [&](const StoredCamera& camera) { return camera.is_of(frame); });
  if (found != cameras.rend()) return static_cast<std::uint16_t>(cameras.rend() - found - 1);
  if (cameras.size() == map_format::kMaxCameras) throw std::length_error("map file: more than 65535 cameras");
  cameras.push_back({frame.camera, frame.width_px, frame.height_px});
  return static_cast<std::uint16_t>(cameras.size() - 1);
}

void copy_landmarks(const Map& map, MapSnapshot& snapshot) {
  snapshot.landmarks.reserve(map.landmark_count() * map_format::kLandmarkBytes);
  snapshot.landmark_ids.reserve(map.landmark_count());
  FieldWriter write(snapshot.landmarks);
  for (const LandmarkId id : map.landmark_ids()) {
    const Landmark& l = *map.find_landmark(id);
    if (!map_format::is_sound(l)) continue;
    snapshot.landmark_ids.push_back(id);
    write(l.id, l.position, l.normal, l.min_distance_m, l.max_distance_m, l.static_probability, kReserved, l.descriptor,
          l.reference, l.first_keyframe, l.visible, l.found);
  }
}

void copy_keyframes(const Map& map, MapSnapshot& snapshot) {
  snapshot.keyframes.reserve(map.keyframes().size());
  for (const auto& [id, keyframe] : map.keyframes()) {
    for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (keyframe.landmarks[i] != kNoLandmark)
        snapshot.observations.push_back({keyframe.landmarks[i], static_cast<std::uint16_t>(i)});
    }
    const bool known = keyframe.covariance && map_format::is_sound(*keyframe.covariance);
    snapshot.keyframes.push_back({keyframe.frame, keyframe.T_world_camera, id, keyframe.parent, keyframe.map,
                                  keyframe.way_m, known ? keyframe.covariance : std::nullopt,
                                  find_camera(snapshot.head.cameras, *keyframe.frame), snapshot.observations.size()});
  }
}

void copy_removed(const Map& map, MapSnapshot& snapshot) {
  snapshot.removed.reserve(map.removed_keyframes().size() * map_format::kRemovedBytes);
  FieldWriter write(snapshot.removed);
  for (const auto& [id, removed] : map.removed_keyframes()) write(id, removed.parent, removed.T_parent_camera);
}

void copy_loops(const Map& map, MapSnapshot& snapshot) {
  FieldWriter write(snapshot.loops);
  for (const LoopEdge& loop : map.loops()) write(loop.older, loop.newer, loop.inliers, loop.T_older_newer);
}

using namespace map_format;

io::Bytes encode_head(const Head& head) {
  io::Bytes bytes;
  FieldWriter write(bytes);
  write(head.keyframes, head.landmarks, head.removed, head.loops, head.next_keyframe, head.next_landmark, head.next_map,
        head.probability_origin, static_cast<std::uint16_t>(head.cameras.size()));
  for (const StoredCamera& camera : head.cameras) {
    const auto& [fx, fy, cx, cy, disparity_px_m] = camera.projection;
    write(fx, fy, cx, cy, disparity_px_m, static_cast<std::uint32_t>(camera.width_px),
          static_cast<std::uint32_t>(camera.height_px));
  }
  return bytes;
}

/// Records of one size that are encoded already.
void write_records(BlockWriter& blocks, BlockTag tag, io::ByteView records, std::size_t record_bytes) {
  const std::size_t block_bytes = kBlockBytes / record_bytes * record_bytes;
  for (; !records.empty(); records = records.subspan(std::min(block_bytes, records.size())))
    blocks.write(tag, records.first(std::min(block_bytes, records.size())));
}

class KeyframeEncoder {
 public:
  explicit KeyframeEncoder(const MapSnapshot& snapshot) : snapshot_(snapshot) {}

  void append(const MapSnapshot::StoredKeyframe& keyframe, io::Bytes& out) {
    check(keyframe);
    FieldWriter write(out);
    const auto observations = observations_of(keyframe);
    write(keyframe.id, keyframe.parent, keyframe.map, keyframe.camera,
          static_cast<std::uint16_t>(keyframe.frame->features.size()), static_cast<std::uint16_t>(observations.size()),
          keyframe.frame->seq, keyframe.frame->stamp_ns, keyframe.T_world_camera, keyframe.way_m,
          keyframe.frame->readout_s, static_cast<std::uint8_t>(keyframe.covariance ? 1 : 0));
    if (keyframe.covariance) write(*keyframe.covariance);
    for (const auto& [feature, landmark] : observations) write(feature, landmark);
    for (const msg::Feature& f : keyframe.frame->features)
      write(f.u_px, f.v_px, f.depth_m, f.angle_rad, f.static_probability, f.octave, f.flags, f.descriptor);
  }

 private:
  static void check(const MapSnapshot::StoredKeyframe& keyframe) {
    const std::string name = "map not saved: keyframe " + std::to_string(keyframe.id);
    if (!is_rigid(keyframe.T_world_camera)) throw std::runtime_error(name + " has an impossible pose");
    if (keyframe.frame->features.size() > msg::kMaxFeatures) throw std::runtime_error(name + " has too many features");
  }
  /// Feature and index of the landmark; without landmarks that were left out.
  std::vector<std::pair<std::uint16_t, std::uint32_t>> observations_of(const MapSnapshot::StoredKeyframe& keyframe) {
    std::vector<std::pair<std::uint16_t, std::uint32_t>> found;
    const std::vector<LandmarkId>& ids = snapshot_.landmark_ids;
    for (; next_observation_ < keyframe.observations_end; ++next_observation_) {
      const auto& [landmark, feature] = snapshot_.observations[next_observation_];
      const auto id = std::lower_bound(ids.begin(), ids.end(), landmark);
      if (id != ids.end() && *id == landmark) found.emplace_back(feature, static_cast<std::uint32_t>(id - ids.begin()));
    }
    return found;
  }

  const MapSnapshot& snapshot_;
  std::size_t next_observation_ = 0;
};

void write_keyframes(BlockWriter& blocks, const MapSnapshot& snapshot) {
  KeyframeEncoder encoder(snapshot);
  io::Bytes block;
  const auto flush = [&] {
    if (!block.empty()) blocks.write(BlockTag::kKeyframes, block);
    block.clear();
  };
  for (const MapSnapshot::StoredKeyframe& keyframe : snapshot.keyframes) {
    encoder.append(keyframe, block);
    if (block.size() >= kBlockBytes) flush();
  }
  flush();
}

}  // namespace

MapSnapshot take_snapshot(const Map& map) {
  MapSnapshot snapshot;
  copy_landmarks(map, snapshot);
  copy_keyframes(map, snapshot);
  copy_removed(map, snapshot);
  copy_loops(map, snapshot);
  snapshot.head.keyframes = static_cast<std::uint32_t>(snapshot.keyframes.size());
  snapshot.head.landmarks = static_cast<std::uint32_t>(snapshot.landmark_ids.size());
  snapshot.head.removed = static_cast<std::uint32_t>(map.removed_keyframes().size());
  snapshot.head.loops = static_cast<std::uint32_t>(map.loops().size());
  snapshot.head.next_keyframe = map.next_keyframe();
  snapshot.head.next_landmark = map.next_landmark();
  snapshot.head.next_map = map.next_map();
  return snapshot;
}

void write_map(const MapSnapshot& snapshot, io::ByteSink& sink) {
  BlockWriter blocks(sink);
  blocks.write(BlockTag::kHead, encode_head(snapshot.head));
  write_records(blocks, BlockTag::kLandmarks, snapshot.landmarks, kLandmarkBytes);
  write_keyframes(blocks, snapshot);
  write_records(blocks, BlockTag::kRemoved, snapshot.removed, kRemovedBytes);
  write_records(blocks, BlockTag::kLoops, snapshot.loops, kLoopBytes);
  blocks.end();
}

}  // namespace rtd::slam
