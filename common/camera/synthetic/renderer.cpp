// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/camera/synthetic/geometry.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr float kFarthestM = 50.0F;
constexpr float kNearestM = 0.05F;
constexpr float kEdgeOverlapM = 0.0005F;  ///< neighbouring faces overlap this much, so that no crack opens between them
constexpr int kRunBlock = 16;             ///< pixels that share one texture resolution
constexpr std::int32_t kNothing = -1;

const MipLevel& level_for(const Texture& texture, float footprint_texels) {
  std::size_t level = 0;
  for (float size = 1.4F; footprint_texels > size && level + 1 < texture.levels.size(); size *= 2) ++level;
  return texture.levels[level];
}

void write_bgr(std::uint8_t* pixel, std::uint32_t texel) {
  pixel[0] = static_cast<std::uint8_t>(texel);
  pixel[1] = static_cast<std::uint8_t>(texel >> 8);
  pixel[2] = static_cast<std::uint8_t>(texel >> 16);
}

/// Smallest root z of |center + z * ray|^2 = 1; 0 when the ray misses or the root lies behind.
float unit_sphere_depth(const Eigen::Vector3f& center, const Eigen::Vector3f& ray) {
  const float a = dot(ray, ray), b = dot(center, ray), c = dot(center, center) - 1.0F;
  const float discriminant = b * b - a * c;
  if (discriminant <= 0) return 0;
  return std::max(0.0F, (-b - std::sqrt(discriminant)) / a);
}

/// Where a texture that wraps is seen at a point of the unit sphere, 0..1 from its left.
float around(const Eigen::Vector3f& on_sphere) {
  return 0.5F + angle_rad(on_sphere.y(), on_sphere.x()) / kTwoPiF;
}

}  // namespace

std::vector<ObjectView> find_objects(const Rendering& seen) {
  std::vector<ObjectView> objects;  // index: object
  for (int row = 0; row < seen.object.rows; ++row) {
    const auto* object = seen.object.ptr<std::int16_t>(row);
    const auto* moving = seen.moving_mask.ptr<std::uint8_t>(row);
    for (int begin = 0, end = 0; begin < seen.object.cols; begin = end) {
      while (end < seen.object.cols && object[end] == object[begin]) ++end;
      if (object[begin] == kRoomItself) continue;
      const auto index = static_cast<std::size_t>(object[begin]);
      if (index >= objects.size()) objects.resize(index + 1);
      ObjectView& view = objects[index];
      view.object = object[begin];
      view.bounds_px |= cv::Rect(begin, row, end - begin, 1);  // union; an empty one counts for nothing
      view.visible_px += end - begin;
      view.moving = view.moving || std::any_of(moving + begin, moving + end, [](std::uint8_t m) { return m != 0; });
    }
  }
  std::erase_if(objects, [](const ObjectView& view) { return view.visible_px == 0; });
  return objects;
}

Renderer::Renderer(const geometry::CameraModel& camera)
    : camera_(camera.parameters()),
      color_bgr_(camera_.height, camera_.width, CV_8UC3),
      inverse_depth_(camera_.height, camera_.width, CV_32FC1),
      moving_mask_(camera_.height, camera_.width, CV_8UC1),
      material_(camera_.height, camera_.width, CV_8UC1),
      object_(camera_.height, camera_.width, CV_16SC1),
      ids_(camera_.height, camera_.width, CV_32SC1) {}

Rendering Renderer::render(const Geometry& geometry, const std::vector<Texture>& textures,
                           const Eigen::Isometry3d& T_world_camera) {
  return render_rows(geometry, textures, T_world_camera, {0, camera_.height});
}

Rendering Renderer::render_rows(const Geometry& geometry, const std::vector<Texture>& textures,
                                const Eigen::Isometry3d& T_world_camera, cv::Range rows) {
  rows_ = rows;
  set_pose(T_world_camera);
  collect(geometry, textures);
  inverse_depth_.rowRange(rows).setTo(0);
  ids_.rowRange(rows).setTo(kNothing);
  std::int32_t id = 0;
  for (const VisibleFace& face : faces_) cover_with_face(face, id++);
  for (const VisibleEllipsoid& ellipsoid : ellipsoids_) cover_with_ellipsoid(ellipsoid, id++);
  shade();
  return {color_bgr_, inverse_depth_, moving_mask_, material_, object_};
}

