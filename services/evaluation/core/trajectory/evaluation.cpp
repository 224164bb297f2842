// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/evaluation.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/geometry/se3.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::eval {
namespace {

constexpr double kSpan_s = 1;
constexpr int kRounds = 4;           ///< the last ones without motions that fit badly: the estimate may have jumped
constexpr double kOutlier = 3;       ///< times the median
constexpr double kSecondAxis = 0.1;  ///< share of the turns about the second axis, as a standard deviation
constexpr double kLeastTurn_rad = 2 / kRadToDeg, kLeastWay_m = 0.02;
constexpr double kPlain = 0.5;  ///< the errors fall below this share

/// What body and camera did in the same time.
struct MotionPair {
  Eigen::Isometry3d T_body_from_to, T_camera_from_to;
};
using MotionPairs = std::vector<MotionPair>;

MotionPairs motion_pairs(const Trajectory& estimate, const Trajectory& groundtruth, double offset_s, double scale) {
  MotionPairs pairs;
  if (estimate.empty() || groundtruth.empty()) return pairs;
  const GroundtruthLookup lookup(groundtruth, offset_s);
  const std::vector<std::int64_t> stamps_ns = stamps_of(estimate);
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::int64_t wanted_ns = stamps_ns[i] + std::llround(kSpan_s * 1e9);
    if (wanted_ns > stamps_ns.back()) break;
    const std::size_t j = nearest_index(stamps_ns, wanted_ns);
    const Eigen::Isometry3d* T_world_from = lookup.find(stamps_ns[i]);
    const Eigen::Isometry3d* T_world_to = lookup.find(stamps_ns[j]);
    if (T_world_from == nullptr || T_world_to == nullptr) continue;
    pairs.push_back(
        {T_world_from->inverse() * *T_world_to, estimate[i].T_world_body.inverse() * estimate[j].T_world_body});
    pairs.back().T_camera_from_to.translation() *= scale;
  }
  return pairs;
}

StepError error_of(const MotionPair& pair, const Eigen::Isometry3d& T_body_camera) {
  const Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d T_true = T_body_camera.inverse() * pair.T_body_from_to * T_body_camera;
  return step_error({start, pair.T_camera_from_to}, {start, T_true});
}

/// Median over all pairs.
StepError median_error(const MotionPairs& pairs, const Eigen::Isometry3d& T_body_camera) {
  std::vector<double> ways_m, turns_rad;
  for (const MotionPair& pair : pairs) {
    const StepError error = error_of(pair, T_body_camera);
    ways_m.push_back(error.translation_m);
    turns_rad.push_back(error.rotation_rad);
  }
  return {percentile(ways_m, 0.5), percentile(turns_rad, 0.5)};
}

/// R with log A = R log B. The turns and their opposites together have mean zero, as the alignment of points wants it.
Eigen::Matrix3d fit_turn(const MotionPairs& pairs) {
  Eigen::Matrix3Xd camera(3, 2 * pairs.size()), body(3, 2 * pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(2 * i);
    camera.col(column) = geometry::so3_log(pairs[i].T_camera_from_to.linear());
    body.col(column) = geometry::so3_log(pairs[i].T_body_from_to.linear());
    camera.col(column + 1) = -camera.col(column);
    body.col(column + 1) = -body.col(column);
  }
  return align(camera, body, AlignmentKind::kRigid).T_groundtruth_estimate.linear();
}

/// t with (R_A - I) t = R t_B - t_A, by least squares.
Eigen::Vector3d fit_lever_arm(const MotionPairs& pairs, const Eigen::Matrix3d& R_body_camera) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const MotionPair& pair : pairs) {
    const Eigen::Matrix3d turn = pair.T_body_from_to.linear() - Eigen::Matrix3d::Identity();
    normal += turn.transpose() * turn;
    right +=
        turn.transpose() * (R_body_camera * pair.T_camera_from_to.translation() - pair.T_body_from_to.translation());
  }
  return normal.ldlt().solve(right);
}

/// Pairs whose error is not far above the median.
MotionPairs without_outliers(const MotionPairs& pairs, const Eigen::Isometry3d& T_body_camera) {
  const StepError median = median_error(pairs, T_body_camera);
  MotionPairs kept;
  for (const MotionPair& pair : pairs) {
    const StepError error = error_of(pair, T_body_camera);
    if (error.rotation_rad <= kOutlier * median.rotation_rad && error.translation_m <= kOutlier * median.translation_m)
      kept.push_back(pair);
  }
  return kept;
}

Eigen::Isometry3d fit(const MotionPairs& pairs, bool turned) {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  MotionPairs fitting = pairs;
  for (int round = 0; round < kRounds && !fitting.empty(); ++round) {
    if (turned) T_body_camera.linear() = fit_turn(fitting);
    T_body_camera.translation() = fit_lever_arm(fitting, T_body_camera.linear());
    fitting = without_outliers(pairs, T_body_camera);
  }
  return T_body_camera;
}

