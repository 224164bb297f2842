// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/maps/scene.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/geometry/ply.hpp"
#include "common/io/atomic_file.hpp"
#include "common/service/json_text.hpp"

namespace rtd::maps {
namespace {

/// What points3D.txt holds of a landmark's observations.
struct Track {
  std::string text;
  double error_px = 0;
  std::size_t length = 0;
};

double reprojection_error_px(const Scene& scene, const Eigen::Vector3d& p_camera, const Eigen::Vector2d& seen_px) {
  const Eigen::Vector2d expected_px =
      geometry::CameraModel(scene.camera).project(p_camera) + Eigen::Vector2d::Constant(0.5);
  return (expected_px - seen_px).norm();
}

/// Two lines: the pose, then the landmarks that it sees. COLMAP counts images from 1.
std::string image_text(const Scene& scene, const SceneImage& image, std::map<slam::LandmarkId, Track>& tracks) {
  const slam::Keyframe& keyframe = *image.keyframe;
  const Eigen::Isometry3d T_camera_world = keyframe.T_world_camera.inverse();
  const Eigen::Quaterniond q(T_camera_world.linear());
  const Eigen::Vector3d t = T_camera_world.translation();
  std::string text = fmt::format("{} {:.12f} {:.12f} {:.12f} {:.12f} {:.9f} {:.9f} {:.9f} 1 {}\n", keyframe.id + 1,
                                 q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), image.file);
  std::size_t place = 0;
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    const auto point = scene.points.find(keyframe.landmarks[i]);
    if (point == scene.points.end()) continue;
    const Eigen::Vector2d pixel = scene.pixel_of(keyframe, i);
    text += fmt::format("{:.3f} {:.3f} {} ", pixel.x(), pixel.y(), point->first + 1);
    Track& track = tracks[point->first];
    track.text += fmt::format(" {} {}", keyframe.id + 1, place++);
    track.error_px += reprojection_error_px(scene, T_camera_world * point->second.landmark->position, pixel);
    ++track.length;
  }
  return text + '\n';
}

nlohmann::ordered_json frame_json(const Scene& scene, const SceneImage& image) {
  Eigen::Matrix4d T_world_camera = image.keyframe->T_world_camera.matrix();
  T_world_camera.middleCols<2>(1) *= -1;  // axes of OpenGL: y up, z backwards
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& row : T_world_camera.rowwise()) rows.push_back({row[0], row[1], row[2], row[3]});
  nlohmann::ordered_json json = {{"file_path", "images/" + image.file}, {"transform_matrix", rows}};
  if (scene.masked) json["mask_path"] = "masks/" + image.file;
  return json;
}

}  // namespace

Eigen::Vector2d Scene::pixel_of(const slam::Keyframe& keyframe, std::size_t feature) const {
  const double scale = static_cast<double>(keyframe.frame->width_px) / camera.width;  // slam::FrameRaster
  const msg::Feature& f = keyframe.frame->features[feature];
  return Eigen::Vector2d(f.u_px + 0.5, f.v_px + 0.5) / scale;
}

void write_colmap_model(const Scene& scene, const std::filesystem::path& folder) {
  const auto& c = scene.camera;
  io::write_file(folder / "cameras.txt", fmt::format("1 PINHOLE {} {} {:.9g} {:.9g} {:.9g} {:.9g}\n", c.width, c.height,
                                                     c.fx, c.fy, c.cx + 0.5, c.cy + 0.5));
  std::map<slam::LandmarkId, Track> tracks;
  std::string images, points;
  for (const SceneImage& image : scene.images) images += image_text(scene, image, tracks);
  for (const auto& [id, track] : tracks) {
    const Eigen::Vector3d& p = scene.points.at(id).landmark->position;
    const auto& [red, green, blue] = scene.points.at(id).rgb;
    points += fmt::format("{} {:.6f} {:.6f} {:.6f} {} {} {} {:.3f}{}\n", id + 1, p.x(), p.y(), p.z(), red, green, blue,
                          track.error_px / static_cast<double>(track.length), track.text);
  }
  io::write_file(folder / "images.txt", images);
  io::write_file(folder / "points3D.txt", points);
}

void write_transforms(const Scene& scene, const std::filesystem::path& folder) {
  const auto& c = scene.camera;
  nlohmann::ordered_json json = {{"camera_model", "OPENCV"},
                                 {"w", c.width},
                                 {"h", c.height},
                                 {"fl_x", c.fx},
                                 {"fl_y", c.fy},
                                 {"cx", c.cx + 0.5},
                                 {"cy", c.cy + 0.5},
                                 {"ply_file_path", "points.ply"},
                                 {"frames", nullptr}};
  for (const SceneImage& image : scene.images) json["frames"].push_back(frame_json(scene, image));
  io::write_file(folder / "transforms.json", service::json_text(json) + '\n');
}

void write_points(const Scene& scene, const std::filesystem::path& file) {
  io::write_file(file, [&](std::ostream& out) {
    geometry::write_ply_header(
        out, geometry::PlyFormat::kAscii, "RTD-SLAM landmarks, world frame, metres", scene.points.size(),
        {{"float", "x"}, {"float", "y"}, {"float", "z"}, {"uchar", "red"}, {"uchar", "green"}, {"uchar", "blue"}});
    for (const auto& [id, point] : scene.points) {
      const Eigen::Vector3d& p = point.landmark->position;
      const auto& [red, green, blue] = point.rgb;
      out << fmt::format("{:.5f} {:.5f} {:.5f} {} {} {}\n", p.x(), p.y(), p.z(), red, green, blue);
    }
  });
}

}  // namespace rtd::maps
