// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "services/slam/core/map/facts.hpp"
#include "services/slam/core/tracking/disagreement.hpp"

/// The command slam/ask (docs/topics.md): what is asked, and the answers as JSON.
namespace rtd::slam {

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

std::string answer_doubt(const PoseEvidence& evidence);
/// Empty text: the map has none there.
std::string answer_landmark(const Map& map, const Question& question);
std::string answer_keyframe(const Map& map, KeyframeId id);

}  // namespace rtd::slam
