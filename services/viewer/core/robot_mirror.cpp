// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/robot_mirror.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "common/msg/stamps.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/viewer/core/page_messages.hpp"

namespace rtd::viewer {
namespace {

constexpr std::size_t kMaxPoints = 1'000'000, kMaxWaiting = 256, kFewestPairs = 10;

Eigen::Matrix3Xd matrix_of(const std::vector<Eigen::Vector3d>& points) {
  return Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3, static_cast<Eigen::Index>(points.size()));
}

constexpr std::size_t kKept = 64;  ///< images and overlays, newest
constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kFilterGoneNs = 2000 * kMs;  // images that are so much newer than all features are shown alone
constexpr std::int64_t kSameFrameNs = 1 * kMs;
constexpr std::int64_t kBoxesStayNs = 400 * kMs;  // a slow detector's boxes are those of an earlier frame

Payload shared(Bytes bytes) {
  return std::make_shared<const Bytes>(std::move(bytes));
}

Payload shared_text(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return std::make_shared<const Bytes>(bytes.begin(), bytes.end());
}

/// Offsets of x, y, z and rgb; empty where the cloud has them in another form.
std::optional<std::array<std::uint32_t, 4>> layout_of(const msg::PointCloud2& cloud) {
  constexpr std::uint8_t kFloat32 = 7;
  constexpr const char* kNames[] = {"x", "y", "z", "rgb"};
  std::array<std::uint32_t, 4> offsets{};
  for (std::size_t place = 0; place < offsets.size(); ++place) {
    const auto field = std::ranges::find(cloud.fields, kNames[place], &msg::PointField::name);
    if (field == cloud.fields.end() || field->datatype != kFloat32) return {};
    if (std::uint64_t{field->offset} + sizeof(float) > cloud.point_step)
      return {};  // in 64 bits: it is anyone's number
    offsets[place] = field->offset;
  }
  return offsets;
}

/// Steps of about .62 of the count, without a common divisor, visit all places and each part of them evenly.
std::size_t spreading_step(std::size_t count) {
  auto step = static_cast<std::size_t>(0.618 * static_cast<double>(count)) | 1U;
  while (std::gcd(step, count) != 1) ++step;
  return step;
}

template <class T>
T value_at(const std::vector<std::uint8_t>& data, std::size_t position) {
  T value;
  std::memcpy(&value, data.data() + position, sizeof(T));
  return value;
}

}  // namespace

void TruthTrack::add_truth(std::int64_t stamp_ns, const Eigen::Vector3d& position_m) {
  if (truth_m_.size() >= kMaxPoints || !position_m.allFinite()) return;
  truth_m_.push_back(position_m);
  waiting_truth_.push_back({stamp_ns, position_m});
  pair();
}

void TruthTrack::add_estimate(std::int64_t stamp_ns, const Eigen::Vector3d& position_m) {
  if (paired_truth_m_.size() >= kMaxPoints || !position_m.allFinite()) return;
  waiting_estimates_.push_back({stamp_ns, position_m});
  pair();
}

/// Truth carries the stamp of its frame, as the estimate does.
void TruthTrack::pair() {
  std::erase_if(waiting_estimates_, [this](const Stamped& estimate) {
    const auto truth = std::ranges::find(waiting_truth_, estimate.stamp_ns, &Stamped::stamp_ns);
    if (truth == waiting_truth_.end()) return false;
    paired_truth_m_.push_back(truth->position_m);
    paired_estimate_m_.push_back(estimate.position_m);
    paired_stamps_ns_.push_back(estimate.stamp_ns);
    waiting_truth_.erase(truth);
    return true;
  });
  for (auto* waiting : {&waiting_truth_, &waiting_estimates_})
    if (waiting->size() > kMaxWaiting) waiting->pop_front();
}

void TruthTrack::align_if_grown() {
  const std::size_t grown = paired_truth_m_.size() - aligned_pairs_;
  if (paired_truth_m_.size() >= kFewestPairs && grown >= std::clamp<std::size_t>(aligned_pairs_ / 10, 1, 30)) align();
}

void TruthTrack::align() {
  aligned_pairs_ = paired_truth_m_.size();
  const Eigen::Matrix3Xd truth = matrix_of(paired_truth_m_), estimate = matrix_of(paired_estimate_m_);
  const Eigen::Isometry3d aligned(Eigen::umeyama(truth, estimate, false));
  if (!aligned.matrix().allFinite()) return;
  constexpr double kVisible_m = 0.002;
  const double moved_m = ((aligned * truth.col(0)) - (T_map_truth_ * truth.col(0))).norm() +
                         ((aligned * truth.rightCols<1>()) - (T_map_truth_ * truth.rightCols<1>())).norm();
  if (moved_m > kVisible_m) {
    T_map_truth_ = aligned;
    ++revision_;
  }
  ate_m_ = std::sqrt(((aligned * truth) - estimate).colwise().squaredNorm().mean());
}