void Renderer::set_pose(const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Matrix3d R_world_camera = T_world_camera.linear();
  const Eigen::Vector3d corner(-camera_.cx / camera_.fx, -camera_.cy / camera_.fy, 1.0);
  position_ = T_world_camera.translation().cast<float>();
  ray0_ = (R_world_camera * corner).cast<float>();
  ray_u_ = (R_world_camera.col(0) / camera_.fx).cast<float>();
  ray_v_ = (R_world_camera.col(1) / camera_.fy).cast<float>();
  R_camera_world_ = R_world_camera.transpose().cast<float>();
}

Renderer::LinearForm Renderer::along(const Eigen::Vector3f& direction_world) const {
  return {dot(direction_world, ray0_), dot(direction_world, ray_u_), dot(direction_world, ray_v_)};
}

void Renderer::collect(const Geometry& geometry, const std::vector<Texture>& textures) {
  faces_.clear();
  ellipsoids_.clear();
  for (const Face& face : geometry.faces) {
    const Eigen::Vector3f normal = face.axis_s.cross(face.axis_t);
    const Eigen::Vector3f camera_from_origin = position_ - face.origin;
    const float distance_m = dot(normal, camera_from_origin);
    if (distance_m < 1e-4F) continue;  // seen from behind
    VisibleFace visible;
    visible.texture = &textures[static_cast<std::size_t>(face.surface.texture)];
    visible.surface = face.surface;
    visible.plane_distance_m = distance_m;
    const float scale = visible.texture->texels_per_m;
    const LinearForm toward = along(normal * (-1.0F / distance_m));  // 1/z = -(n . ray) / distance
    const auto texture_form = [&](const Eigen::Vector3f& axis) {     // s/z = axis . (origin_offset / z + ray)
      const float offset_m = dot(axis, camera_from_origin);
      const LinearForm ray = along(axis);
      return LinearForm{scale * (offset_m * toward.at_origin + ray.at_origin),
                        scale * (offset_m * toward.per_u + ray.per_u), scale * (offset_m * toward.per_v + ray.per_v)};
    };
    visible.inverse_depth = toward;
    visible.s_over_z = texture_form(face.axis_s);
    visible.t_over_z = texture_form(face.axis_t);
    visible.width_texels = face.width_m * scale;
    visible.height_texels = face.height_m * scale;
    faces_.push_back(visible);
  }
  for (const Ellipsoid& ellipsoid : geometry.ellipsoids) collect_ellipsoid(ellipsoid, textures);
}

void Renderer::collect_ellipsoid(const Ellipsoid& ellipsoid, const std::vector<Texture>& textures) {
  const cv::Rect bounds = bounds_px(ellipsoid);
  if (bounds.empty()) return;
  const Eigen::Matrix3f R_world_body = ellipsoid.T_world_body.linear();
  const Eigen::Matrix3f to_sphere = ellipsoid.semi_axes_m.cwiseInverse().asDiagonal() * R_world_body.transpose();
  VisibleEllipsoid visible;
  visible.center = times(to_sphere, position_ - ellipsoid.T_world_body.translation());
  visible.ray0 = times(to_sphere, ray0_);
  visible.ray_u = times(to_sphere, ray_u_);
  visible.ray_v = times(to_sphere, ray_v_);
  visible.normal_to_world = to_sphere.transpose();
  visible.bounds = bounds;
  visible.texture = &textures[static_cast<std::size_t>(ellipsoid.surface.texture)];
  visible.surface = ellipsoid.surface;
  ellipsoids_.push_back(visible);
}

cv::Rect Renderer::bounds_px(const Ellipsoid& ellipsoid) const {
  const cv::Rect image(0, rows_.start, camera_.width, rows_.size());
  float u_min = 1e9F, u_max = -1e9F, v_min = 1e9F, v_max = -1e9F;
  int in_front = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f sign((corner & 1) != 0 ? 1.0F : -1.0F, (corner & 2) != 0 ? 1.0F : -1.0F,
                               (corner & 4) != 0 ? 1.0F : -1.0F);
    const Eigen::Vector3f p_world = ellipsoid.T_world_body * sign.cwiseProduct(ellipsoid.semi_axes_m);
    const Eigen::Vector3f p_camera = R_camera_world_ * (p_world - position_);
    if (p_camera.z() < kNearestM) continue;
    ++in_front;
    const float u = static_cast<float>(camera_.fx) * p_camera.x() / p_camera.z() + static_cast<float>(camera_.cx);
    const float v = static_cast<float>(camera_.fy) * p_camera.y() / p_camera.z() + static_cast<float>(camera_.cy);
    u_min = std::min(u_min, u);
    u_max = std::max(u_max, u);
    v_min = std::min(v_min, v);
    v_max = std::max(v_max, v);
  }
  if (in_front == 0) return {};
  if (in_front < 8) return image;  // partly next to or behind the camera: no projection bounds it
  const auto pixel = [](float x) { return static_cast<int>(std::clamp(x, -1e4F, 1e4F)); };
  return cv::Rect(cv::Point(pixel(u_min) - 1, pixel(v_min) - 1), cv::Point(pixel(u_max) + 2, pixel(v_max) + 2)) & image;
}

