// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/slam_commands.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "common/service/log.hpp"
#include "services/slam/answers.hpp"
#include "services/slam/core/store/map_format.hpp"
#include "services/slam/map_file.hpp"

namespace rtd::slam {
namespace {

struct MapSize {
  std::size_t keyframes = 0, landmarks = 0;
};

MapSize size_of(const SlamSystem& slam) {
  MapSize size;
  slam.read_map([&](const Map& map) { size = {map.keyframes().size(), map.landmark_count()}; });
  return size;
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
      desk_(bus) {
  using bus::CommandKind;
  using bus::CommandRequest;
  desk_.offer("slam/reset", CommandKind::kTrigger, [this](const CommandRequest&) { return reset(); });
  desk_.offer_beside("slam/save_map", CommandKind::kText,
                     [this](const CommandRequest& asked) { return save(asked.argument); });
  desk_.offer_beside("slam/load_map", CommandKind::kText,
                     [this](const CommandRequest& asked) { return load(asked.argument); });
  desk_.offer("slam/localize_only", CommandKind::kSetBool,
              [this](const CommandRequest& asked) { return localize_only(asked.argument == "true"); });
  desk_.offer_beside("slam/ask", CommandKind::kText,
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
  return desk_.run([&]() -> bus::CommandAnswer {
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

/// Computed here, beside tracking.
bus::CommandAnswer SlamCommands::ask(const std::string& text) {
  const std::optional<Question> question = parse_question(text);
  if (!question) return {false, kQuestions};
  std::string answer;
  if (question->about == Question::About::kDoubt) {
    PoseEvidence evidence;
    desk_.run([&]() -> bus::CommandAnswer {
      evidence = slam_.evidence();
      return {};
    });
    if (evidence.frame == nullptr) return {false, "the last frame has no measured pose"};
    answer = answer_doubt(evidence);
  } else {
    slam_.read_map([&](const Map& map) {
      answer = question->about == Question::About::kLandmark ? answer_landmark(map, *question)
                                                             : answer_keyframe(map, question->keyframe);
    });
  }
  return answer.empty() ? bus::CommandAnswer{false, "the map has none there any more"}
                        : bus::CommandAnswer{true, answer};
}

}  // namespace rtd::slam
