// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/slam_commands.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "common/geometry/se3.hpp"
#include "common/service/json_text.hpp"
#include "common/service/log.hpp"
#include "services/slam/core/map/facts.hpp"
#include "services/slam/core/store/map_format.hpp"
#include "services/slam/core/tracking/disagreement.hpp"
#include "services/slam/map_file.hpp"

namespace rtd::slam {
namespace {

/// "doubt", "landmark KEYFRAME X Y Z" or "keyframe ID".
struct Question {
  enum class About { kDoubt, kLandmark, kKeyframe };
  About about = About::kDoubt;
  KeyframeId keyframe = kNoKeyframe;
  Eigen::Vector3d p_camera = Eigen::Vector3d::Zero();  ///< of the landmark, in the frame of its keyframe's camera, m
};
/// Empty: another text.
std::optional<Question> parse_question(const std::string& text);
inline constexpr const char* kQuestions =
    "ask 'doubt', 'keyframe ID', or 'landmark KEYFRAME X Y Z' with its place in the frame of the keyframe's camera in "
    "m";

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

/// Empty text: the map has none there.
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

struct MapSize {
  std::size_t keyframes = 0, landmarks = 0;
};

MapSize size_of(const SlamSystem& slam) {
  return slam.read_map([](const Map& map) { return MapSize{map.keyframes().size(), map.landmark_count()}; });
}

std::string full_path(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

}  // namespace

SlamCommands::SlamCommands(bus::Bus& bus, const MapFileConfig& files, const std::string& maps_folder, SlamSystem& slam,
                           MapKeeper& keeper, TakeMap take_map, Forget forget)
    : files_(files),
      maps_(maps_folder, {"map", ".rtdmap", map_format::kMagic, "--maps-dir"}),
      slam_(slam),
      keeper_(keeper),
      take_map_(std::move(take_map)),
      forget_(std::move(forget)),
      server_(bus) {
  using bus::CommandKind;
  using bus::CommandRequest;
  server_.offer("slam/reset", CommandKind::kTrigger, [this](const CommandRequest&) { return reset(); });
  server_.offer_concurrent("slam/save_map", CommandKind::kText,
                           [this](const CommandRequest& asked) { return save(asked.argument); });
  server_.offer_concurrent("slam/load_map", CommandKind::kText,
                           [this](const CommandRequest& asked) { return load(asked.argument); });
  server_.offer("slam/localize_only", CommandKind::kSetBool,
                [this](const CommandRequest& asked) { return localize_only(asked.argument == "true"); });
  server_.offer_concurrent("slam/ask", CommandKind::kText,
                           [this](const CommandRequest& asked) { return ask(asked.argument); });
}

bus::CommandAnswer SlamCommands::reset() {
  const MapSize before = size_of(slam_);
  forget_();
  SPDLOG_INFO("event=reset_by_command keyframes={} landmarks={}", before.keyframes, before.landmarks);
  return {true, fmt::format("{} keyframes and {} landmarks forgotten; the next frame begins a new map",
                            before.keyframes, before.landmarks)};
}

/// The configured file, or that of a name.
bus::CommandAnswer SlamCommands::save(const std::string& name) {
  if (name.empty() && files_.save.empty()) return {false, "name a map: slam was started without --save-map"};
  const std::string file = name.empty() ? files_.save : maps_.to_write(name).string();
  const SavedMap saved = keeper_.save_to(file, name.empty() ? io::NamedBy::kOperator : io::NamedBy::kProgram);
  return {true, fmt::format("{} keyframes and {} landmarks, {:.1f} MB, saved to {}", saved.keyframes, saved.landmarks,
                            static_cast<double>(saved.bytes) * 1e-6, full_path(file))};
}

bus::CommandAnswer SlamCommands::load(const std::string& name) {
  if (name.empty() && files_.load.empty()) return {false, "name a map: slam was started without --map"};
  const std::string file = name.empty() ? files_.load : maps_.to_read(name).string();
  MapContents contents = load_map_file(file, {}, name.empty() ? io::Links::kFollow : io::Links::kRefuse);
  const std::size_t keyframes = contents.keyframes.size(), landmarks = contents.landmarks.size();
  return server_.run([&]() -> bus::CommandAnswer {
    if (std::string difference = take_map_(std::move(contents)); !difference.empty()) return {false, difference};
    SPDLOG_INFO("event=map_loaded_by_command file={} keyframes={} landmarks={}", file, keyframes, landmarks);
    return {true, fmt::format("{} keyframes and {} landmarks loaded from {}; searching the camera's place in it",
                              keyframes, landmarks, full_path(file))};
  });
}

bus::CommandAnswer SlamCommands::localize_only(bool on) {
  const MapSize size = size_of(slam_);
  if (on && size.keyframes == 0)
    return {false, "there is no map to find the camera in: map something first, or take one with /slam/load_map"};
  slam_.set_localize_only(on);
  SPDLOG_INFO("event=localize_only on={}", on);
  return {true, on ? fmt::format("only localizing: the map of {} keyframes stays as it is", size.keyframes)
                   : "mapping: the map grows again"};
}

/// Computed here, next to tracking.
bus::CommandAnswer SlamCommands::ask(const std::string& text) {
  const std::optional<Question> question = parse_question(text);
  if (!question) return {false, kQuestions};
  std::string answer;
  if (question->about == Question::About::kDoubt) {
    PoseEvidence evidence;
    server_.run([&]() -> bus::CommandAnswer {
      evidence = slam_.evidence();
      return {};
    });
    if (evidence.frame == nullptr) return {false, "the last frame has no measured pose"};
    answer = answer_doubt(evidence);
  } else {
    answer = slam_.read_map([&](const Map& map) {
      return question->about == Question::About::kLandmark ? answer_landmark(map, *question)
                                                           : answer_keyframe(map, question->keyframe);
    });
  }
  return answer.empty() ? bus::CommandAnswer{false, "the map has none there any more"}
                        : bus::CommandAnswer{true, answer};
}

}  // namespace rtd::slam
