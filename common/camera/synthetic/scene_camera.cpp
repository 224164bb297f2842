// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/scene_camera.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/camera/synthetic/texture.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr int kBandRows = 8;
constexpr double kExposureStepS = 0.004;  ///< walkers near the camera move 2 px, the room 1 px

Rendering read_rows(Renderer& renderer, const Scene& scene, double t_s, double readout_s) {
  const int rows = renderer.height_px();
  const int band_rows = readout_s > 0 ? kBandRows : rows;
  Rendering rendering;
  for (int begin = 0; begin < rows; begin += band_rows) {
    const cv::Range band(begin, std::min(begin + band_rows, rows));
    const double middle = (band.start + band.end - 1) / 2.0 - (rows - 1) / 2.0;
    const double band_s = t_s + readout_s * middle / (rows - 1);
    rendering = renderer.render_rows(scene.geometry_at(band_s), scene.textures(), scene.T_world_camera(band_s), band);
  }
  return rendering;
}

constexpr int kSparePx = 2;  ///< beyond the outermost pixel that is looked up

/// How far the undistorted pixels of the image reach beyond it, on the wider side.
cv::Size margin_of(const cv::Mat& from_u, const cv::Mat& from_v) {
  const auto beyond = [](const cv::Mat& from, int size_px) {
    double min = 0, max = 0;
    cv::minMaxLoc(from, &min, &max);
    return std::max(0, static_cast<int>(std::ceil(std::max(-min, max - (size_px - 1))))) + kSparePx;
  };
  return {beyond(from_u, from_u.cols), beyond(from_v, from_v.rows)};
}

constexpr double kSpanS = 0.8;             ///< the light changes once in every span
constexpr std::int64_t kSpansLooked = 12;  ///< back: what came before is forgotten
constexpr double kDisplayGamma = 2.2;

/// 1 in the middle, 1 - loss in the corners.
cv::Mat make_falloff(cv::Size size_px, double loss) {
  cv::Mat falloff(size_px, CV_32FC3);
  const double cx = (size_px.width - 1) / 2.0, cy = (size_px.height - 1) / 2.0;
  for (int row = 0; row < size_px.height; ++row) {
    for (int column = 0; column < size_px.width; ++column) {
      const double share = ((column - cx) * (column - cx) + (row - cy) * (row - cy)) / (cx * cx + cy * cy);
      falloff.at<cv::Vec3f>(row, column) = cv::Vec3f::all(static_cast<float>(1 - loss * share));
    }
  }
  return falloff;
}

constexpr std::array<double, 8> kFreiburg1 = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
constexpr double kMs = 1e-3;

cv::Size size_of(const geometry::CameraModel& camera) {
  return {camera.parameters().width, camera.parameters().height};
}

}  // namespace

Rendering take_picture(Renderer& renderer, const Scene& scene, double t_s, const Shutter& shutter) {
  const int before = static_cast<int>(std::ceil(shutter.exposure_s / 2 / kExposureStepS));  // and as many after
  const int moments = 2 * before + 1;
  cv::Mat sum;
  for (int i = -before; i <= before; ++i) {
    if (i == 0) continue;  // last: the renderer keeps what it draws
    const double moment_s = t_s + shutter.exposure_s * i / moments;
    const cv::Mat color = read_rows(renderer, scene, moment_s, shutter.readout_s).color_bgr;
    if (sum.empty()) sum = cv::Mat::zeros(color.size(), CV_16UC3);
    cv::add(sum, color, sum, cv::noArray(), CV_16U);
  }
  Rendering rendering = read_rows(renderer, scene, t_s, shutter.readout_s);
  if (sum.empty()) return rendering;
  cv::add(sum, rendering.color_bgr, sum, cv::noArray(), CV_16U);
  cv::Mat mean;
  sum.convertTo(mean, CV_8U, 1.0 / moments);
  rendering.color_bgr = mean;
  return rendering;
}

Lens::Lens(const geometry::CameraModel& camera) : pinhole_(camera) {
  if (!camera.distorted()) return;
  geometry::CameraModel::Parameters parameters = camera.parameters();
  from_u_.create(parameters.height, parameters.width, CV_32FC1);
  from_v_.create(parameters.height, parameters.width, CV_32FC1);
  for (int row = 0; row < parameters.height; ++row) {
    for (int column = 0; column < parameters.width; ++column) {
      const Eigen::Vector2d pixel = camera.undistort({column, row});
      from_u_.at<float>(row, column) = static_cast<float>(pixel.x());
      from_v_.at<float>(row, column) = static_cast<float>(pixel.y());
    }
  }
  const cv::Size margin_px = margin_of(from_u_, from_v_);
  from_u_ += margin_px.width;
  from_v_ += margin_px.height;
  parameters.distortion = {};
  parameters.width += 2 * margin_px.width;
  parameters.height += 2 * margin_px.height;
  parameters.cx += margin_px.width;
  parameters.cy += margin_px.height;
  pinhole_ = geometry::CameraModel(parameters);
}