/// Turns about one axis alone leave the turn about it, and the way along it, open.
bool turns_about_two_axes(const MotionPairs& pairs) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const MotionPair& pair : pairs) {
    const Eigen::Vector3d turn = geometry::so3_log(pair.T_body_from_to.linear());
    spread += turn * turn.transpose();
  }
  const Eigen::Vector3d squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
  return squares[1] > kSecondAxis * kSecondAxis * squares[2];
}

/// T_ros T_m of the dataset's page, whose rows are 1.059 long.
bool is_bonn(const Eigen::Matrix3d& R_body_camera) {
  Eigen::Matrix3d published;
  published << -1.0157, -0.1828, 0.2389, -0.3009, 0.6147, -0.8085, 0.0009, -0.8431, -0.6413;
  const Eigen::Matrix3d R_bonn = published / std::cbrt(published.determinant());
  return Eigen::AngleAxisd(R_bonn.transpose() * R_body_camera).angle() < 5 / kRadToDeg;
}

}  // namespace

std::optional<BodyOffset> find_body_offset(const Trajectory& estimate, const Trajectory& groundtruth, double offset_s,
                                           double scale) {
  constexpr std::size_t kFewestPairs = 30;
  const MotionPairs pairs = motion_pairs(estimate, groundtruth, offset_s, scale);
  if (pairs.size() < kFewestPairs || !turns_about_two_axes(pairs)) return std::nullopt;
  const StepError before = median_error(pairs, Eigen::Isometry3d::Identity());
  const Eigen::Isometry3d turned = fit(pairs, true), shifted = fit(pairs, false);
  if (geometry::rotation_angle_rad(turned) > kLeastTurn_rad &&
      median_error(pairs, turned).rotation_rad < kPlain * before.rotation_rad) {
    return BodyOffset{turned, is_bonn(turned.linear())};
  }
  if (shifted.translation().norm() > kLeastWay_m &&
      median_error(pairs, shifted).translation_m < kPlain * before.translation_m) {
    return BodyOffset{shifted};
  }
  return std::nullopt;
}

Trajectory camera_truth(const Trajectory& groundtruth, const std::optional<BodyOffset>& offset) {
  Trajectory poses = groundtruth;
  if (!offset) return poses;
  for (StampedPose& pose : poses) pose.T_world_body = pose.T_world_body * offset->T_body_camera;
  return poses;
}

std::string explain(const BodyOffset& offset) {
  return fmt::format(
      "the ground truth is of another body{}: the camera is turned by {:.1f} degrees and {:.3f} m away from it, as the "
      "motions of both show; this is taken into account in RPE, drift and integrity, not in the ATE",
      offset.of_bonn ? " (the markers of the Bonn RGB-D Dynamic Dataset)" : "",
      geometry::rotation_angle_rad(offset.T_body_camera) * kRadToDeg, offset.T_body_camera.translation().norm());
}

