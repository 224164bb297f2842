// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/sample_map.hpp"

#include <algorithm>
#include <random>

#include "common/geometry/se3.hpp"

namespace rtd::test_support {
namespace {

using namespace slam;

class Maker {
 public:
  explicit Maker(const SampleMapOptions& options) : options_(options), random_(options.seed) {}

  MapContents make() {
    for (std::uint32_t id = 0; id < options_.keyframes; ++id) add_keyframe(id);
    const Eigen::Isometry3d T_old_new(Eigen::Translation3d(0.1 * options_.keyframes, 0, 0));
    contents_.loops.push_back({0, options_.keyframes - 1, T_old_new, 80});
    contents_.next_keyframe = options_.keyframes;
    contents_.next_landmark = contents_.landmarks.size();
    contents_.next_map = 1;
    return std::move(contents_);
  }

 private:
  float unit() { return static_cast<float>(random_() % 10000) / 10000; }

  msg::Feature make_feature() {
    msg::Feature feature{};
    feature.u_px = feature.u_raw_px = 639 * unit();
    feature.v_px = feature.v_raw_px = 479 * unit();
    feature.depth_m = random_() % 4 == 0 ? 0 : 0.5F + 4 * unit();
    feature.angle_rad = 6 * unit() - 3;
    feature.static_probability = unit();
    feature.octave = static_cast<std::uint8_t>(random_() % 8);
    feature.object_id = -1;
    for (std::size_t i = 0; i < feature.descriptor.size(); i += 4) {
      const auto bits = static_cast<std::uint32_t>(random_());
      for (std::size_t k = 0; k < 4; ++k) feature.descriptor[i + k] = static_cast<std::uint8_t>(bits >> (8 * k));
    }
    return feature;
  }

  FramePtr make_frame(KeyframeId id) {
    auto frame = std::make_shared<Frame>();
    frame->seq = 10 * id;
    frame->stamp_ns = 1'700'000'000'000'000'000 + std::int64_t{id} * 333'333'333;
    frame->camera = {520, 521, 319.5, 239.5, 40};
    frame->width_px = 640;
    frame->height_px = 480;
    frame->readout_s = 0.02;
    for (std::uint32_t i = 0; i < options_.features; ++i) frame->features.push_back(make_feature());
    frame->grid = vision::FeatureGrid(frame->features, 640, 480);
    return frame;
  }

  void add_keyframe(KeyframeId id) {
    Keyframe keyframe;
    keyframe.id = id;
    keyframe.frame = make_frame(id);
    geometry::Vector6d twist;
    twist << 0.1 * id, 0, 0, 0, 0.01 * unit(), 0;
    keyframe.T_world_camera = geometry::se3_exp(twist);
    keyframe.parent = id == 0 ? kNoKeyframe : id - 1;
    keyframe.way_m = 0.1 * id;
    if (id > 0) keyframe.covariance = 1e-4 * id * (geometry::Matrix6d::Identity() + 0.1 * geometry::Matrix6d::Ones());
    keyframe.landmarks.assign(options_.features, kNoLandmark);
    // Landmarks of the keyframes shortly before, each once, by ascending features; then new ones.
    const std::size_t known = contents_.landmarks.size(), recent = 4UL * options_.seen_per_keyframe;
    const std::size_t seen = std::min<std::size_t>(options_.seen_per_keyframe, known);
    const std::size_t first = known > recent ? known - recent : 0;
    const std::size_t step = std::max<std::size_t>(1, (known - first) / std::max<std::size_t>(seen, 1));
    std::uint32_t feature = 0;
    for (std::size_t i = 0; i < seen; ++i) observe(contents_.landmarks[first + i * step], keyframe, feature++);
    for (std::uint32_t i = 0; i < options_.new_per_keyframe; ++i) {
      contents_.landmarks.push_back(make_landmark(keyframe));
      observe(contents_.landmarks.back(), keyframe, feature++);
    }
    contents_.keyframes.push_back(std::move(keyframe));
  }

  Landmark make_landmark(const Keyframe& keyframe) {
    Landmark landmark;
    landmark.id = contents_.landmarks.size();
    landmark.position = keyframe.T_world_camera * Eigen::Vector3d{unit(), unit(), 1 + 3 * unit()};
    landmark.normal = Eigen::Vector3d{unit(), unit(), 1}.normalized();
    landmark.max_distance_m = 2 + unit();
    landmark.min_distance_m = 0.5;
    landmark.static_probability = unit();
    landmark.descriptor.fill(static_cast<std::uint8_t>(random_()));
    landmark.reference = landmark.first_keyframe = keyframe.id;
    landmark.visible = 7;
    landmark.found = 5;
    return landmark;
  }

  static void observe(Landmark& landmark, Keyframe& keyframe, std::uint32_t feature) {
    landmark.observations.push_back({keyframe.id, feature});
    landmark.observation_weight += keyframe.frame->features[feature].depth_m > 0 ? 2 : 1;
    keyframe.landmarks[feature] = landmark.id;
  }

  const SampleMapOptions options_;
  std::mt19937_64 random_;
  MapContents contents_;
};

}  // namespace

MapContents sample_contents(const SampleMapOptions& options) {
  return Maker(options).make();
}

Map sample_map(const SampleMapOptions& options) {
  Map map(sample_contents(options));
  for (LandmarkId id = 3; id < map.next_landmark(); id += 11) map.remove_landmark(id);
  if (options.keyframes > 4) {
    map.remove_keyframe(3);
    map.remove_keyframe(2);
  }
  const FramePtr frame = map.find_keyframe(0)->frame;
  const KeyframeId elsewhere = map.add_keyframe(frame, Eigen::Isometry3d::Identity(), kNoKeyframe);
  const auto features = static_cast<std::uint32_t>(std::min<std::size_t>(5, frame->features.size()));
  for (std::uint32_t i = 0; i < features; ++i) map.refresh_landmark(map.add_landmark({0, 0, 2}, {elsewhere, i}));
  return map;
}

}  // namespace rtd::test_support