std::optional<double> TruthTrack::error_m(std::int64_t stamp_ns) const {
  const auto found = std::ranges::lower_bound(paired_stamps_ns_, stamp_ns);
  if (revision_ == 0 || found == paired_stamps_ns_.end() || *found != stamp_ns) return std::nullopt;
  const auto place = static_cast<std::size_t>(found - paired_stamps_ns_.begin());
  return (T_map_truth_ * paired_truth_m_[place] - paired_estimate_m_[place]).norm();
}

std::size_t AnnotatedImage::bytes() const {
  std::size_t bytes = 0;
  for (const Payload& part : {image, features, mask, boxes, people, depth}) bytes += part ? part->size() : 0;
  return bytes;
}

void RobotMirror::add(const msg::TrackingResult& result, double finished_ms) {
  if (msg::is_measured(result.state)) {
    const Eigen::Vector3d position(result.T_world_camera.translation_m.data());
    map_.add_position(result);
    if (result.map_id == 0) truth_.add_estimate(result.stamp_ns, position);
  }
  set(Item::kTracking, page::tracking(index_, result, finished_ms, filter_stage_ms_));
  constexpr double kApart_ms = 200;
  constexpr std::size_t kRecent = 300;
  if (std::abs(finished_ms - recent_ms_) < kApart_ms) return;
  recent_ms_ = finished_ms;
  recent_tracking_.push_back(item(Item::kTracking));
  if (recent_tracking_.size() > kRecent) recent_tracking_.pop_front();
}

void RobotMirror::add(const msg::FeatureFrame& frame) {
  filter_stage_ms_ = frame.stage_ms;
  keep(features_, frame.stamp_ns, shared(page::features(index_, frame)));
}

void RobotMirror::add(const msg::CompressedImage& image) {
  keep(images_, to_ns(image.header.stamp), shared(page::image(index_, image)));
}

void RobotMirror::add(const msg::Detection2DArray& detections) {
  keep(boxes_, to_ns(detections.header.stamp), shared_text(page::boxes(index_, detections)));
}

void RobotMirror::add(const msg::Image& mask) {
  Bytes bytes = page::runs(page::Kind::kMask, index_, mask);
  if (!bytes.empty()) keep(masks_, to_ns(mask.header.stamp), shared(std::move(bytes)));
}

void RobotMirror::add_people(const msg::Image& masks) {
  Bytes bytes = page::runs(page::Kind::kPeople, index_, masks);
  if (!bytes.empty()) keep(people_, to_ns(masks.header.stamp), shared(std::move(bytes)));
}

void RobotMirror::add_depth(const msg::CompressedImage& picture) {
  keep(depths_, to_ns(picture.header.stamp), shared(page::image(index_, picture, page::Kind::kDepth)));
}

void RobotMirror::add(const msg::ServiceStatus& status, std::int64_t received_ns) {
  constexpr std::size_t kMaxServices = 256;
  if (services_.size() >= kMaxServices && !services_.contains(status.service)) return;
  services_.insert_or_assign(status.service, KnownService{status, received_ns});
}

/// 16-bit steps within the cloud's box, and its colours.
void RobotMirror::add(CloudKind kind, const msg::PointCloud2& cloud) {
  Dense& dense_of_kind = dense_[static_cast<std::size_t>(kind)];
  const auto layout = layout_of(cloud);
  const std::size_t count = cloud.point_step == 0 ? 0 : cloud.data.size() / cloud.point_step;
  if (!layout || count == 0) return;
  const auto position = [&](std::size_t place) {
    const std::size_t begin = place * cloud.point_step;
    return Eigen::Vector3f(value_at<float>(cloud.data, begin + (*layout)[0]),
                           value_at<float>(cloud.data, begin + (*layout)[1]),
                           value_at<float>(cloud.data, begin + (*layout)[2]));
  };
  Eigen::AlignedBox3f box;
  for (std::size_t place = 0; place < count; ++place)
    if (const Eigen::Vector3f point = position(place); point.allFinite()) box.extend(point);
  if (box.isEmpty()) return;
  Dense dense{.revision = dense_of_kind.revision + 1, .origin_m = box.center()};
  dense.scale_m = std::max(0.001F, box.sizes().maxCoeff() / 2) / INT16_MAX;
  ByteWriter writer;
  const std::size_t step = spreading_step(count);
  for (std::size_t turn = 0, place = 0; turn < count; ++turn, place = (place + step) % count) {
    const Eigen::Vector3f point = (position(place) - dense.origin_m) / dense.scale_m;
    if (!point.allFinite()) continue;
    for (int axis = 0; axis < 3; ++axis) writer.put(static_cast<std::int16_t>(std::lround(point[axis])));
    const auto bgr = value_at<std::array<std::uint8_t, 4>>(cloud.data, place * cloud.point_step + (*layout)[3]);
    for (const int channel : {2, 1, 0}) writer.put(bgr[static_cast<std::size_t>(channel)]);
  }
  dense.points = writer.take();
  dense_of_kind = std::move(dense);
}

