// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/store/map_store.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "services/slam/core/store/block_io.hpp"

namespace rtd::slam {
namespace {

using namespace map_format;

/// In memory a map needs a few times the bytes of its file. A file that would need more was made to harm.
constexpr std::uint64_t kMemoryPerByte = 64, kMemoryBase = 4 << 20;
constexpr std::uint64_t kCovisiblePairBytes = 128, kGridCellBytes = 4, kTablesPerIdBytes = 16, kIdsPerTableByte = 128;
constexpr std::uint64_t kGridCellPx = 20;

/// A record that cannot be part of a map; what() names it and why.
class Unsound : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void require(bool condition, const std::string& name, const char* complaint) {
  if (!condition) throw Unsound(name + " " + complaint);
}

auto find_by_id(const std::vector<Keyframe>& keyframes, KeyframeId id) {
  return std::ranges::lower_bound(keyframes, id, {}, &Keyframe::id);
}

/// Block HEAD. Throws Unsound or ros::WireError, as all that follows.
Head read_head(FieldReader fields) {
  Head head;
  std::uint16_t cameras = 0;
  fields(head.keyframes, head.landmarks, head.removed, head.loops, head.next_keyframe, head.next_landmark,
         head.next_map, head.probability_origin, cameras);
  require(head.probability_origin <= 1, "the map", "has probabilities of an unknown origin");
  require(head.keyframes > 0, "the map", "holds no keyframe");
  for (std::uint16_t i = 0; i < cameras; ++i) {
    StoredCamera camera;
    std::uint32_t width_px = 0, height_px = 0;
    vision::RgbdProjection& p = camera.projection;
    fields(p.fx, p.fy, p.cx, p.cy, p.disparity_px_m, width_px, height_px);
    camera.width_px = static_cast<int>(std::min<std::uint32_t>(width_px, kMaxImageSide_px + 1));
    camera.height_px = static_cast<int>(std::min<std::uint32_t>(height_px, kMaxImageSide_px + 1));
    require(is_sound(camera), "camera " + std::to_string(i), "has impossible intrinsics");
    head.cameras.push_back(camera);
  }
  require(fields.left() == 0, "the head", "is longer than it should be");
  return head;
}

/// Puts the contents of a map together from the records of its file and checks every value and cross reference.
class ContentsBuilder {
 public:
  /// `file_bytes` bounds the memory that the contents may need.
  ContentsBuilder(const Head& head, StoredFeatures features, std::uint64_t file_bytes);

  /// In this order: all landmarks, all keyframes, all removed keyframes, all loops.
  void add_landmark(FieldReader& fields);
  void add_keyframe(FieldReader& fields);
  void add_removed(FieldReader& fields);
  void add_loop(FieldReader& fields);
  /// The contents; the builder is empty then.
  MapContents finish();

 private:
  struct SeenLandmark {
    std::uint32_t feature, landmark;  ///< indices
  };
  std::vector<SeenLandmark> read_observations(FieldReader& fields, std::uint16_t count, Keyframe& keyframe);
  void read_features(FieldReader& fields, const Keyframe& keyframe, Frame& frame);
  void make_grid(Frame& frame);
  void check_parent(const std::string& name, const Keyframe& keyframe);
  void check_landmarks() const;
  bool is_known(KeyframeId id) const;
  void reserve_memory(std::uint64_t bytes, const char* what);

