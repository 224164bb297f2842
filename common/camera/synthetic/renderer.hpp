// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "common/camera/synthetic/geometry.hpp"
#include "common/geometry/camera_model.hpp"

namespace rtd::camera::synthetic {

/// What an ideal pinhole RGB-D camera sees. Valid until the next call of the renderer that made it.
struct Rendering {
  cv::Mat color_bgr;      ///< CV_8UC3
  cv::Mat inverse_depth;  ///< CV_32FC1, 1 / z in 1/m; 0 = nothing there
  cv::Mat moving_mask;    ///< CV_8UC1, 255 = moving object
  cv::Mat material;       ///< CV_8UC1, Material; a head is skin (kPlain) and hair (kDark)
  cv::Mat object;         ///< CV_16SC1, index of the object or kRoomItself
};

/// What of an object is seen.
struct ObjectView {
  int object = kRoomItself;  ///< index
  cv::Rect bounds_px;        ///< of its visible pixels
  int visible_px = 0;
  bool moving = false;  ///< some of what is seen of it moves
};

/// The objects that an image shows, by index.
std::vector<ObjectView> find_objects(const Rendering& seen);

/// Draws textured rectangles and ellipsoids into a pinhole camera without distortion, exact to float precision: 1/z and
/// texture/z of a plane are linear in the pixel, an ellipsoid is a quadratic equation per pixel. Visibility first, then
/// one texture lookup per pixel. Not thread-safe.
class Renderer {
 public:
  explicit Renderer(const geometry::CameraModel& camera);

  Rendering render(const Geometry& geometry, const std::vector<Texture>& textures,
                   const Eigen::Isometry3d& T_world_camera);
  /// Draws some rows as they are seen at one moment; the others stay as they were drawn for another.
  Rendering render_rows(const Geometry& geometry, const std::vector<Texture>& textures,
                        const Eigen::Isometry3d& T_world_camera, cv::Range rows);
  int height_px() const { return camera_.height; }

 private:
  /// value(u, v) = at_origin + per_u * u + per_v * v
  struct LinearForm {
    float at_origin = 0, per_u = 0, per_v = 0;
    float row(float v) const { return at_origin + per_v * v; }
  };
  /// A face seen by the camera: 1/z and texture coordinates (texels of level 0) over z, linear in the pixel.
  struct VisibleFace {
    LinearForm inverse_depth, s_over_z, t_over_z;
    float width_texels = 0, height_texels = 0;
    float plane_distance_m = 0;  ///< of the camera centre
    const Texture* texture = nullptr;
    Surface surface;
  };
  /// An ellipsoid in the frame where it is the unit sphere; the ray to a pixel is center + z * (ray0 + u * ray_u + v *
  /// ray_v).
  struct VisibleEllipsoid {
    Eigen::Vector3f center, ray0, ray_u, ray_v;
    Eigen::Matrix3f normal_to_world;
    cv::Rect bounds;  ///< px
    const Texture* texture = nullptr;
    Surface surface;
  };
  struct Span {
    int begin, end;
  };

  void set_pose(const Eigen::Isometry3d& T_world_camera);
  LinearForm along(const Eigen::Vector3f& direction_world) const;
  void collect(const Geometry& geometry, const std::vector<Texture>& textures);
  void collect_ellipsoid(const Ellipsoid& ellipsoid, const std::vector<Texture>& textures);
  cv::Rect bounds_px(const Ellipsoid& ellipsoid) const;
  void cover_with_face(const VisibleFace& face, std::int32_t id);
  Span row_span(const VisibleFace& face, float v) const;
  void cover_with_ellipsoid(const VisibleEllipsoid& ellipsoid, std::int32_t id);
  void shade();
  Surface shade_run(std::int32_t id, int row, Span span);
  void label_run(const Surface& surface, int row, Span span);
  void shade_face_run(const VisibleFace& face, int row, Span span);
  void shade_ellipsoid_run(const VisibleEllipsoid& ellipsoid, int row, Span span);
  float footprint_texels(float texels_per_m, float inverse_depth) const;

  geometry::CameraModel::Parameters camera_;
  cv::Range rows_;                        ///< that are drawn now
  Eigen::Vector3f ray0_, ray_u_, ray_v_;  ///< ray to pixel (u, v) with z = 1, world frame: ray0 + u * ray_u + v * ray_v
  Eigen::Vector3f position_;              ///< camera centre, world frame
  Eigen::Matrix3f R_camera_world_;
  std::vector<VisibleFace> faces_;
  std::vector<VisibleEllipsoid> ellipsoids_;
  cv::Mat color_bgr_, inverse_depth_, moving_mask_, material_, object_;
  cv::Mat ids_;  ///< CV_32SC1, index of a face, then of an ellipsoid, -1 nothing
};

}  // namespace rtd::camera::synthetic