namespace {

constexpr std::int64_t kSameFrameNs = 1'000'000;

Coverage measure_coverage(const Trajectory& estimate, const Trajectory& groundtruth, const EvaluationOptions& options,
                          const std::optional<std::vector<std::int64_t>>& frames_ns) {
  if (frames_ns) return coverage_of_frames(*frames_ns, stamps_of(estimate));
  if (groundtruth.empty()) return {};
  return coverage_of_span(groundtruth.front().stamp_ns, groundtruth.back().stamp_ns,
                          shifted_stamps(estimate, options.association.offset_s), options.max_gap_s);
}

using Json = nlohmann::ordered_json;

Json pose_json(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d t = pose.translation();
  return {{"translation_m", {t.x(), t.y(), t.z()}}, {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json alignment_json(const Alignment& alignment) {
  Json json = pose_json(alignment.T_groundtruth_estimate);
  json["scale"] = alignment.scale;
  json["unique"] = alignment.unique;
  return json;
}

Json rpe_json(const RpeResult& rpe) {
  return {{"translation_m", to_json(rpe.translation_m)}, {"rotation_deg", to_json(rpe.rotation_rad, kRadToDeg)}};
}

Json coverage_json(const Coverage& coverage) {
  Json spans = Json::array();
  for (const LostSpan& span : coverage.lost) {
    spans.push_back({{"first_s", seconds(span.first_ns)},
                     {"last_s", seconds(span.last_ns)},
                     {"frames", span.frames > 0 ? Json(span.frames) : Json(nullptr)}});
  }
  return {{"fraction", coverage.fraction},
          {"of", coverage.frames > 0 ? "frames" : "groundtruth_span"},
          {"frames", coverage.frames > 0 ? Json(coverage.frames) : Json(nullptr)},
          {"tracked", coverage.tracked},
          {"lost_spans", spans}};
}

}  // namespace

Coverage coverage_of_frames(const std::vector<std::int64_t>& frames_ns, const std::vector<std::int64_t>& poses_ns) {
  Coverage coverage;
  coverage.frames = frames_ns.size();
  std::vector<bool> tracked(frames_ns.size());
  for (const auto& [frame, pose] : geometry::associate(frames_ns, poses_ns, kSameFrameNs)) tracked[frame] = true;
  for (std::size_t i = 0; i < frames_ns.size(); ++i) {
    if (tracked[i]) {
      ++coverage.tracked;
    } else if (i == 0 || tracked[i - 1]) {
      coverage.lost.push_back({frames_ns[i], frames_ns[i], 1});
    } else {
      coverage.lost.back().last_ns = frames_ns[i];
      ++coverage.lost.back().frames;
    }
  }
  if (coverage.frames > 0)
    coverage.fraction = static_cast<double>(coverage.tracked) / static_cast<double>(coverage.frames);
  return coverage;
}

Coverage coverage_of_span(std::int64_t first_ns, std::int64_t last_ns, const std::vector<std::int64_t>& poses_ns,
                          double max_gap_s) {
  Coverage coverage;
  if (last_ns <= first_ns) return coverage;
  std::vector<std::int64_t> marks_ns{first_ns};
  for (const std::int64_t pose_ns : poses_ns) {
    if (pose_ns < first_ns || pose_ns > last_ns) continue;
    marks_ns.push_back(pose_ns);
    ++coverage.tracked;
  }
  marks_ns.push_back(last_ns);
  const std::int64_t max_gap_ns = std::llround(max_gap_s * 1e9);
  std::int64_t covered_ns = 0;
  for (std::size_t i = 1; i < marks_ns.size(); ++i) {
    const std::int64_t gap_ns = marks_ns[i] - marks_ns[i - 1];
    if (gap_ns > max_gap_ns || coverage.tracked == 0) {
      coverage.lost.push_back({marks_ns[i - 1], marks_ns[i], 0});
    } else {
      covered_ns += gap_ns;
    }
  }
  coverage.fraction = static_cast<double>(covered_ns) / static_cast<double>(last_ns - first_ns);
  return coverage;
}

Evaluation evaluate(const Trajectory& estimate, const Trajectory& groundtruth, const EvaluationOptions& options,
                    const std::optional<std::vector<std::int64_t>>& frames_ns) {
  Evaluation evaluation;
  evaluation.estimate_poses = estimate.size();
  evaluation.groundtruth_poses = groundtruth.size();
  evaluation.ate = ate(estimate, groundtruth, options);
  const double offset_s = options.association.offset_s, scale = evaluation.ate.alignment.scale;
  evaluation.offset = find_body_offset(estimate, groundtruth, offset_s, scale);
  const Trajectory truth = camera_truth(groundtruth, evaluation.offset);
  const auto rpe_per = [&](RpeUnit unit) { return rpe(estimate, truth, {1.0, unit, offset_s, scale}); };
  evaluation.rpe_per_second = rpe_per(RpeUnit::kSeconds);
  evaluation.rpe_per_frame = rpe_per(RpeUnit::kFrames);
  evaluation.rpe_per_metre = rpe_per(RpeUnit::kMetres);
  evaluation.drift = measure_drift(estimate, truth, {.offset_s = offset_s, .scale = scale});
  evaluation.coverage = measure_coverage(estimate, groundtruth, options, frames_ns);
  return evaluation;
}

std::optional<std::string> other_unit(const Trajectory& estimate, const Trajectory& groundtruth,
                                      const AteOptions& options) {
  constexpr double kNear = 1.15, kFits = 0.2;
  AteOptions rigid = options, similar = options;
  rigid.alignment = AlignmentKind::kRigid;
  similar.alignment = AlignmentKind::kSimilarity;
  const AteResult scaled = ate(estimate, groundtruth, similar);
  if (!(scaled.error_m.rmse < kFits * ate(estimate, groundtruth, rigid).error_m.rmse)) return std::nullopt;
  const double scale = scaled.alignment.scale;
  for (const auto& [factor, unit] : {std::pair{1000.0, "mm"}, {100.0, "cm"}}) {
    for (const double expected : {factor, 1 / factor}) {
      if (scale < expected / kNear || scale > expected * kNear) continue;
      return fmt::format("the {} seems to be in {} (scale {:.4g}): rtd eval --scale fits it, errors in m are wrong",
                         expected > 1 ? "ground truth" : "estimate", unit, scale);
    }
  }
  return std::nullopt;
}

Json to_json(const Statistics& s, double factor) {
  return {
      {"count", s.count},          {"rmse", s.rmse * factor}, {"mean", s.mean * factor}, {"median", s.median * factor},
      {"std", s.std_dev * factor}, {"min", s.min * factor},   {"max", s.max * factor}};
}

Json to_json(const Evaluation& e) {
  return {{"estimate_poses", e.estimate_poses},
          {"groundtruth_poses", e.groundtruth_poses},
          {"ate_m", to_json(e.ate.error_m)},
          {"alignment", alignment_json(e.ate.alignment)},
          {"body_offset", e.offset ? pose_json(e.offset->T_body_camera) : Json(nullptr)},
          {"rpe",
           {{"per_second", rpe_json(e.rpe_per_second)},
            {"per_frame", rpe_json(e.rpe_per_frame)},
            {"per_metre", rpe_json(e.rpe_per_metre)}}},
          {"drift", to_json(e.drift)},
          {"coverage", coverage_json(e.coverage)}};
}

}  // namespace rtd::eval