  const Head head_;
  const StoredFeatures features_;
  std::uint64_t memory_left_;
  MapContents contents_;
  std::set<MapId> origins_;  ///< maps whose first keyframe was seen
};

ContentsBuilder::ContentsBuilder(const Head& head, StoredFeatures features, std::uint64_t file_bytes)
    : head_(head), features_(features), memory_left_(kMemoryPerByte * file_bytes + kMemoryBase) {
  reserve_memory(head.next_keyframe * kTablesPerIdBytes, "keyframe ids");
  reserve_memory(head.next_landmark / kIdsPerTableByte, "landmark ids");
  contents_.next_keyframe = head.next_keyframe;
  contents_.next_landmark = head.next_landmark;
  contents_.next_map = head.next_map;
  contents_.landmarks.reserve(std::min<std::uint64_t>(head.landmarks, file_bytes / kLandmarkBytes));
  contents_.keyframes.reserve(std::min<std::uint64_t>(head.keyframes, file_bytes / kKeyframeBytes));
  contents_.removed.reserve(std::min<std::uint64_t>(head.removed, file_bytes / kRemovedBytes));
  contents_.loops.reserve(std::min<std::uint64_t>(head.loops, file_bytes / kLoopBytes));
}

void ContentsBuilder::add_landmark(FieldReader& fields) {
  Landmark l;
  double reserved = 0;
  fields(l.id, l.position, l.normal, l.min_distance_m, l.max_distance_m, l.static_probability, reserved, l.descriptor,
         l.reference, l.first_keyframe, l.visible, l.found);
  const std::string name = "landmark " + std::to_string(l.id);
  require(contents_.landmarks.empty() || contents_.landmarks.back().id < l.id, name, "comes behind a later one");
  require(l.id < head_.next_landmark, name, "has an id that is still free");
  require(is_sound(l), name, "has values that cannot be");
  require(head_.probability_origin == 1 || reserved == 0, name, "has a value where this version has none");
  require(l.first_keyframe < head_.next_keyframe, name, "was made by a keyframe that never was");
  contents_.landmarks.push_back(l);
}

void ContentsBuilder::add_keyframe(FieldReader& fields) {
  Keyframe keyframe;
  std::uint16_t camera = 0, features = 0, observations = 0;
  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0;
  double readout_s = 0;
  std::uint8_t has_covariance = 0;
  fields(keyframe.id, keyframe.parent, keyframe.map, camera, features, observations, seq, stamp_ns,
         keyframe.T_world_camera, keyframe.way_m, readout_s, has_covariance);
  if (has_covariance != 0) fields(keyframe.covariance.emplace());
  const std::string name = "keyframe " + std::to_string(keyframe.id);
  require(contents_.keyframes.empty() || contents_.keyframes.back().id < keyframe.id, name, "comes behind a later one");
  require(keyframe.id < head_.next_keyframe, name, "has an id that is still free");
  require(is_rigid(keyframe.T_world_camera), name, "has an impossible pose");
  require(std::isfinite(keyframe.way_m) && keyframe.way_m >= 0, name, "has an impossible way");
  require(std::abs(readout_s) <= kMaxReadout_s, name, "has an impossible readout time");
  require(has_covariance <= 1 && (has_covariance == 0 || is_sound(*keyframe.covariance)), name,
          "has an impossible covariance");
  require(camera < head_.cameras.size(), name, "was seen with an unknown camera");
  require(features <= msg::kMaxFeatures, name, "has too many features");
  check_parent(name, keyframe);
  const StoredCamera& stored = head_.cameras[camera];
  const auto frame = std::make_shared<Frame>();
  frame->camera = stored.projection;
  frame->width_px = stored.width_px;
  frame->height_px = stored.height_px;
  frame->seq = seq;
  frame->stamp_ns = stamp_ns;
  frame->readout_s = readout_s;
  keyframe.landmarks.assign(features, kNoLandmark);
  const std::vector<SeenLandmark> seen = read_observations(fields, observations, keyframe);
  read_features(fields, keyframe, *frame);
  for (const auto& [feature, landmark] : seen)
    contents_.landmarks[landmark].observation_weight += frame->features[feature].depth_m > 0 ? 2 : 1;
  if (features_ == StoredFeatures::kKeep) {
    make_grid(*frame);
  } else {
    frame->features = {};
  }
  keyframe.frame = frame;
  contents_.keyframes.push_back(std::move(keyframe));
}

/// Parents are older, so that links make no circles; each map has one keyframe without.
void ContentsBuilder::check_parent(const std::string& name, const Keyframe& keyframe) {
  require(keyframe.map < head_.next_map, name, "belongs to a map that never was");
  if (keyframe.is_origin()) {
    require(origins_.insert(keyframe.map).second, name, "is a second origin of its map");
    return;
  }
  const auto parent = find_by_id(contents_.keyframes, keyframe.parent);
  require(parent != contents_.keyframes.end() && parent->id == keyframe.parent, name, "has no parent");
  require(parent->map == keyframe.map, name, "has a parent in another map");
}

std::vector<ContentsBuilder::SeenLandmark> ContentsBuilder::read_observations(FieldReader& fields, std::uint16_t count,
                                                                              Keyframe& keyframe) {
  const std::string name = "keyframe " + std::to_string(keyframe.id);
  FieldReader records = fields.part(std::size_t{count} * kObservationBytes);
  std::vector<SeenLandmark> seen;
  seen.reserve(count);
  while (records.left() > 0) {
    std::uint16_t feature = 0;
    std::uint32_t index = 0;
    records(feature, index);
    require(feature < keyframe.landmarks.size() && (seen.empty() || seen.back().feature < feature), name,
            "observes with an impossible feature");
    require(index < contents_.landmarks.size(), name, "observes a landmark that is not there");
    Landmark& landmark = contents_.landmarks[index];
    require(landmark.observations.empty() || landmark.observations.back().keyframe != keyframe.id, name,
            "observes a landmark twice");
    landmark.observations.push_back({keyframe.id, feature});
    keyframe.landmarks[feature] = landmark.id;
    seen.push_back({feature, index});
  }
  return seen;
}

void ContentsBuilder::read_features(FieldReader& fields, const Keyframe& keyframe, Frame& frame) {
  const std::string name = "keyframe " + std::to_string(keyframe.id);
  FieldReader records = fields.part(keyframe.landmarks.size() * kFeatureBytes);
  frame.features.reserve(keyframe.landmarks.size());
  while (records.left() > 0) {
    msg::Feature f{};
    records(f.u_px, f.v_px, f.depth_m, f.angle_rad, f.static_probability, f.octave, f.flags, f.descriptor);
    require(usable(f), name, "has a feature with values that cannot be");
    f.u_raw_px = f.u_px;
    f.v_raw_px = f.v_px;
    f.object_id = -1;
    frame.features.push_back(f);
  }
}

void ContentsBuilder::make_grid(Frame& frame) {
  const auto cells = (static_cast<std::uint64_t>(frame.width_px) / kGridCellPx + 1) *
                     (static_cast<std::uint64_t>(frame.height_px) / kGridCellPx + 1);
  reserve_memory(cells * kGridCellBytes, "images");
  frame.grid = vision::FeatureGrid(frame.features, frame.width_px, frame.height_px);
}

void ContentsBuilder::add_removed(FieldReader& fields) {
  KeyframeId id = 0;
  RemovedKeyframe removed;
  fields(id, removed.parent, removed.T_parent_camera);
  const std::string name = "removed keyframe " + std::to_string(id);
  require(contents_.removed.empty() || contents_.removed.back().first < id, name, "comes behind a later one");
  require(id < head_.next_keyframe, name, "has an id that is still free");
  require(!is_known(id), name, "is still there");
  require(removed.parent < id && is_known(removed.parent), name, "has no parent");
  require(is_rigid(removed.T_parent_camera), name, "has an impossible pose");
  contents_.removed.emplace_back(id, removed);
}

void ContentsBuilder::add_loop(FieldReader& fields) {
  LoopEdge loop;
  fields(loop.older, loop.newer, loop.inliers, loop.T_older_newer);
  const std::string name = "loop " + std::to_string(contents_.loops.size());
  require(loop.older < loop.newer && is_known(loop.older) && is_known(loop.newer), name,
          "ends at keyframes that cannot be");
  require(is_rigid(loop.T_older_newer), name, "has an impossible pose");
  contents_.loops.push_back(loop);
}

bool ContentsBuilder::is_known(KeyframeId id) const {
  const auto keyframe = find_by_id(contents_.keyframes, id);
  if (keyframe != contents_.keyframes.end() && keyframe->id == id) return true;
  const auto removed =
      std::ranges::lower_bound(contents_.removed, id, {}, [](const auto& entry) { return entry.first; });
  return removed != contents_.removed.end() && removed->first == id;
}

void ContentsBuilder::check_landmarks() const {
  for (const Landmark& landmark : contents_.landmarks) {
    const std::string name = "landmark " + std::to_string(landmark.id);
    require(!landmark.observations.empty(), name, "is seen by no keyframe");
    require(std::ranges::count(landmark.observations, landmark.reference, &Observation::keyframe) > 0, name,
            "is not seen by its reference keyframe");
  }
}

void ContentsBuilder::reserve_memory(std::uint64_t bytes, const char* what) {
  if (bytes > memory_left_) throw Unsound(std::string("the ") + what + " would need far more memory than the file has");
  memory_left_ -= bytes;
}

MapContents ContentsBuilder::finish() {
  check_landmarks();
  std::uint64_t pairs = 0;
  for (const Landmark& landmark : contents_.landmarks)
    pairs += landmark.observations.size() * landmark.observations.size();
  const std::uint64_t all_pairs = std::uint64_t{contents_.keyframes.size()} * contents_.keyframes.size();
  reserve_memory(std::min(pairs, all_pairs) * kCovisiblePairBytes / 2, "keyframes that see each other");
  return std::move(contents_);
}

class MapReader {
 public:
  MapReader(const io::ByteSource& source, const MapReadOptions& options) : options_(options), blocks_(source) {}

