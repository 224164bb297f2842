// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/page_messages.hpp"

#include <algorithm>
#include <cmath>

#include "common/msg/stamps.hpp"
#include "common/vision/jpeg_size.hpp"

namespace rtd::viewer::page {
namespace {

/// What every message begins with.
ByteWriter begin(Kind kind, std::uint8_t robot, std::uint32_t map_id, std::size_t count) {
  return ByteWriter(kind, robot, static_cast<std::uint16_t>(std::min<std::uint32_t>(map_id, UINT16_MAX)),
                    static_cast<std::uint32_t>(count));
}

void put(ByteWriter& writer, const Eigen::Vector3f& vector) {
  writer.put(vector.x(), vector.y(), vector.z());
}

double seconds(const msg::Time& stamp) {
  return 1e-9 * static_cast<double>(to_ns(stamp));
}

std::uint16_t sixteenths(float px) {
  return static_cast<std::uint16_t>(std::clamp(std::isfinite(px) ? px : 0.0F, 0.0F, 4095.0F) * 16.0F + 0.5F);
}

std::uint8_t byte_of(float probability) {
  return static_cast<std::uint8_t>(std::clamp(std::isfinite(probability) ? probability : 0.0F, 0.0F, 1.0F) * 255.0F +
                                   0.5F);
}

/// One keyframe's points, as 16-bit multiples of a step that reaches the farthest.
void put_points(ByteWriter& writer, const KeyframeRef& keyframe, std::size_t stride) {
  const auto& points = keyframe.second->points_m;
  float reach = 0.001F;
  for (const Eigen::Vector3f& point : points) reach = std::max(reach, point.cwiseAbs().maxCoeff());
  const float scale = reach / INT16_MAX;
  const std::size_t total = std::min<std::size_t>(points.size(), UINT16_MAX);
  writer.put(keyframe.first, static_cast<std::uint16_t>((total + stride - 1) / stride),
             static_cast<std::uint16_t>(total), scale);
  for (std::size_t place = 0; place < total; place += stride) {
    for (int axis = 0; axis < 3; ++axis)
      writer.put(static_cast<std::int16_t>(std::lround(points[place][axis] / scale)));
    writer.put(std::uint8_t{255}, std::uint8_t{0});
  }
}

}  // namespace

Bytes poses(std::uint8_t robot, std::uint32_t map_id, std::span<const KeyframeRef> keyframes) {
  ByteWriter writer = begin(Kind::kPoses, robot, map_id, keyframes.size());
  for (const auto& [id, keyframe] : keyframes) {
    const Eigen::Quaternionf q(keyframe->T_world_camera.linear());
    writer.put(id);
    put(writer, Eigen::Vector3f(keyframe->T_world_camera.translation()));
    writer.put(q.x(), q.y(), q.z(), q.w());
  }
  return writer.take();
}

Bytes removed(std::uint8_t robot, std::span<const std::uint32_t> ids) {
  ByteWriter writer = begin(Kind::kRemoved, robot, 0, ids.size());
  writer.put_bytes(ids.data(), ids.size_bytes());
  return writer.take();
}

Bytes points(std::uint8_t robot, std::uint32_t map_id, std::span<const KeyframeRef> keyframes, std::size_t stride) {
  ByteWriter writer = begin(Kind::kPoints, robot, map_id, keyframes.size());
  for (const KeyframeRef& keyframe : keyframes) put_points(writer, keyframe, std::max<std::size_t>(stride, 1));
  return writer.take();
}

Bytes covisibility(std::uint8_t robot, std::span<const KeyframeRef> keyframes) {
  ByteWriter writer = begin(Kind::kCovisibility, robot, 0, keyframes.size());
  for (const auto& [id, keyframe] : keyframes) {
    const std::size_t count = std::min<std::size_t>(keyframe->covisible.size(), UINT16_MAX);
    writer.put(id, static_cast<std::uint16_t>(count), std::uint16_t{0});
    writer.put_bytes(keyframe->covisible.data(), count * sizeof(std::uint32_t));
  }
  return writer.take();
}

Bytes loop_edges(std::uint8_t robot, std::span<const std::uint32_t> pairs) {
  ByteWriter writer = begin(Kind::kLoopEdges, robot, 0, pairs.size() / 2);
  writer.put_bytes(pairs.data(), pairs.size() / 2 * 2 * sizeof(std::uint32_t));
  return writer.take();
}

Bytes trajectory(std::uint8_t robot, std::uint32_t start, std::span<const TrajectoryPoint> points) {
  ByteWriter writer = begin(Kind::kTrajectory, robot, 0, points.size());
  writer.put(start);
  for (const TrajectoryPoint& point : points) {
    writer.put(point.keyframe);
    put(writer, point.position_m);
  }
  return writer.take();
}

Bytes trajectory_values(std::uint8_t robot, std::uint32_t start, std::int64_t begin_ns,
                        std::span<const TrajectoryPoint> points, std::span<const float> errors_m) {
  ByteWriter writer = begin(Kind::kTrajectoryValues, robot, 0, points.size());
  writer.put(start);
  for (std::size_t place = 0; place < points.size(); ++place) {
    const TrajectoryPoint& point = points[place];
    writer.put(static_cast<std::uint32_t>(point.state),
               static_cast<float>(1e-9 * static_cast<double>(msg::minus_ns(point.stamp_ns, begin_ns))), point.sigma_m,
               errors_m[place]);
  }
  return writer.take();
}

Bytes truth(std::uint8_t robot, std::uint32_t start, std::span<const Eigen::Vector3f> points_m) {
  ByteWriter writer = begin(Kind::kTruth, robot, 0, points_m.size());
  writer.put(start);
  for (const Eigen::Vector3f& point : points_m) put(writer, point);
  return writer.take();
}

Bytes image(std::uint8_t robot, const msg::CompressedImage& image, Kind kind) {
  const cv::Size size = vision::jpeg_size(image.data);
  ByteWriter writer = begin(kind, robot, 0, image.data.size());
  writer.put(seconds(image.header.stamp), static_cast<std::uint32_t>(size.width),
             static_cast<std::uint32_t>(size.height));
  writer.put_bytes(image.data.data(), image.data.size());
  return writer.take();
}

Bytes features(std::uint8_t robot, const msg::FeatureFrame& frame) {
  const std::uint32_t count = std::min(frame.count, msg::kMaxFeatures);
  ByteWriter writer = begin(Kind::kFeatures, robot, 0, count);
  writer.put(1e-9 * static_cast<double>(frame.stamp_ns), static_cast<std::uint16_t>(frame.width),
             static_cast<std::uint16_t>(frame.height));
  for (std::uint32_t place = 0; place < count; ++place) {
    const msg::Feature& feature = frame.features[place];
    const bool removed = (feature.flags & msg::kFeatureRemoved) != 0;
    writer.put(sixteenths(feature.u_raw_px), sixteenths(feature.v_raw_px), static_cast<std::uint8_t>(removed),
               byte_of(feature.static_probability));
  }
  return writer.take();
}

namespace {

/// Pairs (value, run - 1); sets the count of the head.
void put_runs(ByteWriter& writer, std::span<const std::uint8_t> values) {
  const std::size_t first = writer.size();
  for (std::size_t place = 0; place < values.size();) {
    std::size_t end = place + 1;
    while (end < values.size() && end - place < 256 && values[end] == values[place]) ++end;
    writer.put(values[place], static_cast<std::uint8_t>(end - place - 1));
    place = end;
  }
  writer.set(4, static_cast<std::uint32_t>(writer.size() - first));
}

}  // namespace

Bytes plan(std::uint8_t robot, const msg::OccupancyGrid& plan) {
  const auto& [load_time, cell_m, width, height, origin] = plan.info;
  constexpr std::size_t kMaxSide = 4096;
  const std::size_t cells = std::size_t{width} * height;
  if (cells == 0 || width > kMaxSide || height > kMaxSide || plan.data.size() != cells || !(cell_m > 0)) return {};
  ByteWriter writer = begin(Kind::kPlan, robot, 0, 0);
  writer.put(cell_m, static_cast<std::uint16_t>(width), static_cast<std::uint16_t>(height));
  const auto& [position, turn] = origin;
  for (const double value : {position.x, position.y, position.z, turn.x, turn.y, turn.z, turn.w})
    writer.put(static_cast<float>(value));
  std::vector<std::uint8_t> values(cells);
  std::ranges::transform(plan.data, values.begin(), [](std::int8_t cell) { return static_cast<std::uint8_t>(cell); });
  put_runs(writer, values);
  return writer.take();
}

Bytes runs(Kind kind, std::uint8_t robot, const msg::Image& image) {
  const std::size_t pixels = std::size_t{image.width} * image.height;
  constexpr std::size_t kMaxPixels = 1U << 20U;
  if (image.encoding != "mono8" || image.step != image.width || pixels == 0 || pixels > kMaxPixels ||
      image.data.size() < pixels)
    return {};
  ByteWriter writer = begin(kind, robot, 0, 0);
  writer.put(seconds(image.header.stamp), static_cast<std::uint16_t>(image.width),
             static_cast<std::uint16_t>(image.height));
  put_runs(writer, {image.data.data(), pixels});
  return writer.take();
}

Bytes dense(Kind kind, std::uint8_t robot, std::uint32_t start, std::uint32_t total, const Eigen::Vector3f& origin_m,
            float scale_m, std::span<const std::byte> points) {
  constexpr std::size_t kPointBytes = 9;
  ByteWriter writer = begin(kind, robot, 0, points.size() / kPointBytes);
  writer.put(start, total);
  put(writer, origin_m);
  writer.put(scale_m);
  writer.put_bytes(points.data(), points.size());
  return writer.take();
}

}  // namespace rtd::viewer::page
