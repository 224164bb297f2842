// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/evaluation_json.hpp"

#include <nlohmann/json.hpp>
#include <numbers>

namespace rtd::eval {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRadToDeg = 180 / std::numbers::pi;

Json alignment_json(const Alignment& alignment) {
  const Eigen::Quaterniond q(alignment.T_groundtruth_estimate.linear());
  const Eigen::Vector3d t = alignment.T_groundtruth_estimate.translation();
  return {{"translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"scale", alignment.scale},
          {"unique", alignment.unique}};
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
          {"rpe",
           {{"per_second", rpe_json(e.rpe_per_second)},
            {"per_frame", rpe_json(e.rpe_per_frame)},
            {"per_metre", rpe_json(e.rpe_per_metre)}}},
          {"coverage", coverage_json(e.coverage)}};
}

}  // namespace rtd::eval