Rendering Lens::bent(const Rendering& rendering) const {
  if (from_u_.empty()) return rendering;
  const auto nearest = [this](const cv::Mat& image) {
    cv::Mat bent;
    cv::remap(image, bent, from_u_, from_v_, cv::INTER_NEAREST, cv::BORDER_REPLICATE);
    return bent;
  };
  Rendering bent;
  cv::remap(rendering.color_bgr, bent.color_bgr, from_u_, from_v_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  bent.inverse_depth = nearest(rendering.inverse_depth);
  bent.moving_mask = nearest(rendering.moving_mask);
  bent.material = nearest(rendering.material);
  bent.object = nearest(rendering.object);
  return bent;
}

ColorFaults::ColorFaults(const SensorFaults& faults, cv::Size size_px, double fps, std::uint64_t seed)
    : faults_(faults), lag_s_(faults.exposure_lag_frames / fps), seed_(seed ^ 0xE4905ULL) {
  if (faults.vignetting > 0) falloff_ = make_falloff(size_px, faults.vignetting);
}

/// Brightness of the light in a span against the mean; nothing has changed at the start.
double ColorFaults::light_ev(std::int64_t span) const {
  SeededRandom random(seed_ ^ (static_cast<std::uint64_t>(span) * 0x9E3779B97F4A7C15ULL));
  return span <= 0 ? 0 : faults_.exposure_ev * static_cast<double>(random.between(-1, 1));
}

double ColorFaults::change_s(std::int64_t span) const {
  SeededRandom random(seed_ ^ 0xC4ULL ^ (static_cast<std::uint64_t>(span) * 0x9E3779B97F4A7C15ULL));
  return kSpanS * (static_cast<double>(span) + static_cast<double>(random.unit()));
}

/// Every change of the light is made up for by exp(-t / lag).
double ColorFaults::exposure_error_ev(double t_s) const {
  const auto now = static_cast<std::int64_t>(std::floor(t_s / kSpanS));
  double error_ev = 0;
  for (std::int64_t span = now - kSpansLooked; span <= now; ++span) {
    const double since_s = t_s - change_s(span);
    if (since_s < 0) continue;
    const double forgotten = lag_s_ > 0 ? std::exp(-since_s / lag_s_) : 0;
    error_ev += (light_ev(span) - light_ev(span - 1)) * forgotten;
  }
  return std::clamp(error_ev, -faults_.exposure_ev, faults_.exposure_ev);
}

void ColorFaults::expose(cv::Mat& color_bgr, double t_s) const {
  if (!falloff_.empty()) cv::multiply(color_bgr, falloff_, color_bgr, 1, CV_8U);
  if (faults_.exposure_ev <= 0) return;
  const double gain = std::pow(2.0, exposure_error_ev(t_s) / kDisplayGamma);  // on what a display shows
  color_bgr.convertTo(color_bgr, CV_8U, gain);
}

cv::Mat ColorFaults::compressed(const cv::Mat& color_bgr) const {
  const int quality = static_cast<int>(faults_.jpeg);
  if (quality == 0) return color_bgr;
  return vision::decode_image(vision::encode_jpeg(color_bgr, quality)).pixels;
}

std::array<double, 8> lens_distortion(double factor) {
  if (factor == 0) return {};  // a product would be -0, which calibration.yaml shows
  std::array<double, 8> distortion = kFreiburg1;
  for (double& coefficient : distortion) coefficient *= factor;
  return distortion;
}

geometry::CameraModel miscalibrated(const geometry::CameraModel& camera, double error, std::uint64_t seed) {
  geometry::CameraModel::Parameters parameters = camera.parameters();
  SeededRandom random(seed ^ 0xCA11BULL);
  const auto off = [&] { return random.unit() < 0.5F ? -error : error; };
  const double focal = off();  // both focal lengths: their ratio is known better
  parameters.fx *= 1 + focal;
  parameters.fy *= 1 + focal;
  parameters.cx += off() * parameters.width;
  parameters.cy += off() * parameters.height;
  return geometry::CameraModel(parameters);
}

SceneCamera::SceneCamera(const Scene& scene, const Options& options)
    : scene_(scene),
      faults_(options.faults),
      lens_(options.camera),
      renderer_(lens_.pinhole()),
      color_sensor_(options.sensor, options.seed),
      color_faults_(options.faults, size_of(options.camera), options.fps, options.seed),
      depth_faults_(options.faults, options.sensor, size_of(options.camera), options.seed) {}

Shot SceneCamera::shoot(std::uint64_t index, double t_s) {
  Rendering seen = look(t_s, {faults_.rolling_shutter_ms * kMs, faults_.blur_ms * kMs});
  cv::Mat lit_bgr = seen.color_bgr.clone();
  scene_.lighting().apply(lit_bgr, t_s);
  color_faults_.expose(lit_bgr, t_s);
  Shot shot;
  shot.color_bgr = color_faults_.compressed(color_sensor_.measure_color(lit_bgr, index));
  shot.moving_mask = seen.moving_mask.clone();  // the renderer draws the depth, and the next frame, into the same one
  shot.objects = find_objects(seen);
  if (depth_is_missing(index)) {
    shot.depth = cv::Mat::zeros(shot.color_bgr.size(), CV_16UC1);
    return shot;
  }
  if (depth_apart()) seen = look(t_s + faults_.depth_lag_ms * kMs, {faults_.depth_shutter_ms * kMs, 0});
  shot.depth = depth_faults_.measure({seen.inverse_depth, seen.material, seen.color_bgr}, index);
  return shot;
}

Rendering SceneCamera::look(double t_s, const Shutter& shutter) {
  return lens_.bent(take_picture(renderer_, scene_, t_s, shutter));
}

bool SceneCamera::depth_is_missing(std::uint64_t index) const {
  const auto every = static_cast<std::uint64_t>(faults_.depth_missing_every);
  return every > 0 && index % every == every - 1;
}

/// Whether depth is seen at other times than colour.
bool SceneCamera::depth_apart() const {
  return faults_.depth_lag_ms != 0 || faults_.depth_shutter_ms != faults_.rolling_shutter_ms;
}

}  // namespace rtd::camera::synthetic
