// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "common/service/command_line.hpp"
#include "services/slam/map_tool/map_report.hpp"

namespace rtd::map_tool {
namespace {

constexpr const char* kChecksums = "all right";  // a file with a wrong checksum gets no report

std::uint64_t unsigned_ns(std::int64_t time_ns) {
  return time_ns < 0 ? 0 : static_cast<std::uint64_t>(time_ns);
}

std::string row(const char* name, const std::string& text) {
  return fmt::format("{:<12} {}\n", name, text);
}

std::string camera_text(const slam::Frame& frame) {
  return fmt::format("{}x{}, fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f}", frame.width_px, frame.height_px, frame.camera.fx,
                     frame.camera.fy, frame.camera.cx, frame.camera.cy);
}

std::string part_rows(const MapPart& part) {
  std::string text = row(fmt::format("map {}", part.id).c_str(),
                         fmt::format("{} keyframes, {} landmarks", part.keyframes, part.landmarks));
  text += row("  time", fmt::format("{} for {}", service::time_text(unsigned_ns(part.first_stamp_ns)),
                                    service::seconds_text(unsigned_ns(part.last_stamp_ns - part.first_stamp_ns))));
  text += row("  path", fmt::format("{:.2f} m", part.path_m));
  if (part.extent_m.isEmpty()) return text;
  const Eigen::Vector3d size = part.extent_m.sizes();
  return text + row("  extent", fmt::format("{:.2f} x {:.2f} x {:.2f} m", size.x(), size.y(), size.z()));
}

nlohmann::ordered_json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::ordered_json part_json(const MapPart& part) {
  nlohmann::ordered_json json = {{"id", part.id},
                                 {"keyframes", part.keyframes},
                                 {"landmarks", part.landmarks},
                                 {"first_stamp_ns", part.first_stamp_ns},
                                 {"last_stamp_ns", part.last_stamp_ns},
                                 {"path_m", part.path_m}};
  if (!part.extent_m.isEmpty())
    json["extent_m"] = {{"min", vector_json(part.extent_m.min())}, {"max", vector_json(part.extent_m.max())}};
  return json;
}

}  // namespace

std::string to_text(const MapReport& report, const std::string& name) {
  std::string text = row("file", fmt::format("{}, {}", name, service::bytes_text(report.bytes)));
  text += row("version", fmt::format("{}, checksums {}", report.version, kChecksums));
  text += row("keyframes", fmt::format("{} with {} features; {} removed", report.keyframes, report.features,
                                       report.removed_keyframes));
  text += row("landmarks", fmt::format("{} seen {} times", report.landmarks, report.observations));
  for (const slam::FramePtr& camera : report.cameras) text += row("camera", camera_text(*camera));
  for (const MapPart& part : report.maps) text += part_rows(part);
  return text;
}

nlohmann::ordered_json to_json(const MapReport& report, const std::string& name) {
  nlohmann::ordered_json json = {{"file", name},
                                 {"bytes", report.bytes},
                                 {"version", report.version},
                                 {"checksums", kChecksums},
                                 {"keyframes", report.keyframes},
                                 {"features", report.features},
                                 {"removed_keyframes", report.removed_keyframes},
                                 {"landmarks", report.landmarks},
                                 {"observations", report.observations},
                                 {"cameras", nlohmann::ordered_json::array()},
                                 {"maps", nlohmann::ordered_json::array()}};
  for (const slam::FramePtr& camera : report.cameras) {
    const vision::RgbdProjection& p = camera->camera;
    json["cameras"].push_back({{"width", camera->width_px},
                               {"height", camera->height_px},
                               {"fx", p.fx},
                               {"fy", p.fy},
                               {"cx", p.cx},
                               {"cy", p.cy}});
  }
  for (const MapPart& part : report.maps) json["maps"].push_back(part_json(part));
  return json;
}

}  // namespace rtd::map_tool
