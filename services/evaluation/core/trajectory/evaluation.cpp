// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "services/evaluation/core/trajectory/integrity_text.hpp"

namespace rtd::eval {
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

Json alignment_json(const Alignment& alignment) {
  const Eigen::Quaterniond q(alignment.T_groundtruth_estimate.linear());
  const Eigen::Vector3d t = alignment.T_groundtruth_estimate.translation();
  return {{"translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"scale", alignment.scale},
          {"unique", alignment.unique}};
}

Json offset_json(const std::optional<BodyOffset>& offset) {
  if (!offset) return nullptr;
  const Eigen::Quaterniond q(offset->T_body_camera.linear());
  const Eigen::Vector3d t = offset->T_body_camera.translation();
  return {{"translation_m", {t.x(), t.y(), t.z()}}, {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json rpe_json(const RpeResult& rpe) {
  return {{"translation_m", to_json(rpe.translation_m)}, {"rotation_deg", to_json(rpe.rotation_rad, kRadToDeg)}};
}

Json coverage_json(const Coverage& coverage) {
  Json spans = Json::array();
  for (const LostSpan& span : coverage.lost) {
    spans.push_back({{"first_s", static_cast<double>(span.first_ns) * 1e-9},
                     {"last_s", static_cast<double>(span.last_ns) * 1e-9},
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
          {"body_offset", offset_json(e.offset)},
          {"rpe",
           {{"per_second", rpe_json(e.rpe_per_second)},
            {"per_frame", rpe_json(e.rpe_per_frame)},
            {"per_metre", rpe_json(e.rpe_per_metre)}}},
          {"drift", to_json(e.drift)},
          {"coverage", coverage_json(e.coverage)}};
}

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace rtd::eval
