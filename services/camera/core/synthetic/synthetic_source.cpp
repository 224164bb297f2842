// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/synthetic/synthetic_source.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <sstream>

#include "common/io/text.hpp"
#include "common/msg/rgbd_frame.hpp"

namespace rtd::camera {
namespace {

constexpr std::int64_t kFirstStampNs = 1'000'000'000'000;  // 1000 s: no stamp is near zero
constexpr double kFocalShare = 525.0 / 640.0;              // focal length of a Kinect over the image width
constexpr float kDepthUnitsPerM = 5000;

synthetic::SceneSpec find_scene(const SourceUri& uri) {
  std::string names;
  for (const synthetic::SceneSpec& scene : synthetic::scene_catalog()) {
    if (scene.name == uri.path) return scene;
    names += (names.empty() ? "" : ", ") + scene.name;
  }
  throw SourceError("source '" + uri.text + "': unknown scene '" + uri.path + "'; known: " + names);
}

double number_in(const SourceUri& uri, const std::string& key, const std::string& text, double min, double max) {
  const std::optional<double> value = io::parse_number(text);
  if (value && *value >= min && *value <= max) return *value;
  std::ostringstream message;
  message << "source '" << uri.text << "': " << key << " is '" << text << "', allowed is a number in [" << min << ", "
          << max << "]";
  throw SourceError(message.str());
}

geometry::CameraModel make_camera(const SyntheticOptions& options, double focal_error) {
  geometry::CameraModel::Parameters parameters;
  parameters.width = options.width, parameters.height = options.height;
  parameters.fx = parameters.fy = kFocalShare * options.width * (1 + focal_error);
  parameters.cx = (options.width - 1) / 2.0, parameters.cy = (options.height - 1) / 2.0;
  return geometry::CameraModel(parameters);
}

synthetic::SensorModel make_sensor(const SyntheticOptions& options) {
  synthetic::SensorModel model;
  model.noise = options.noise;
  model.depth_units_per_m = kDepthUnitsPerM;
  model.max_depth_m = static_cast<float>(options.scene.range_m);
  model.disparity_noise_steps *= static_cast<float>(options.scene.depth_noise);
  model.color_noise_levels = static_cast<float>(options.scene.grain);
  model.max_relative_slope *= 640.0F / static_cast<float>(options.width);
  return model;
}

}  // namespace

SyntheticOptions parse_synthetic_options(const SourceUri& uri) {
  SyntheticOptions options;
  options.scene = find_scene(uri);
  options.frames = options.scene.frames;
  options.fps = options.scene.fps;
  struct Parameter {
    const char* key;
    double min, max;
    std::function<void(double)> assign;
  };
  const std::vector<Parameter> parameters = {
      {"seed", 0, 1e9, [&](double v) { options.seed = static_cast<std::uint64_t>(v); }},
      {"frames", 0, 1e9, [&](double v) { options.frames = static_cast<std::uint64_t>(v); }},
      {"fps", 1, 240, [&](double v) { options.fps = v; }},
      {"range", 0.5, 12, [&](double v) { options.scene.range_m = v; }},
      {"depth_noise", 0, 20, [&](double v) { options.scene.depth_noise = v; }},
      {"focal_error", -0.1, 0.1, [&](double v) { options.scene.focal_error = v; }},
      {"grain", 0, 30, [&](double v) { options.scene.grain = v; }},
      {"noise", 0, 1, [&](double v) { options.noise = v > 0; }},
      {"people", 0, 20, [&](double v) { options.scene.people = static_cast<int>(v); }},
      {"boxes", 0, 20, [&](double v) { options.scene.boxes = static_cast<int>(v); }},
      {"flicker", 0, 1, [&](double v) { options.scene.flicker = v; }},
      {"sit", 0, 1e6, [&](double v) { options.scene.sit_s = v; }},
      {"fidget", 0, 0.5, [&](double v) { options.scene.fidget_rad = v; }},
      {"width", 64, msg::kMaxFrameWidth, [&](double v) { options.width = static_cast<int>(v); }},
      {"height", 48, msg::kMaxFrameHeight, [&](double v) { options.height = static_cast<int>(v); }}};
  for (const auto& [key, value] : uri.parameters) {
    const auto known =
        std::find_if(parameters.begin(), parameters.end(), [&](const Parameter& p) { return key == p.key; });
    if (known == parameters.end()) {
      throw SourceError("source '" + uri.text + "': unknown parameter '" + key +
                        "'; known: seed, frames (0 = endless), fps, noise, people, boxes, flicker, sit, fidget, range, "
                        "depth_noise, focal_error, grain, width, height");
    }
    known->assign(number_in(uri, key, value, known->min, known->max));
  }
  return options;
}

SyntheticSource::SyntheticSource(std::string uri, const SyntheticOptions& options)
    : options_(options),
      info_{std::move(uri), make_camera(options, options.scene.focal_error), 1.0 / kDepthUnitsPerM, options.fps,
            options.frames},
      scene_(options.scene, options.seed),
      renderer_(make_camera(options, 0)),
      sensor_(make_sensor(options), options.seed) {}

std::int64_t SyntheticSource::stamp_ns(std::uint64_t frame) const {
  return kFirstStampNs + static_cast<std::int64_t>(time_s(frame) * 1e6) * 1000;  // whole µs, as TUM files carry
}

double SyntheticSource::time_s(std::uint64_t frame) const {
  return static_cast<double>(frame) / options_.fps;
}

std::optional<SourceFrame> SyntheticSource::next() {
  if (at_end()) return std::nullopt;
  const std::uint64_t index = counters_.frames++;
  const Eigen::Isometry3d T_world_camera = scene_.T_world_camera(time_s(index));
  const synthetic::Geometry geometry = scene_.geometry_at(time_s(index));
  synthetic::Rendering rendering = renderer_.render(geometry, scene_.textures(), T_world_camera);
  scene_.lighting().apply(rendering.color_bgr, time_s(index));
  SourceFrame frame;
  frame.image = {index,
                 stamp_ns(index),
                 sensor_.measure_color(rendering.color_bgr, index),
                 sensor_.measure_depth(rendering.inverse_depth, index),
                 info_.depth_scale_m,
                 info_.camera};
  frame.dynamic_mask = rendering.moving_mask.clone();
  frame.T_world_camera = T_world_camera;
  for (const synthetic::ObjectView& seen : rendering.objects) {
    const std::string& class_name = geometry.object_classes[static_cast<std::size_t>(seen.object)];
    frame.objects.push_back({seen.object, class_name, seen.bounds_px, seen.visible_px, seen.moving});
  }
  return frame;
}

std::uint64_t SyntheticSource::pass_over(std::int64_t stamp_ns) {
  const std::uint64_t before = counters_.frames;
  // A stamp may be centuries ahead: go near it in one step, but stay where the next stamp fits into 64 bits.
  constexpr std::int64_t kLastNs = std::numeric_limits<std::int64_t>::max() - 3'600'000'000'000;
  stamp_ns = std::min(stamp_ns, kLastNs);
  const double near = (static_cast<double>(stamp_ns) - static_cast<double>(kFirstStampNs)) * 1e-9 * options_.fps - 2;
  if (near > static_cast<double>(before)) counters_.frames = static_cast<std::uint64_t>(near);
  if (options_.frames != 0) counters_.frames = std::min(counters_.frames, std::max(before, options_.frames));
  while (!at_end() && this->stamp_ns(counters_.frames) < stamp_ns) ++counters_.frames;
  return counters_.frames - before;
}

geometry::Trajectory SyntheticSource::groundtruth() const {
  geometry::Trajectory poses;
  const std::uint64_t frames = options_.frames != 0 ? options_.frames : counters_.frames;
  for (std::uint64_t i = 0; i < frames; ++i) poses.push_back({stamp_ns(i), scene_.T_world_camera(time_s(i))});
  return poses;
}

}  // namespace rtd::camera
