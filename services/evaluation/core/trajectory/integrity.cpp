// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/integrity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/msg/stamps.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::eval {
namespace {

constexpr double kUnknownTrace = 1e5;  ///< slam publishes 1e6 on the diagonal where it knows nothing

std::optional<geometry::Matrix6d> known_covariance(const std::array<double, 36>& values) {
  const geometry::Matrix6d covariance = Eigen::Map<const geometry::RowMajor6d>(values.data());
  const bool known = covariance.allFinite() && covariance.trace() > 0 && covariance.trace() < kUnknownTrace;
  return known ? std::optional(covariance) : std::nullopt;
}

using Published = std::vector<PublishedPose>;
using Errors = std::vector<std::optional<SpanError>>;

constexpr std::int64_t kStampTolerance_ns = 1'000'000;

bool is_ok(const PublishedPose& pose) {
  return pose.state == msg::TrackingState::kOk;
}

/// The true pose of each frame that has a pose; null where either is missing.
std::vector<const Eigen::Isometry3d*> true_poses(const Published& published, const GroundtruthLookup& lookup) {
  std::vector<const Eigen::Isometry3d*> poses;
  for (const PublishedPose& pose : published)
    poses.push_back(msg::has_pose(pose.state) ? lookup.find(pose.stamp_ns) : nullptr);
  return poses;
}

bool exceeds(const std::optional<SpanError>& error, const IntegrityLimits& limits) {
  return error && (error->translation_m > limits.max_error_m || error->rotation_rad > limits.max_error_rad);
}

void count_frames(const Published& published, const Errors& errors, const IntegrityLimits& limits,
                  Integrity& integrity) {
  integrity.frames = published.size();
  bool started = false;
  for (std::size_t i = 0; i < published.size(); ++i) {
    started = started || is_ok(published[i]);
    ++integrity.in_state[static_cast<std::size_t>(published[i].state)];
    if (!errors[i]) continue;
    ++integrity.judged;
    if (is_ok(published[i]) && exceeds(errors[i], limits)) {
      ++integrity.dangerous;
      if (!is_ok(published[errors[i]->since])) ++integrity.returning;
    }
    if (started && errors[i]->translation_m < limits.good_error_m) {
      ++integrity.good;
      if (published[i].state == msg::TrackingState::kDoubtful) ++integrity.needless;
    }
  }
}

/// The first frame from `first` on whose error is within the limits or unknown; the last frame if there is none.
std::size_t end_of_episode(const Errors& errors, std::size_t first, const IntegrityLimits& limits) {
  std::size_t end = first;
  while (end + 1 < errors.size() && exceeds(errors[end], limits)) ++end;
  return end;
}

void measure_delays(const Published& published, const Errors& errors, const IntegrityLimits& limits,
                    Integrity& integrity) {
  std::vector<double> delays_s;
  for (std::size_t i = 0; i < published.size(); ++i) {
    if (!exceeds(errors[i], limits) || (i > 0 && exceeds(errors[i - 1], limits))) continue;
    const std::size_t end = end_of_episode(errors, i, limits);
    std::size_t noticed = i;
    while (noticed < end && is_ok(published[noticed])) ++noticed;
    if (is_ok(published[noticed])) ++integrity.unnoticed;
    delays_s.push_back(msg::minus_s(published[noticed].stamp_ns, published[i].stamp_ns));
  }
  integrity.episodes = delays_s.size();
  integrity.delay_s_max = percentile(delays_s, 1);
  integrity.delay_s_median = percentile(delays_s, 0.5);
}

/// Of the poses in the first map, whose frame is that of its first pose.
void measure_nees(const Published& published, const GroundtruthLookup& lookup, Integrity& integrity) {
  constexpr std::size_t kFirst = 5;  // the first covariances are those of a map that has just begun
  std::optional<Eigen::Isometry3d> T_truth_world;
  std::uint32_t map_id = 0;
  std::size_t poses = 0;
  std::vector<double> values;
  for (const PublishedPose& pose : published) {
    const Eigen::Isometry3d* truth = msg::has_pose(pose.state) ? lookup.find(pose.stamp_ns) : nullptr;
    if (truth == nullptr) continue;
    if (!T_truth_world) {
      T_truth_world = *truth * pose.T_world_camera.inverse();
      map_id = pose.map_id;
    }
    if (poses++ < kFirst || pose.map_id != map_id || !is_ok(pose) || !pose.covariance) continue;
    values.push_back(nees(pose.T_world_camera, *pose.covariance, T_truth_world->inverse() * *truth));
  }
  integrity.nees_frames = values.size();
  integrity.nees_ok = summarize(values).mean;
  integrity.nees_ok_median = percentile(values, 0.5);
}

double mean_trace(const Published& published, std::size_t first, std::size_t end) {
  double sum = 0;
  for (std::size_t i = first; i < end; ++i) sum += published[i].covariance->trace();
  return sum / static_cast<double>(end - first);
}

CovarianceGrowth covariance_growth(const Published& published, msg::TrackingState state) {
  CovarianceGrowth growth;
  std::vector<double> ratios;
  std::optional<double> before;  // trace of the last frame in state ok
  const auto counts = [&](const PublishedPose& pose) { return pose.state == state && pose.covariance; };
  for (std::size_t i = 0; i < published.size(); ++i) {
    if (is_ok(published[i]) && published[i].covariance) before = published[i].covariance->trace();
    if (!counts(published[i])) continue;
    std::size_t end = i;
    while (end < published.size() && counts(published[end])) ++end;
    if (before && *before > 0) ratios.push_back(mean_trace(published, i, end) / *before);
    i = end - 1;
  }
  growth.spans = ratios.size();
  growth.grown = static_cast<std::size_t>(std::ranges::count_if(ratios, [](double ratio) { return ratio > 1; }));
  growth.median_ratio = percentile(ratios, 0.5);
  return growth;
}

double share(std::size_t part, std::size_t all) {
  return all == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

bool Drift::nearly_constant() const {
  constexpr std::size_t kFewest = 8;
  constexpr double kSpread = 0.15;
  return windows >= kFewest && lower_quartile_m_per_rad >= (1 - kSpread) * quotient_m_per_rad &&
         upper_quartile_m_per_rad <= (1 + kSpread) * quotient_m_per_rad;
}

Drift measure_drift(const Trajectory& estimate, const Trajectory& groundtruth, const DriftOptions& options) {
  constexpr double kLeast_rad = 1e-6;  // of a drift without a turn
  std::vector<double> translations_m, rotations_rad, quotients;
  const RpeOptions steps{options.window_s, RpeUnit::kSeconds, options.offset_s, options.scale};
  for (const auto& [translation_m, rotation_rad] : relative_errors(estimate, groundtruth, steps)) {
    if (!(translation_m > options.least_m)) continue;
    translations_m.push_back(translation_m);
    rotations_rad.push_back(rotation_rad);
    quotients.push_back(translation_m / std::max(rotation_rad, kLeast_rad));
  }
  return {quotients.size(),           percentile(translations_m, 0.5), percentile(rotations_rad, 0.5),
          percentile(quotients, 0.5), percentile(quotients, 0.25),     percentile(quotients, 0.75)};
}

std::string explain(const Drift& drift, const std::optional<double>& scene_depth_m) {
  constexpr double kNear = 0.25;  // of the scene's depth
  if (!drift.nearly_constant()) return {};
  std::string text = fmt::format(
      "{:.2f} m and {:.1f} deg in a third of a second: the pose trades a sideways movement against a turn that keeps "
      "what is {:.1f} m away in place; it follows something nearer than that",
      drift.median_m, drift.median_rad * kRadToDeg, drift.quotient_m_per_rad);
  if (!scene_depth_m) return text;
  const bool near = std::abs(drift.quotient_m_per_rad - *scene_depth_m) <= kNear * *scene_depth_m;
  return text +
         fmt::format("; the scene's depth is {:.1f} m, {}", *scene_depth_m, near ? "near that" : "not near that");
}

PublishedPose published_pose(const msg::TrackingResult& result) {
  PublishedPose pose;
  pose.stamp_ns = result.stamp_ns;
  pose.state = result.state;
  pose.map_id = result.map_id;
  if (result.state > msg::last_value(msg::TypeOf<msg::TrackingState>{})) pose.state = msg::TrackingState::kLost;
  if (!msg::has_pose(pose.state)) return pose;
  pose.T_world_camera = msg::to_isometry(result.T_world_camera);
  pose.covariance = known_covariance(result.covariance);
  if (!msg::is_rotation(result.T_world_camera.rotation_xyzw) || !pose.T_world_camera.matrix().allFinite())
    pose.state = msg::TrackingState::kLost;
  return pose;
}

geometry::Trajectory measured_poses(const std::vector<PublishedPose>& published) {
  geometry::Trajectory poses;
  for (const PublishedPose& pose : published) {
    const bool later = poses.empty() || pose.stamp_ns > poses.back().stamp_ns;
    if (later && msg::is_measured(pose.state) && pose.map_id == 0)
      poses.push_back({pose.stamp_ns, pose.T_world_camera});
  }
  return poses;
}

double Integrity::dangerous_share() const {
  return share(dangerous, frames);
}

double Integrity::needless_doubt_share() const {
  return share(needless, good);
}

std::vector<std::optional<SpanError>> errors_over_span(const std::vector<PublishedPose>& published,
                                                       const Trajectory& groundtruth, double span_s) {
  Errors errors(published.size());
  if (groundtruth.empty()) return errors;
  const auto truth = true_poses(published, GroundtruthLookup(groundtruth, 0));
  const std::int64_t span_ns = std::llround(span_s * 1e9) - kStampTolerance_ns;
  for (std::size_t i = 0; i < published.size(); ++i) {
    if (truth[i] == nullptr) continue;
    std::size_t since = i;
    for (std::size_t k = i; k-- > 0 && published[i].stamp_ns - published[since].stamp_ns < span_ns;)
      if (truth[k] != nullptr && published[k].map_id == published[i].map_id) since = k;
    if (since == i) continue;
    errors[i] = {step_error({published[since].T_world_camera, published[i].T_world_camera}, {*truth[since], *truth[i]}),
                 since};
  }
  return errors;
}

Integrity judge_integrity(const std::vector<PublishedPose>& published, const Trajectory& groundtruth,
                          const IntegrityLimits& limits) {
  Integrity integrity;
  const Errors errors = errors_over_span(published, groundtruth, limits.span_s);
  count_frames(published, errors, limits, integrity);
  measure_delays(published, errors, limits, integrity);
  if (!groundtruth.empty()) measure_nees(published, GroundtruthLookup(groundtruth, 0), integrity);
  integrity.doubtful = covariance_growth(published, msg::TrackingState::kDoubtful);
  integrity.predicted = covariance_growth(published, msg::TrackingState::kPredicted);
  return integrity;
}

namespace {

using Json = nlohmann::ordered_json;

Json growth_json(const CovarianceGrowth& growth) {
  return {{"spans", growth.spans}, {"grown", growth.grown}, {"median_ratio", growth.median_ratio}};
}

Json states_json(const Integrity& integrity) {
  Json states = Json::object();
  for (std::size_t i = 0; i < kTrackingStates; ++i)
    states[msg::to_string(static_cast<msg::TrackingState>(i))] = integrity.in_state[i];
  return states;
}

std::string states_text(const Integrity& integrity) {
  std::string text;
  for (std::size_t i = 0; i < kTrackingStates; ++i) {
    if (integrity.in_state[i] == 0) continue;
    text += fmt::format("{}{} {:.1f} %", text.empty() ? "" : ", ", msg::to_string(static_cast<msg::TrackingState>(i)),
                        100.0 * static_cast<double>(integrity.in_state[i]) / static_cast<double>(integrity.frames));
  }
  return text;
}

std::string delay_text(const Integrity& integrity) {
  if (integrity.episodes == 0) return "no error exceeded a limit";
  return fmt::format("at most {:.2f} s, median {:.2f} s, over {} errors, {} of them never doubted",
                     integrity.delay_s_max, integrity.delay_s_median, integrity.episodes, integrity.unnoticed);
}

std::string growth_text(const CovarianceGrowth& growth) {
  return fmt::format("grows in {} of {} times, {:.1f}-fold", growth.grown, growth.spans, growth.median_ratio);
}

}  // namespace

Json to_json(const Drift& drift) {
  return {{"windows", drift.windows},
          {"median_m", drift.median_m},
          {"median_deg", drift.median_rad * kRadToDeg},
          {"quotient_m_per_rad", drift.quotient_m_per_rad},
          {"quartiles_m_per_rad", {drift.lower_quartile_m_per_rad, drift.upper_quartile_m_per_rad}},
          {"nearly_constant", drift.nearly_constant()}};
}

Json to_json(const Integrity& integrity) {
  return {{"frames", integrity.frames},
          {"judged", integrity.judged},
          {"states", states_json(integrity)},
          {"dangerous", integrity.dangerous},
          {"dangerous_share", integrity.dangerous_share()},
          {"returning", integrity.returning},
          {"good", integrity.good},
          {"needless_doubt", integrity.needless},
          {"needless_doubt_share", integrity.needless_doubt_share()},
          {"episodes", integrity.episodes},
          {"unnoticed", integrity.unnoticed},
          {"delay_s_max", integrity.delay_s_max},
          {"delay_s_median", integrity.delay_s_median},
          {"nees_ok", integrity.nees_ok},
          {"nees_ok_median", integrity.nees_ok_median},
          {"nees_frames", integrity.nees_frames},
          {"covariance_doubtful", growth_json(integrity.doubtful)},
          {"covariance_predicted", growth_json(integrity.predicted)}};
}

std::vector<NamedFigure> drift_figures(const Drift& drift, const std::optional<double>& scene_depth_m) {
  if (drift.windows == 0) return {{"drift", "at most 3 cm in every third of a second"}};
  std::vector<NamedFigure> figures{
      {"drift", fmt::format("{:.3f} m, {:.2f} deg in a third of a second (median of the {} windows beyond 3 cm)",
                            drift.median_m, drift.median_rad * kRadToDeg, drift.windows)},
      {"drift quotient", fmt::format("{:.2f} m/rad (quartiles {:.2f} and {:.2f})", drift.quotient_m_per_rad,
                                     drift.lower_quartile_m_per_rad, drift.upper_quartile_m_per_rad)}};
  if (const std::string meaning = explain(drift, scene_depth_m); !meaning.empty()) figures.push_back({"", meaning});
  return figures;
}

std::vector<NamedFigure> integrity_figures(const Integrity& integrity) {
  std::vector<NamedFigure> figures{
      {"states", states_text(integrity)},
      {"ok, but wrong", fmt::format("{} of {} frames beyond 5 cm or 3 deg within a second ({:.2f} of 1000)",
                                    integrity.dangerous, integrity.frames, 1000 * integrity.dangerous_share())},
      {"needless doubt", integrity.good == 0 ? std::string("no frame is within 1 cm")
                                             : fmt::format("{} of {} frames within 1 cm ({:.2f} %)", integrity.needless,
                                                           integrity.good, 100 * integrity.needless_doubt_share())},
      {"doubt after", delay_text(integrity)}};
  if (integrity.nees_frames > 0) {
    figures.push_back({"NEES of ok", fmt::format("{:.1f}, median {:.1f} (6 where the covariance is right)",
                                                 integrity.nees_ok, integrity.nees_ok_median)});
  }
  if (integrity.doubtful.spans > 0) figures.push_back({"doubtful covariance", growth_text(integrity.doubtful)});
  if (integrity.predicted.spans > 0) figures.push_back({"predicted covariance", growth_text(integrity.predicted)});
  return figures;
}

}  // namespace rtd::eval