void RobotMirror::add(const msg::OccupancyGrid& plan) {
  Bytes bytes = page::plan(index_, plan);
  if (!bytes.empty()) plan_ = {plan_.revision + 1, shared(std::move(bytes))};
}

void RobotMirror::add(const msg::Movers& movers) {
  set(Item::kMovers, page::movers(index_, movers, trails_.rest(movers)));
}

void RobotMirror::add_truth(std::int64_t stamp_ns, const Eigen::Vector3d& position_m) {
  truth_.add_truth(stamp_ns, position_m);
}

void RobotMirror::set_commands(const std::vector<CommandInfo>& commands) {
  set(Item::kCommands, page::commands(index_, commands));
}

void RobotMirror::refresh(std::int64_t now_ns) {
  set(Item::kStatus, page::services(index_, services(now_ns)));
  truth_.align_if_grown();
  if (truth_.ate_m() > 0) set(Item::kTruthError, page::truth_error(index_, truth_.ate_m(), truth_.pairs()));
}

std::vector<page::ServiceLine> RobotMirror::services(std::int64_t now_ns) const {
  std::vector<page::ServiceLine> lines;
  for (const auto& [name, known] : services_)
    lines.push_back({known.status, 1e-6 * static_cast<double>(msg::minus_ns(now_ns, known.received_ns))});
  return lines;
}

void RobotMirror::set(Item item, const std::string& json) {
  Message& message = items_[static_cast<std::size_t>(item)];
  Payload payload = shared_text(json);
  if (message.payload && *message.payload == *payload) return;
  message.payload = std::move(payload);
  ++message.revision;
}

void RobotMirror::keep(Overlays& overlays, std::int64_t stamp_ns, Payload payload) {
  overlays.push_back({stamp_ns, std::move(payload)});
  if (overlays.size() > kKept) overlays.pop_front();
}

/// The newest one not after the stamp and at most this much before.
Payload RobotMirror::at(const Overlays& overlays, std::int64_t stamp_ns, std::int64_t tolerance_ns) {
  for (auto overlay = overlays.rbegin(); overlay != overlays.rend(); ++overlay)
    if (overlay->stamp_ns <= msg::plus_ns(stamp_ns, kSameFrameNs))
      return msg::minus_ns(stamp_ns, overlay->stamp_ns) <= tolerance_ns ? overlay->payload : nullptr;
  return nullptr;
}

/// On a busy host features come long after their image. They never come if the filter ended, or if it looks at other
/// images than these.
bool RobotMirror::filter_is_late() const {
  if (images_.empty() || features_.empty() || images_.size() >= kKept) return false;
  const std::int64_t behind_ns = msg::minus_ns(images_.back().stamp_ns, features_.back().stamp_ns);
  return behind_ns >= 0 && behind_ns <= kFilterGoneNs;
}

std::optional<AnnotatedImage> RobotMirror::newest_image() const {
  if (images_.empty() && features_.empty()) return std::nullopt;
  AnnotatedImage view;
  for (auto image = images_.rbegin(); image != images_.rend() && !view.features; ++image)
    view = {
        .stamp_ns = image->stamp_ns, .image = image->payload, .features = at(features_, image->stamp_ns, kSameFrameNs)};
  if (!view.features) {
    if (filter_is_late()) return std::nullopt;
    const Overlay& newest = images_.empty() ? features_.back() : images_.back();
    view.stamp_ns = newest.stamp_ns;
    (images_.empty() ? view.features : view.image) = newest.payload;
  }
  view.mask = at(masks_, view.stamp_ns, kSameFrameNs);
  view.boxes = at(boxes_, view.stamp_ns, kBoxesStayNs);
  view.people = at(people_, view.stamp_ns, kBoxesStayNs);
  view.depth = at(depths_, view.stamp_ns, kBoxesStayNs);
  return view;
}

}  // namespace rtd::viewer