  MapContents read() {
    expect(BlockTag::kHead);
    const Head head = located([&] { return read_head(FieldReader(block_.payload)); });
    ContentsBuilder builder = located([&] { return ContentsBuilder(head, options_.features, blocks_.size()); });
    read_records(BlockTag::kLandmarks, head.landmarks, [&](FieldReader& fields) { builder.add_landmark(fields); });
    read_records(BlockTag::kKeyframes, head.keyframes, [&](FieldReader& fields) { builder.add_keyframe(fields); });
    read_records(BlockTag::kRemoved, head.removed, [&](FieldReader& fields) { builder.add_removed(fields); });
    read_records(BlockTag::kLoops, head.loops, [&](FieldReader& fields) { builder.add_loop(fields); });
    block_ = blocks_.next();
    return located([&] {
      blocks_.check_end(block_);
      return builder.finish();
    });
  }

 private:
  /// `count` records in as many blocks as they take.
  template <class ReadRecord>
  void read_records(BlockTag tag, std::uint32_t count, ReadRecord read_record) {
    std::uint32_t done = 0;
    while (done < count) {
      expect(tag);
      FieldReader fields(block_.payload);
      located([&] {
        for (; done < count && fields.left() > 0; ++done) read_record(fields);
        if (fields.left() > 0) throw Unsound("more records than announced");
      });
    }
  }

  void expect(BlockTag tag) {
    block_ = blocks_.next();
    if (block_.tag != tag) fail_damaged(block_.offset, "blocks are missing or in another order");
    if (block_.payload.empty()) fail_damaged(block_.offset, "an empty block");
    if (options_.on_progress) options_.on_progress(blocks_.position());
  }

  /// What is wrong with a record, with its place.
  template <class Step>
  std::invoke_result_t<Step> located(Step step) {
    try {
      return step();
    } catch (const Unsound& error) {
      fail_damaged(block_.offset, error.what());
    } catch (const ros::WireError& error) {
      fail_damaged(block_.offset, error.what());
    }
  }

  const MapReadOptions& options_;
  BlockReader blocks_;
  Block block_;
};

}  // namespace

MapContents read_map(const io::ByteSource& source, const MapReadOptions& options) {
  return MapReader(source, options).read();
}

}  // namespace rtd::slam
