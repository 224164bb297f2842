// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/integrity_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace rtd::eval {
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
