// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/msg/stamps.hpp"
#include "common/service/json_text.hpp"
#include "services/viewer/core/page_messages.hpp"

namespace rtd::viewer::page {
namespace {

using nlohmann::json;
using service::json_line;

constexpr const char* kServiceStates[] = {"starting", "ready", "running", "degraded", "finished", "failed"};
constexpr double kGoneAfterMs = 2000;
constexpr const char* kFilterStageNames[] = {"wait_detections", "extract", "masks", "ego_motion",
                                             "depth_check",     "fuse",    "total"};
constexpr const char* kSlamStageNames[] = {"match", "local_map", "pose", "keyframe", "mapping", "total", "relocalize"};

double rounded(double value, double per_unit) {
  return std::isfinite(value) ? std::round(value * per_unit) / per_unit : 0;  // few digits as text
}

template <std::size_t kNames, std::size_t kStages>
json stages(const char* const (&names)[kNames], const std::array<float, kStages>& stage_ms) {
  json result = json::object();
  for (std::size_t place = 0; place < kNames; ++place)
    if (stage_ms[place] > 0) result[names[place]] = rounded(static_cast<double>(stage_ms[place]), 1e2);
  return result;
}

json pose(const msg::Transform& transform) {
  json values = json::array();
  for (const double value : transform.translation_m) values.push_back(rounded(value, 1e5));
  for (const double value : transform.rotation_xyzw) values.push_back(rounded(value, 1e6));
  return values;
}

json to_json(const ServiceLine& line) {
  json metrics = json::object();
  for (const msg::Metric& metric : line.status.metrics) metrics[metric.name] = rounded(metric.value, 1e3);
  return {{"name", line.status.service},       {"pid", line.status.pid},
          {"state", state_text(line)},         {"message", line.status.message},
          {"age_ms", rounded(line.age_ms, 1)}, {"metrics", std::move(metrics)}};
}

}  // namespace

const char* state_text(const ServiceLine& line) {
  const auto place = static_cast<std::size_t>(line.status.state);
  if (place >= std::size(kServiceStates)) return "unknown";
  const bool ended = line.status.state >= msg::ServiceState::kFinished;
  return line.age_ms > kGoneAfterMs && !ended ? "gone" : kServiceStates[place];
}

std::string tracking(std::uint8_t robot, const msg::TrackingResult& result, double finished_ms,
                     const std::optional<std::array<float, msg::kFilterStages>>& filter_stage_ms) {
  json message = {
      {"type", "tracking"},
      {"robot", robot},
      {"seq", result.seq},
      {"stamp_s", 1e-9 * static_cast<double>(result.stamp_ns)},
      {"state", to_string(result.state)},
      {"pose", nullptr},
      {"map", result.map_id},
      {"maps", result.maps},
      {"inliers", result.inliers},
      {"static", result.features_static},
      {"removed", result.features_removed},
      {"keyframes", result.keyframes},
      {"landmarks", result.landmarks},
      {"latency_ms", rounded(1e-6 * static_cast<double>(msg::minus_ns(result.finished_ns, result.published_ns)), 1e2)},
      {"finished_ms", rounded(finished_ms, 10)},
      {"stage_ms", stages(kSlamStageNames, result.stage_ms)}};
  if (has_pose(result.state)) message["pose"] = pose(result.T_world_camera);
  if (filter_stage_ms) message["filter_stage_ms"] = stages(kFilterStageNames, *filter_stage_ms);
  return json_line(message);
}

std::string boxes(std::uint8_t robot, const msg::Detection2DArray& detections) {
  json list = json::array();
  for (const msg::Detection2D& detection : detections.detections) {
    if (detection.results.empty()) continue;
    const msg::ObjectHypothesis& hypothesis = detection.results.front().hypothesis;
    const msg::BoundingBox2D& box = detection.bbox;
    list.push_back({{"label", hypothesis.class_id},
                    {"score", rounded(hypothesis.score, 1e3)},
                    {"x", rounded(box.center.position.x - box.size_x / 2, 10)},
                    {"y", rounded(box.center.position.y - box.size_y / 2, 10)},
                    {"w", rounded(box.size_x, 10)},
                    {"h", rounded(box.size_y, 10)}});
  }
  const msg::Time& stamp = detections.header.stamp;
  return json_line({{"type", "boxes"},
                    {"robot", robot},
                    {"stamp_s", 1e-9 * static_cast<double>(to_ns(stamp))},
                    {"boxes", std::move(list)}});
}

std::string movers(std::uint8_t robot, const msg::Movers& movers, const std::vector<bool>& rest) {
  const auto rounded_all = [](const std::array<double, 3>& values) {
    json list = json::array();
    for (const double value : values) list.push_back(rounded(value, 1e3));
    return list;
  };
  json list = json::array();
  for (std::size_t i = 0; i < movers.movers.size(); ++i) {
    const msg::Mover& mover = movers.movers[i];
    list.push_back({{"id", mover.id},
                    {"label", mover.class_name},
                    {"center", rounded_all(mover.center_m)},
                    {"size", rounded_all(mover.size_m)},
                    {"velocity", rounded_all(mover.velocity_mps)},
                    {"rests", static_cast<bool>(rest[i])},
                    {"static_probability", rounded(static_cast<double>(mover.static_probability), 1e2)}});
  }
  return json_line({{"type", "movers"},
                    {"robot", robot},
                    {"stamp_s", 1e-9 * static_cast<double>(movers.stamp_ns)},
                    {"movers", std::move(list)}});
}

std::string playback(std::uint8_t robot, const Playback& playback) {
  const char* state = playback.ended ? "ended" : playback.paused ? "paused" : "playing";
  return json_line({{"type", "playback"},
                    {"robot", robot},
                    {"state", state},
                    {"position_s", rounded(playback.position_s, 1e3)},
                    {"length_s", rounded(playback.length_s, 1e3)},
                    {"speed", rounded(playback.speed, 1e3)}});
}

std::string services(std::uint8_t robot, std::span<const ServiceLine> services) {
  json list = json::array();
  for (const ServiceLine& line : services) list.push_back(to_json(line));
  return json_line({{"type", "status"}, {"robot", robot}, {"services", std::move(list)}});
}

std::string commands(std::uint8_t robot, std::span<const CommandInfo> commands) {
  constexpr const char* kArguments[] = {"none", "bool", "text"};
  json list = json::array();
  for (const CommandInfo& command : commands)
    list.push_back({{"name", command.name}, {"argument", kArguments[static_cast<std::size_t>(command.kind)]}});
  return json_line({{"type", "commands"}, {"robot", robot}, {"commands", std::move(list)}});
}

std::string truth_error(std::uint8_t robot, double ate_m, std::size_t frames) {
  return json_line({{"type", "truth_error"}, {"robot", robot}, {"ate_m", rounded(ate_m, 1e5)}, {"frames", frames}});
}

std::string map_reset(std::uint8_t robot) {
  return json_line({{"type", "map_reset"}, {"robot", robot}});
}

std::string robots(std::span<const std::string> names) {
  json list = json::array();
  for (std::size_t index = 0; index < names.size(); ++index) list.push_back({{"index", index}, {"name", names[index]}});
  return json_line({{"type", "robots"}, {"robots", std::move(list)}});
}

std::string atlas(const msg::AtlasState& state) {
  json list = json::array();
  for (const msg::AtlasRobot& robot : state.robots) {
    list.push_back({{"name", robot.name}, {"met", robot.met}, {"map", nullptr}, {"camera", nullptr}});
    if (!robot.met) continue;
    list.back()["map"] = pose(robot.T_map_robot);
    list.back()["camera"] = pose(robot.T_map_camera);
  }
  return json_line({{"type", "atlas"}, {"robots", std::move(list)}});
}

std::string answer(std::uint64_t id, const CommandResult& result) {
  return json_line({{"type", "answer"}, {"id", id}, {"success", result.success}, {"message", result.message}});
}

}  // namespace rtd::viewer::page