Renderer::Span Renderer::row_span(const VisibleFace& face, float v) const {
  const float overlap = kEdgeOverlapM * face.texture->texels_per_m;
  const float w0 = face.inverse_depth.row(v), s0 = face.s_over_z.row(v), t0 = face.t_over_z.row(v);
  const float wu = face.inverse_depth.per_u, su = face.s_over_z.per_u, tu = face.t_over_z.per_u;
  const float width = face.width_texels + overlap, height = face.height_texels + overlap;
  // every condition has the form a + b * u >= 0
  const std::array<std::array<float, 2>, 5> conditions = {{{w0 - 1.0F / kFarthestM, wu},
                                                           {s0 + overlap * w0, su + overlap * wu},
                                                           {width * w0 - s0, width * wu - su},
                                                           {t0 + overlap * w0, tu + overlap * wu},
                                                           {height * w0 - t0, height * wu - tu}}};
  float first = 0, last = static_cast<float>(camera_.width - 1);
  for (const auto& [a, b] : conditions) {
    if (b > 0) {
      first = std::max(first, -a / b);
    } else if (b < 0) {
      last = std::min(last, -a / b);
    } else if (a < 0) {
      return {0, 0};
    }
  }
  if (first > last) return {0, 0};
  return {static_cast<int>(std::ceil(first)), static_cast<int>(std::floor(last)) + 1};
}

void Renderer::cover_with_face(const VisibleFace& face, std::int32_t id) {
  for (int row = rows_.start; row < rows_.end; ++row) {
    const auto v = static_cast<float>(row);
    const Span span = row_span(face, v);
    float* nearest = inverse_depth_.ptr<float>(row);
    std::int32_t* ids = ids_.ptr<std::int32_t>(row);
    const float start = face.inverse_depth.row(v), step = face.inverse_depth.per_u;
    for (int column = span.begin; column < span.end; ++column) {
      const float inverse_depth = start + step * static_cast<float>(column);
      const bool nearer = inverse_depth > nearest[column];
      nearest[column] = nearer ? inverse_depth : nearest[column];
      ids[column] = nearer ? id : ids[column];
    }
  }
}

void Renderer::cover_with_ellipsoid(const VisibleEllipsoid& ellipsoid, std::int32_t id) {
  const cv::Rect& bounds = ellipsoid.bounds;
  for (int row = bounds.y; row < bounds.y + bounds.height; ++row) {
    const Eigen::Vector3f row_ray = ellipsoid.ray0 + ellipsoid.ray_v * static_cast<float>(row);
    float* nearest = inverse_depth_.ptr<float>(row);
    std::int32_t* ids = ids_.ptr<std::int32_t>(row);
    for (int column = bounds.x; column < bounds.x + bounds.width; ++column) {
      const float depth_m = unit_sphere_depth(ellipsoid.center, row_ray + ellipsoid.ray_u * static_cast<float>(column));
      if (depth_m <= kNearestM || 1.0F / depth_m <= nearest[column]) continue;
      nearest[column] = 1.0F / depth_m;
      ids[column] = id;
    }
  }
}

void Renderer::shade() {
  for (int row = rows_.start; row < rows_.end; ++row) {
    const std::int32_t* ids = ids_.ptr<std::int32_t>(row);
    for (int begin = 0; begin < camera_.width;) {
      const std::int32_t id = ids[begin];
      int end = begin + 1;
      while (end < camera_.width && end < begin + kRunBlock && ids[end] == id) ++end;
      label_run(shade_run(id, row, {begin, end}), row, {begin, end});
      begin = end;
    }
  }
}

Surface Renderer::shade_run(std::int32_t id, int row, Span span) {
  const auto face_count = static_cast<std::int32_t>(faces_.size());
  if (id == kNothing) {
    std::fill_n(color_bgr_.ptr<std::uint8_t>(row) + 3 * span.begin, 3 * (span.end - span.begin), std::uint8_t{0});
    return {};
  }
  if (id < face_count) {
    const VisibleFace& face = faces_[static_cast<std::size_t>(id)];
    shade_face_run(face, row, span);
    return face.surface;
  }
  const VisibleEllipsoid& ellipsoid = ellipsoids_[static_cast<std::size_t>(id - face_count)];
  shade_ellipsoid_run(ellipsoid, row, span);
  return ellipsoid.surface;
}

