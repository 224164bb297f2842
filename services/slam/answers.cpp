// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/answers.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "common/geometry/se3.hpp"
#include "common/service/json_text.hpp"

namespace rtd::slam {
namespace {

using nlohmann::json;

constexpr std::size_t kMostLandmarks = 400, kMostStamps = 200;

json rounded(double value, double per_unit) {
  return std::isfinite(value) ? json(std::round(value * per_unit) / per_unit) : json(nullptr);
}

json place(const Eigen::Vector3d& point_m) {
  return {rounded(point_m.x(), 1e3), rounded(point_m.y(), 1e3), rounded(point_m.z(), 1e3)};
}

json seconds(std::int64_t stamp_ns) {
  return 1e-9 * static_cast<double>(stamp_ns);
}

/// What a viewer needs to draw a point of the world into an image of this camera.
json camera_of(const Frame& frame) {
  const vision::RgbdProjection& camera = frame.camera;
  return {{"fx", camera.fx / frame.width_px},
          {"fy", camera.fy / frame.height_px},
          {"cx", (camera.cx + 0.5) / frame.width_px},
          {"cy", (camera.cy + 0.5) / frame.height_px}};
}

}  // namespace

std::optional<Question> parse_question(const std::string& text) {
  std::istringstream words(text);
  std::string about, rest;
  Question question;
  words >> about;
  if (about == "keyframe" || about == "landmark") words >> question.keyframe;
  Eigen::Vector3d& p = question.p_camera;
  if (about == "landmark") words >> p.x() >> p.y() >> p.z();
  const bool known = about == "doubt" || about == "keyframe" || about == "landmark";
  if (!known || words.fail() || words >> rest) return std::nullopt;
  question.about = about == "doubt"      ? Question::About::kDoubt
                   : about == "keyframe" ? Question::About::kKeyframe
                                         : Question::About::kLandmark;
  return question;
}

std::string answer_doubt(const PoseEvidence& evidence) {
  const Disagreement found = explain(evidence);
  json motions = json::array(), landmarks = json::array();
  for (const CommonMotion& motion : found.motions)
    motions.push_back(
        {{"landmarks", motion.landmarks}, {"center_m", place(motion.center_m)}, {"moved_m", place(motion.moved_m)}});
  for (const Disagreeing& one : found.landmarks) {
    if (landmarks.size() == kMostLandmarks) break;
    landmarks.push_back({rounded(one.seen_px.x(), 10), rounded(one.seen_px.y(), 10), rounded(one.expected_px.x(), 10),
                         rounded(one.expected_px.y(), 10), one.motion});
  }
  return service::json_line({{"stamp_s", seconds(evidence.frame->stamp_ns)},
                             {"agree", evidence.agreeing},
                             {"disagree", found.landmarks.size()},
                             {"motions", std::move(motions)},
                             {"landmarks", std::move(landmarks)}});
}

std::string answer_landmark(const Map& map, const Question& question) {
  const std::optional<LandmarkFacts> facts = facts_of_landmark(map, question.keyframe, question.p_camera);
  if (!facts) return {};
  json seen = json::array();
  const std::size_t step = facts->seen_ns.size() / kMostStamps + 1;
  for (std::size_t i = 0; i < facts->seen_ns.size(); i += step) seen.push_back(seconds(facts->seen_ns[i]));
  json answer = {{"id", facts->id},
                 {"position_m", place(facts->p_world)},
                 {"observations", facts->seen_ns.size()},
                 {"found", facts->found},
                 {"visible", facts->visible},
                 {"static_probability", rounded(facts->static_probability, 1e3)},
                 {"seen_s", std::move(seen)},
                 {"camera", camera_of(*map.find_keyframe(question.keyframe)->frame)}};
  if (facts->covariance) answer["sigma_m"] = rounded(geometry::largest_sigma(*facts->covariance), 1e5);
  return service::json_line(answer);
}

std::string answer_keyframe(const Map& map, KeyframeId id) {
  constexpr double kDegPerRad = 180 / std::numbers::pi;
  const Keyframe* keyframe = map.find_keyframe(id);
  if (keyframe == nullptr) return {};
  const auto landmarks = std::ranges::count_if(keyframe->landmarks, [](LandmarkId one) { return one != kNoLandmark; });
  json answer = {{"id", id},
                 {"position_m", place(keyframe->T_world_camera.translation())},
                 {"landmarks", landmarks},
                 {"features", keyframe->frame->features.size()},
                 {"connected", keyframe->covisible.size()},
                 {"seen_s", {seconds(keyframe->frame->stamp_ns)}},
                 {"camera", camera_of(*keyframe->frame)}};
  if (keyframe->covariance) {
    answer["sigma_m"] = rounded(geometry::largest_sigma(keyframe->covariance->topLeftCorner<3, 3>()), 1e5);
    answer["sigma_deg"] =
        rounded(kDegPerRad * geometry::largest_sigma(keyframe->covariance->bottomRightCorner<3, 3>()), 1e3);
  }
  return service::json_line(answer);
}

}  // namespace rtd::slam
