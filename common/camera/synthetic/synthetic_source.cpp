// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/synthetic_source.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>

#include "common/camera/synthetic/texture.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/msg/rgbd_frame.hpp"

namespace rtd::camera {
namespace {

constexpr std::uint64_t kBlock = 100;                      // exposures, of which FrameDrops loses a share
constexpr std::int64_t kFirstStampNs = 1'000'000'000'000;  // 1000 s: no stamp is near zero
constexpr double kFocalShare = 525.0 / 640.0;              // focal length of a Kinect over the image width
constexpr float kDepthUnitsPerM = 5000;
constexpr double kDarkness = 0.02;                       // of the light: no corner is left
constexpr double kShadowDifference = 1.0 / 2 - 1.0 / 4;  // 1/m, of SensorFaults::shadow_px

synthetic::SceneSpec find_scene(const SourceUri& uri) {
  std::string names;
  for (const synthetic::SceneSpec& scene : synthetic::scene_catalog()) {
    if (scene.name == uri.path) return scene;
    names += (names.empty() ? "" : ", ") + scene.name;
  }
  throw SourceError("source '" + io::abridged(uri.text) + "': unknown scene '" + io::abridged(uri.path) +
                    "'; known: " + names);
}

double number_in(const SourceUri& uri, const std::string& key, const std::string& text, double min, double max) {
  const std::optional<double> value = io::parse_number(text);
  if (value && *value >= min && *value <= max) return *value;
  std::ostringstream message;
  message << "source '" << io::abridged(uri.text) << "': " << key << " is '" << io::abridged(text)
          << "', allowed is a number in [" << min << ", " << max << "]";
  throw SourceError(message.str());
}

geometry::CameraModel make_camera(const SyntheticOptions& options) {
  geometry::CameraModel::Parameters parameters;
  parameters.width = options.width;
  parameters.height = options.height;
  parameters.fx = parameters.fy = kFocalShare * options.width;
  parameters.cx = (options.width - 1) / 2.0;
  parameters.cy = (options.height - 1) / 2.0;
  parameters.distortion = synthetic::lens_distortion(options.faults.distortion);
  return geometry::CameraModel(parameters);
}

/// What is known of the camera.
geometry::CameraModel make_calibration(const SyntheticOptions& options) {
  geometry::CameraModel::Parameters parameters = make_camera(options).parameters();
  parameters.fx *= 1 + options.scene.focal_error;
  parameters.fy *= 1 + options.scene.focal_error;
  return synthetic::miscalibrated(geometry::CameraModel(parameters), options.faults.calibration_error, options.seed);
}

synthetic::SensorModel make_sensor(const SyntheticOptions& options) {
  const synthetic::SensorFaults& faults = options.faults;
  synthetic::SensorModel model;
  model.noise = options.noise;
  model.depth_units_per_m = kDepthUnitsPerM;
  model.max_depth_m = static_cast<float>(options.scene.range_m);
  model.disparity_step_px = static_cast<float>(faults.disparity_step_px);
  model.disparity_noise_steps = static_cast<float>(faults.disparity_noise_px / faults.disparity_step_px);
  model.disparity_noise_steps *= static_cast<float>(options.scene.depth_noise);
  model.shadow_px_m = static_cast<float>(faults.shadow_px / kShadowDifference);
  model.color_noise_levels = static_cast<float>(options.scene.grain);
  model.max_relative_slope *= 640.0F / static_cast<float>(options.width);
  return model;
}

std::uint64_t arriving_frames(const SyntheticOptions& options, const FrameDrops& drops) {
  if (options.frames == 0) return 0;
  return std::max<std::uint64_t>(1, drops.arrived_before(options.frames));  // 0 would be endless
}

struct Parameter {
  std::string key;
  double min, max;
  std::function<void(double)> assign;
};

std::vector<Parameter> parameters_of(SyntheticOptions& options) {
  std::vector<Parameter> parameters = {
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
      {"imu", 0, 1, [&](double v) { options.imu = v > 0; }},
      {"wheel", 0, 1, [&](double v) { options.wheels = v > 0; }},
      {"dark_from", 0, 1e6, [&](double v) { options.dark_from_s = v; }},
      {"dark", 0, 1e6, [&](double v) { options.dark_s = v; }},
      {"fidget", 0, 0.5, [&](double v) { options.scene.fidget_rad = v; }},
      {"width", 64, 1920, [&](double v) { options.width = static_cast<int>(v); }},
      {"height", 48, 1200, [&](double v) { options.height = static_cast<int>(v); }}};
  for (const synthetic::FaultParameter& fault : synthetic::fault_parameters()) {
    parameters.push_back({fault.key, fault.min, fault.max, [&, fault](double v) { options.faults.*fault.value = v; }});
  }
  return parameters;
}

/// The parameters whose value is a word.
const std::vector<std::string>& word_keys() {
  static const std::vector<std::string> keys = {"sensor", "motion", "figures", "timing"};
  return keys;
}

template <class T>
using Choices = std::vector<std::pair<std::string, T>>;

/// Sets what the word that the URI has for `key`, if any, stands for.
template <class T>
void choose(const SourceUri& uri, const std::string& key, const Choices<T>& choices, T& chosen) {
  const auto given = uri.parameters.find(key);
  if (given == uri.parameters.end()) return;
  std::string names;
  for (const auto& [name, choice] : choices) {
    if (name == given->second) {
      chosen = choice;
      return;
    }
    names += (names.empty() ? "" : ", ") + name;
  }
  throw SourceError("source '" + io::abridged(uri.text) + "': " + key + " is '" + io::abridged(given->second) +
                    "', allowed are " + names);
}

void choose_words(const SourceUri& uri, SyntheticOptions& options) {
  using enum synthetic::CameraMotion;
  using enum synthetic::FigureLook;
  choose(uri, "sensor", synthetic::sensor_presets(), options.faults);
  choose(uri, "timing", {{"unknown", false}, {"known", true}}, options.timing_known);
  choose(uri, "motion",
         {{"handheld", kHandHeld},
          {"watching", kWatching},
          {"tour", kTour},
          {"rolling", kRolling},
          {"steady", kSteady},
          {"fixed", kFixed},
          {"driving", kDriving}},
         options.scene.motion);
  choose(uri, "figures", {{"plain", kPlain}, {"drawn", kDrawn}}, options.scene.figures);
}

[[noreturn]] void refuse_parameter(const SourceUri& uri, const std::string& key,
                                   const std::vector<Parameter>& parameters) {
  std::vector<std::string> keys = word_keys();
  for (const Parameter& parameter : parameters) keys.push_back(parameter.key);
  const std::string near = io::nearest_name(key, keys);
  std::string known;
  for (const std::string& each : keys) known += (known.empty() ? "" : ", ") + each;
  throw SourceError("source '" + io::abridged(uri.text) + "': unknown parameter '" + io::abridged(key) + "'" +
                    (near.empty() ? "" : ", did you mean '" + near + "'?") + "; known: " + known);
}

}  // namespace

FrameDrops::FrameDrops(double share, std::uint64_t seed)
    : lost_(static_cast<std::uint64_t>(std::lround(share * static_cast<double>(kBlock)))), seed_(seed ^ 0xD209ULL) {}

/// Those of a block that arrive, ascending: the first of a shuffled row.
std::vector<std::uint64_t> FrameDrops::arriving_in(std::uint64_t block) const {
  std::vector<std::uint64_t> row(kBlock);
  std::iota(row.begin(), row.end(), 0);
  synthetic::SeededRandom random(seed_ ^ (block * 0x9E3779B97F4A7C15ULL));
  for (std::uint64_t last = kBlock - 1; last > 0; --last) std::swap(row[last], row[random.next() % (last + 1)]);
  row.resize(kBlock - lost_);
  std::sort(row.begin(), row.end());
  return row;
}

std::uint64_t FrameDrops::exposure_of(std::uint64_t frame) const {
  if (lost_ == 0) return frame;
  const std::uint64_t arriving = kBlock - lost_, block = frame / arriving;
  return block * kBlock + arriving_in(block)[frame % arriving];
}

std::uint64_t FrameDrops::arrived_before(std::uint64_t exposure) const {
  if (lost_ == 0) return exposure;
  const std::uint64_t block = exposure / kBlock;
  const std::vector<std::uint64_t> arriving = arriving_in(block);
  const auto next = std::lower_bound(arriving.begin(), arriving.end(), exposure % kBlock);
  return block * (kBlock - lost_) + static_cast<std::uint64_t>(next - arriving.begin());
}

SyntheticOptions parse_synthetic_options(const SourceUri& uri) {
  SyntheticOptions options;
  options.scene = find_scene(uri);
  options.frames = options.scene.frames;
  options.fps = options.scene.fps;
  choose_words(uri, options);
  const std::vector<Parameter> parameters = parameters_of(options);
  for (const auto& [key, value] : uri.parameters) {
    if (std::ranges::find(word_keys(), key) != word_keys().end()) continue;
    const auto known =
        std::find_if(parameters.begin(), parameters.end(), [&](const Parameter& p) { return key == p.key; });
    if (known == parameters.end()) refuse_parameter(uri, key, parameters);
    known->assign(number_in(uri, key, value, known->min, known->max));
  }
  if (options.wheels && (options.scene.motion != synthetic::CameraMotion::kDriving || options.scene.corridor)) {
    throw SourceError("source '" + io::abridged(uri.text) +
                      "': wheel=1 needs a camera that drives on the floor; add motion=driving" +
                      (options.scene.corridor ? " and take a scene in the room" : ""));
  }
  return options;
}

SyntheticSource::SyntheticSource(std::string uri, const SyntheticOptions& options)
    : options_(options),
      drops_(options.faults.drops, options.seed),
      info_{std::move(uri), make_calibration(options), 1.0 / kDepthUnitsPerM, options.fps,
            arriving_frames(options, drops_)},
      scene_(options.scene, options.seed),
      camera_(scene_, {make_camera(options), make_sensor(options), options.faults, options.fps, options.seed}) {
  const synthetic::PathOfCamera path = [this](double t_s) { return scene_.T_world_camera(t_s); };
  if (options.imu) imu_.emplace(path, synthetic::SyntheticImu::Options(), options.seed);
  if (options.wheels) wheels_.emplace(path, options.seed);
  info_.has_imu = options.imu;
  info_.has_wheels = options.wheels;
  if (options.wheels) info_.T_base_camera = synthetic::T_base_level_camera(path(0).translation().z());
  if (!options.timing_known) return;
  info_.readout_s = options.faults.rolling_shutter_ms / 1000;
  info_.depth_offset_s = options.faults.depth_lag_ms / 1000;
}

std::int64_t SyntheticSource::stamp_ns(std::uint64_t exposure) const {
  return kFirstStampNs + static_cast<std::int64_t>(time_s(exposure) * 1e6) * 1000;  // whole µs, as TUM files carry
}

double SyntheticSource::time_s(std::uint64_t exposure) const {
  return static_cast<double>(exposure) / options_.fps;
}

std::optional<SourceFrame> SyntheticSource::next() {
  if (at_end()) return std::nullopt;
  const std::uint64_t seq = counters_.frames++;
  const std::uint64_t exposure = drops_.exposure_of(seq);
  const double t_s = time_s(exposure);
  synthetic::Shot shot = camera_.shoot(exposure, t_s);
  const bool dark = t_s >= options_.dark_from_s && t_s < options_.dark_from_s + options_.dark_s;
  if (dark) shot.color_bgr *= kDarkness;
  SourceFrame frame = to_frame(stamp_ns(exposure), std::move(shot.color_bgr), std::move(shot.depth), info_);
  frame.image.seq = seq;
  frame.dynamic_mask = std::move(shot.moving_mask);
  frame.T_world_camera = scene_.T_world_camera(t_s);
  add_motion(frame, t_s);
  const std::vector<std::string> classes = scene_.geometry_at(t_s).object_classes;
  for (const synthetic::ObjectView& seen : shot.objects) {
    const std::string& class_name = classes[static_cast<std::size_t>(seen.object)];
    frame.objects.push_back({seen.object, class_name, seen.bounds_px, seen.visible_px, seen.moving});
  }
  if (!frame.has_depth) ++counters_.frames_without_depth;
  return frame;
}

/// Up to the first reading that is not before the frame: what is needed at its stamp can be interpolated. After a pause
/// only what a reader may still use.
void SyntheticSource::add_motion(SourceFrame& frame, double t_s) {
  constexpr double kLongest_s = 10;
  constexpr double kRounding_s = 2e-6;  // of stamps
  if (imu_) {
    const double rate_hz = imu_->options().rate_hz;
    next_imu_ = std::max(next_imu_, static_cast<std::int64_t>((t_s - kLongest_s) * rate_hz));
    for (bool reached = false; !reached;) {
      reached = static_cast<double>(next_imu_) / rate_hz >= t_s - kRounding_s;
      frame.imu.push_back(imu_->reading(next_imu_++));
      frame.imu.back().stamp_ns += kFirstStampNs;
    }
  }
  if (wheels_) {
    for (bool reached = false; !reached;) {
      reached = wheels_->next_s() >= t_s - kRounding_s;
      frame.wheels.push_back(wheels_->next());
      frame.wheels.back().stamp_ns += kFirstStampNs;
    }
  }
}

std::uint64_t SyntheticSource::pass_over(std::int64_t stamp_ns) {
  const std::uint64_t before = counters_.frames;
  std::uint64_t exposure = drops_.exposure_of(before);
  // A stamp may be centuries ahead: go near it in one step, but stay where the next stamp fits into 64 bits.
  constexpr std::int64_t kLastNs = std::numeric_limits<std::int64_t>::max() - 3'600'000'000'000;
  stamp_ns = std::min(stamp_ns, kLastNs);
  const double near = (static_cast<double>(stamp_ns) - static_cast<double>(kFirstStampNs)) * 1e-9 * options_.fps - 2;
  if (near > static_cast<double>(exposure)) exposure = static_cast<std::uint64_t>(near);
  while (this->stamp_ns(exposure) < stamp_ns) ++exposure;
  counters_.frames = std::max(before, drops_.arrived_before(exposure));
  if (info_.frames != 0) counters_.frames = std::min(counters_.frames, std::max(before, info_.frames));
  return counters_.frames - before;
}

geometry::Trajectory SyntheticSource::groundtruth() const {
  geometry::Trajectory poses;
  const std::uint64_t frames = info_.frames != 0 ? info_.frames : counters_.frames;
  for (std::uint64_t i = 0; i < frames; ++i) {
    const std::uint64_t exposure = drops_.exposure_of(i);
    poses.push_back({stamp_ns(exposure), scene_.T_world_camera(time_s(exposure))});
  }
  return poses;
}

}  // namespace rtd::camera