void Renderer::label_run(const Surface& surface, int row, Span span) {
  const int pixels = span.end - span.begin;
  std::fill_n(moving_mask_.ptr<std::uint8_t>(row) + span.begin, pixels,
              static_cast<std::uint8_t>(surface.moving ? 255 : 0));
  std::fill_n(object_.ptr<std::int16_t>(row) + span.begin, pixels, static_cast<std::int16_t>(surface.object));
  if (surface.material != Material::kHead) {  // shade_ellipsoid_run has separated hair from skin
    std::fill_n(material_.ptr<std::uint8_t>(row) + span.begin, pixels, static_cast<std::uint8_t>(surface.material));
  }
}

/// Texels of level 0 under one pixel of a surface seen head-on.
float Renderer::footprint_texels(float texels_per_m, float inverse_depth) const {
  return texels_per_m / (inverse_depth * static_cast<float>(camera_.fx));
}

void Renderer::shade_face_run(const VisibleFace& face, int row, Span span) {
  const auto v = static_cast<float>(row);
  const float* inverse_depth = inverse_depth_.ptr<float>(row);
  const float middle = inverse_depth[(span.begin + span.end) / 2];
  const float cos_incidence = std::clamp(face.plane_distance_m * middle, 0.05F, 1.0F);  // n . ray, ray of length ~ 1
  const MipLevel& level =
      level_for(*face.texture, footprint_texels(face.texture->texels_per_m, middle) / std::sqrt(cos_incidence));
  const float scale = static_cast<float>(level.width) / static_cast<float>(face.texture->levels.front().width);
  const float s0 = face.s_over_z.row(v) * scale, s_step = face.s_over_z.per_u * scale;
  const float t0 = face.t_over_z.row(v) * scale, t_step = face.t_over_z.per_u * scale;
  std::uint8_t* pixel = color_bgr_.ptr<std::uint8_t>(row) + 3 * span.begin;
  for (int column = span.begin; column < span.end; ++column, pixel += 3) {
    const float depth_m = 1.0F / inverse_depth[column];
    const auto u = static_cast<float>(column);
    write_bgr(pixel, sample(level, (s0 + s_step * u) * depth_m, (t0 + t_step * u) * depth_m));
  }
}

void Renderer::shade_ellipsoid_run(const VisibleEllipsoid& ellipsoid, int row, Span span) {
  static const Eigen::Vector3f kFromAbove(0.35F, -0.45F, 0.82F);
  static const Eigen::Vector3f kLight = kFromAbove / std::sqrt(dot(kFromAbove, kFromAbove));
  const float* inverse_depth = inverse_depth_.ptr<float>(row);
  const float footprint = footprint_texels(ellipsoid.texture->texels_per_m, inverse_depth[(span.begin + span.end) / 2]);
  const MipLevel& level = level_for(*ellipsoid.texture, footprint);
  const Eigen::Vector3f row_ray = ellipsoid.ray0 + ellipsoid.ray_v * static_cast<float>(row);
  const auto width = static_cast<float>(level.width), height = static_cast<float>(level.height);
  std::uint8_t* pixel = color_bgr_.ptr<std::uint8_t>(row) + 3 * span.begin;
  for (int column = span.begin; column < span.end; ++column, pixel += 3) {
    const Eigen::Vector3f ray = row_ray + ellipsoid.ray_u * static_cast<float>(column);
    const Eigen::Vector3f on_sphere = ellipsoid.center + ray / inverse_depth[column];
    const Eigen::Vector3f across = times(ellipsoid.normal_to_world, on_sphere);
    const Eigen::Vector3f normal_world = across / std::sqrt(dot(across, across));
    const auto light = static_cast<std::uint32_t>(256.0F * (0.68F + 0.32F * dot(normal_world, kLight)));
    const float s =
        ellipsoid.texture->wraps ? around(on_sphere) * width : (on_sphere.x() + on_sphere.y() + 1.42F) / 2.84F * width;
    const float t = (1.0F - on_sphere.z()) / 2.0F * height;
    const std::uint32_t texel = sample(level, s, t);
    pixel[0] = static_cast<std::uint8_t>(((texel & 255U) * light) >> 8);
    pixel[1] = static_cast<std::uint8_t>((((texel >> 8) & 255U) * light) >> 8);
    pixel[2] = static_cast<std::uint8_t>((((texel >> 16) & 255U) * light) >> 8);
    if (ellipsoid.surface.material == Material::kHead) {
      material_.at<std::uint8_t>(row, column) =
          static_cast<std::uint8_t>(is_hair(on_sphere) ? Material::kDark : Material::kPlain);
    }
  }
}

}  // namespace rtd::camera::synthetic
