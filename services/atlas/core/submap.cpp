// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/atlas/core/submap.hpp"

#include <algorithm>

#include "common/io/byte_sink.hpp"
#include "common/msg/frame_size.hpp"
#include "common/msg/stamps.hpp"
#include "services/slam/core/store/map_store.hpp"

namespace rtd::atlas {
namespace {

using slam::Frame;
using slam::FramePtr;
using slam::Keyframe;
using slam::KeyframeId;
using slam::kNoKeyframe;
using slam::kNoLandmark;
using slam::Landmark;
using slam::LandmarkId;

/// A frame with some of the features of another.
FramePtr with_features(const Frame& whole, const std::vector<std::uint32_t>& kept) {
  auto frame = std::make_shared<Frame>();
  frame->seq = whole.seq;
  frame->stamp_ns = whole.stamp_ns;
  frame->camera = whole.camera;
  frame->width_px = whole.width_px;
  frame->height_px = whole.height_px;
  frame->readout_s = whole.readout_s;
  frame->features.reserve(kept.size());
  for (const std::uint32_t feature : kept) frame->features.push_back(whole.features[feature]);
  frame->grid = vision::FeatureGrid(frame->features, frame->width_px, frame->height_px);
  return frame;
}

}  // namespace

FramePtr to_frame(const msg::KeyframeFeatures& message, std::vector<std::uint32_t>& kept) {
  kept.clear();
  if (!msg::is_frame_size(message.width, message.height) || message.features.size() > msg::kMaxFeatures ||
      !msg::is_camera(message.intrinsics, message.width, message.height) || !msg::is_sensor_time(message.readout_s) ||
      !(message.disparity_px_m > 0))
    return nullptr;
  auto frame = std::make_shared<Frame>();
  frame->stamp_ns = message.stamp_ns;
  const auto& [fx, fy, cx, cy] = message.intrinsics;
  frame->camera = {fx, fy, cx, cy, message.disparity_px_m};
  frame->width_px = static_cast<int>(message.width);
  frame->height_px = static_cast<int>(message.height);
  frame->readout_s = message.readout_s;
  for (std::uint32_t i = 0; i < message.features.size(); ++i) {
    const msg::KeyframeFeature& from = message.features[i];
    msg::Feature feature{};
    feature.u_px = feature.u_raw_px = from.u_px;
    feature.v_px = feature.v_raw_px = from.v_px;
    feature.depth_m = from.depth_m;
    feature.angle_rad = from.angle_rad;
    feature.static_probability = from.static_probability;
    feature.octave = from.octave;
    feature.flags = from.flags;
    feature.object_id = -1;
    feature.descriptor = from.descriptor;
    if (!slam::usable(feature) || (feature.flags & msg::kFeatureRemoved) != 0) continue;
    frame->features.push_back(feature);
    kept.push_back(i);
  }
  frame->grid = vision::FeatureGrid(frame->features, frame->width_px, frame->height_px);
  return frame;
}

slam::MapContents take_part(const slam::Map& map, const std::vector<KeyframeId>& keyframes, KeptFeatures kept) {
  slam::MapContents part;
  part.next_keyframe = map.next_keyframe();
  part.next_landmark = map.next_landmark();
  part.next_map = 1;
  std::map<LandmarkId, std::vector<slam::Observation>> seen;
  for (const KeyframeId id : keyframes) {
    const Keyframe& whole = *map.find_keyframe(id);
    std::vector<std::uint32_t> features;
    for (std::uint32_t i = 0; i < whole.landmarks.size(); ++i)
      if (kept == KeptFeatures::kAll || whole.landmarks[i] != kNoLandmark) features.push_back(i);
    Keyframe& copy = part.keyframes.emplace_back();
    copy.id = id;
    copy.frame = kept == KeptFeatures::kAll ? whole.frame : with_features(*whole.frame, features);
    copy.T_world_camera = whole.T_world_camera;
    copy.parent = part.keyframes.size() == 1 ? kNoKeyframe : part.keyframes.front().id;
    copy.way_m = whole.way_m;
    for (std::uint32_t i = 0; i < features.size(); ++i) {
      copy.landmarks.push_back(whole.landmarks[features[i]]);
      if (copy.landmarks.back() != kNoLandmark) seen[copy.landmarks.back()].push_back({id, i});
    }
  }
  for (auto& [id, observations] : seen) {
    Landmark landmark = *map.find_landmark(id);
    const auto sees = [&](KeyframeId keyframe) {
      return std::ranges::count(observations, keyframe, &slam::Observation::keyframe) > 0;
    };
    if (!sees(landmark.reference)) landmark.reference = observations.front().keyframe;
    landmark.first_keyframe = landmark.reference;
    landmark.observations = std::move(observations);
    landmark.observation_weight = 2 * static_cast<int>(landmark.observations.size());
    part.landmarks.push_back(std::move(landmark));
  }
  return part;
}

io::Bytes to_map_file(slam::MapContents contents) {
  io::MemorySink sink;
  slam::write_map(slam::take_snapshot(slam::Map(std::move(contents))), sink);
  return sink.bytes();
}

}  // namespace rtd::atlas
