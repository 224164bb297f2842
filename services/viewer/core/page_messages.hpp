// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/msg/atlas.hpp"
#include "common/msg/features.hpp"
#include "common/msg/movers.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"
#include "services/viewer/core/command_forms.hpp"
#include "services/viewer/core/map_mirror.hpp"
#include "services/viewer/core/outbox.hpp"

/// The messages of the page's protocol (docs/viewer_protocol.md): JSON as text, little-endian binary.
namespace rtd::viewer::page {

inline constexpr const char* kSubprotocol = "rtd.viewer.v1";

enum class Kind : std::uint8_t {
  kPoses = 1,
  kRemoved = 2,
  kPoints = 3,
  kCovisibility = 4,
  kLoopEdges = 5,
  kTrajectory = 6,
  kTruth = 7,
  kImage = 8,
  kFeatures = 9,
  kMask = 11,
  kDense = 12,
  kPeople = 13,
  kMoving = 14,
  kPlan = 15,
  kTrajectoryValues = 16,
  kDepth = 17,
};

using KeyframeRef = std::pair<std::uint32_t, const MirroredKeyframe*>;

/// Of keyframes of one map.
Bytes poses(std::uint8_t robot, std::uint32_t map_id, std::span<const KeyframeRef> keyframes);
Bytes removed(std::uint8_t robot, std::span<const std::uint32_t> ids);
/// Every `stride`-th point only.
Bytes points(std::uint8_t robot, std::uint32_t map_id, std::span<const KeyframeRef> keyframes, std::size_t stride);
Bytes covisibility(std::uint8_t robot, std::span<const KeyframeRef> keyframes);
Bytes loop_edges(std::uint8_t robot, std::span<const std::uint32_t> pairs);
Bytes trajectory(std::uint8_t robot, std::uint32_t start, std::span<const TrajectoryPoint> points);
/// `errors_m`: of the same points, NaN where unknown. `begin_ns`: from which their times are counted.
Bytes trajectory_values(std::uint8_t robot, std::uint32_t start, std::int64_t begin_ns,
                        std::span<const TrajectoryPoint> points, std::span<const float> errors_m);
Bytes truth(std::uint8_t robot, std::uint32_t start, std::span<const Eigen::Vector3f> points_m);

/// `kind`: of the camera's image, or of the picture of its depth.
Bytes image(std::uint8_t robot, const msg::CompressedImage& image, Kind kind = Kind::kImage);
Bytes features(std::uint8_t robot, const msg::FeatureFrame& frame);
/// Runs of equal values, of the filter's mask (kMask) or the detector's person masks (kPeople). Empty for an image that
/// is not mono8 of a plausible size.
Bytes runs(Kind kind, std::uint8_t robot, const msg::Image& image);
/// The floor plan: its place, and runs of equal cells. Empty for one of an implausible size.
Bytes plan(std::uint8_t robot, const msg::OccupancyGrid& plan);
/// kind: kDense or kMoving.
Bytes dense(Kind kind, std::uint8_t robot, std::uint32_t start, std::uint32_t total, const Eigen::Vector3f& origin_m,
            float scale_m, std::span<const std::byte> points);

// --- Text
/// `filter_stage_ms`: of the filter's newest frame, once there is one.
std::string tracking(std::uint8_t robot, const msg::TrackingResult& result, double finished_ms,
                     const std::optional<std::array<float, msg::kFilterStages>>& filter_stage_ms);
std::string boxes(std::uint8_t robot, const msg::Detection2DArray& detections);
/// `rest`: which of them may rest (geometry::MoverTrails).
std::string movers(std::uint8_t robot, const msg::Movers& movers, const std::vector<bool>& rest);
/// What is being replayed, s.
struct Playback {
  double position_s = 0, length_s = 0, speed = 1;
  bool paused = false, ended = false;
  double begin_s = 0, at_s = 0;  ///< Unix times: recorded one of the first message; when it was at that position
  bool replaced = false;         ///< it has ended, and a camera runs
};
std::string playback(std::uint8_t robot, const Playback& playback);
struct ServiceLine {
  msg::ServiceStatus status;
  double age_ms = 0;
};
/// "starting", "ready", ..., "failed"; "gone" for a service that fell silent without an end.
const char* state_text(const ServiceLine& line);
std::string services(std::uint8_t robot, std::span<const ServiceLine> services);
std::string commands(std::uint8_t robot, std::span<const CommandInfo> commands);
std::string truth_error(std::uint8_t robot, double ate_m, std::size_t frames);
std::string map_reset(std::uint8_t robot);
std::string robots(std::span<const std::string> names);
/// Where the robots of an atlas are in its map.
std::string atlas(const msg::AtlasState& state);
std::string answer(std::uint64_t id, const CommandResult& result);

}  // namespace rtd::viewer::page
