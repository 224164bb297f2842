// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/slam_messages.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/se3.hpp"
#include "common/msg/point_cloud.hpp"
#include "common/msg/stamps.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/vision/samples.hpp"

namespace rtd::slam {
namespace {

double share_removed(const msg::TrackingResult& result) {
  const double all = static_cast<double>(result.features_static) + result.features_removed;
  return all > 0 ? result.features_removed / all : 0;
}

ViewState view_of(const msg::TrackingResult& result, double view_removed) {
  constexpr double kCrowded = 0.5;
  constexpr std::uint32_t kFewest = 100;  // features of an image that shows something
  const bool ok = result.state == msg::TrackingState::kOk;
  if (!ok && result.features_static + result.features_removed < kFewest) return ViewState::kBlind;
  if (view_removed >= kCrowded) return ViewState::kCrowded;
  if (ok) return ViewState::kClear;
  return result.state == msg::TrackingState::kDoubtful ? ViewState::kContradicted : ViewState::kUnknown;
}

constexpr double kNsPerS = 1e9;
constexpr double kUnknown = 1e6;        // a variance, m2 and rad2: receivers take no message with numbers that are none
constexpr double kByDefinition = 1e-8;  // m2 and rad2: the first pose of a map; filters refuse a covariance of zeros

using geometry::RowMajor6d;

/// Covariance of a motion between two poses of known covariance, per second, in the camera frame.
RowMajor6d twist_covariance(const OdometryPose& pose, const OdometryPose& previous, double gap_s) {
  const RowMajor6d sum = Eigen::Map<const RowMajor6d>(pose.result.covariance.data()) +
                         Eigen::Map<const RowMajor6d>(previous.result.covariance.data());
  const RowMajor6d turn = geometry::block_rotation(pose.T_odom_camera.linear().transpose());
  return turn * sum * turn.transpose() / (gap_s * gap_s);
}

RowMajor6d known_covariance(const FrameResult& result) {
  if (!msg::has_pose(result.state) || !result.covariance.allFinite()) return kUnknown * RowMajor6d::Identity();
  if (result.covariance.isZero(0)) return kByDefinition * RowMajor6d::Identity();
  return result.covariance;
}

std::string text(double value) {
  std::string digits = std::to_string(value);
  return digits.substr(0, digits.find('.') + 3);
}

}  // namespace

const char* to_string(ViewState view) {
  switch (view) {
    case ViewState::kClear:
      return "clear";
    case ViewState::kCrowded:
      return "crowded";
    case ViewState::kContradicted:
      return "contradicted";
    case ViewState::kBlind:
      return "blind";
    case ViewState::kUnknown:
      break;
  }
  return "unknown";
}

/// Single frames scatter.
double TrustMonitor::follow_view(const msg::TrackingResult& result) {
  constexpr double kMemory_s = 0.5;
  const double elapsed_s = last_ns_ ? msg::minus_s(result.stamp_ns, *last_ns_) : 1e9;
  last_ns_ = result.stamp_ns;
  view_removed_ += (1 - std::exp(-std::max(elapsed_s, 0.0) / kMemory_s)) * (share_removed(result) - view_removed_);
  return view_removed_;
}

PoseTrust TrustMonitor::add(const msg::TrackingResult& result, double agreement) {
  constexpr double kHalfTurn_deg = 180;
  if (result.state == msg::TrackingState::kOk || !last_ok_ns_) last_ok_ns_ = result.stamp_ns;
  const Eigen::Map<const geometry::RowMajor6d> covariance(result.covariance.data());
  PoseTrust trust;
  trust.agreement = agreement;
  trust.view_removed = follow_view(result);
  trust.view = view_of(result, trust.view_removed);
  trust.since_ok_s = msg::minus_s(result.stamp_ns, *last_ok_ns_);
  trust.position_sigma_m = geometry::largest_sigma(covariance.topLeftCorner<3, 3>());
  trust.rotation_sigma_deg = std::min(
      kHalfTurn_deg, geometry::largest_sigma(covariance.bottomRightCorner<3, 3>()) * kHalfTurn_deg / std::numbers::pi);
  return trust;
}

WheelSample to_sample(const msg::Odometry& odometry) {
  constexpr std::size_t kForward = 0, kTurning = 35;  // places of the variances
  const auto& [p, q] = odometry.pose.pose;
  WheelSample sample;
  sample.stamp_ns = msg::to_ns(odometry.header.stamp);
  sample.T_odom_base.translation() << p.x, p.y, p.z;
  sample.T_odom_base.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  sample.speed_variance = odometry.twist.covariance[kForward];
  sample.turning_variance = odometry.twist.covariance[kTurning];
  return sample;
}

msg::TrackingResult make_result(const FrameResult& result) {
  msg::TrackingResult message{};
  message.seq = result.seq;
  message.stamp_ns = result.stamp_ns;
  message.T_world_camera = msg::to_message(result.T_world_camera);
  Eigen::Map<RowMajor6d>(message.covariance.data()) = known_covariance(result);
  message.event_count = result.event_count;
  message.state = result.state;
  message.inliers = result.inliers;
  message.features_static = result.features_static;
  message.features_removed = result.features_removed;
  message.keyframes = result.keyframes;
  message.landmarks = result.landmarks;
  message.map_id = result.map_id;
  message.maps = result.maps;
  message.stage_ms = result.stage_ms;
  return message;
}

std::vector<msg::KeyframeEvent> make_events(const SlamOutput& output) {
  std::vector<msg::KeyframeEvent> events;
  std::uint64_t index = output.result.event_count - output.changes.size();
  for (const KeyframeChange& change : output.changes) {
    events.push_back(
        {index++, change.frame_seq, change.stamp_ns, msg::to_message(change.T_world_camera), change.id, change.kind});
  }
  return events;
}

msg::Pose to_pose(const msg::Transform& T) {
  const auto& [x, y, z] = T.translation_m;
  const auto& [qx, qy, qz, qw] = T.rotation_xyzw;
  return {{x, y, z}, {qx, qy, qz, qw}};
}

msg::TransformStamped make_transform(std::int64_t stamp_ns, const std::string& parent, const std::string& child,
                                     const msg::Transform& T_parent_child) {
  const msg::Pose pose = to_pose(T_parent_child);
  return {
      {msg::to_time(stamp_ns), parent}, child, {{pose.position.x, pose.position.y, pose.position.z}, pose.orientation}};
}

msg::PoseStamped make_pose(const msg::TrackingResult& result, const FrameNames& names) {
  return {{msg::to_time(result.stamp_ns), names.map}, to_pose(result.T_world_camera)};
}

msg::TFMessage make_tf(const OdometryPose& odometry, const Eigen::Isometry3d& T_map_odom, const FrameNames& names) {
  const msg::TrackingResult& result = odometry.result;
  return {{make_transform(result.stamp_ns, names.map, names.odom, msg::to_message(T_map_odom)),
           make_transform(result.stamp_ns, names.odom, names.camera, result.T_world_camera)}};
}

msg::TransformStamped make_jump(const Eigen::Isometry3d& T_now_before, bool same_map, std::int64_t stamp_ns,
                                const FrameNames& names) {
  return make_transform(stamp_ns, names.map, same_map ? names.map : names.previous_map, msg::to_message(T_now_before));
}

OdometryPose to_odometry_frame(const msg::TrackingResult& result, const Eigen::Isometry3d& T_map_odom) {
  const Eigen::Isometry3d T_map_camera = msg::to_isometry(result.T_world_camera);
  if (T_map_odom.matrix().isIdentity(0)) return {result, T_map_camera};  // to the last bit
  msg::TrackingResult moved = result;
  moved.T_world_camera = msg::to_message(T_map_odom.inverse() * T_map_camera);
  const RowMajor6d turn = geometry::block_rotation(T_map_odom.linear().transpose());
  Eigen::Map<RowMajor6d>(moved.covariance.data()) =
      turn * Eigen::Map<const RowMajor6d>(result.covariance.data()) * turn.transpose();
  return {moved, msg::to_isometry(moved.T_world_camera)};
}

msg::Odometry make_odometry(const OdometryPose& pose, const std::optional<OdometryPose>& previous,
                            const FrameNames& names) {
  const msg::TrackingResult& result = pose.result;
  msg::Odometry odometry;
  odometry.header = {msg::to_time(result.stamp_ns), names.odom};
  odometry.child_frame_id = names.camera;
  odometry.pose = {to_pose(result.T_world_camera), result.covariance};
  Eigen::Map<RowMajor6d> variances(odometry.twist.covariance.data());
  variances = kUnknown * RowMajor6d::Identity();
  if (!previous || previous->result.stamp_ns >= result.stamp_ns) return odometry;
  const double gap_s = static_cast<double>(msg::minus_ns(result.stamp_ns, previous->result.stamp_ns)) / kNsPerS;
  const Eigen::Isometry3d T_previous_camera = previous->T_odom_camera.inverse() * pose.T_odom_camera;
  const geometry::Vector6d twist = geometry::se3_log(T_previous_camera) / gap_s;
  odometry.twist.twist = {{twist[0], twist[1], twist[2]}, {twist[3], twist[4], twist[5]}};
  variances = twist_covariance(pose, *previous, gap_s);
  return odometry;
}

msg::Path make_path(const std::deque<msg::PoseStamped>& poses) {
  constexpr std::size_t kMost = 30'000;  // 4 MB at most
  msg::Path path{poses.back().header, vision::thin_out(std::vector(poses.begin(), poses.end()), kMost)};
  path.poses.back() = poses.back();
  return path;
}

msg::PointCloud2 make_cloud(const std::vector<MapPoint>& points, std::int64_t stamp_ns, const std::string& map_frame) {
  constexpr std::size_t kMost = 1'000'000;  // 16 MB
  std::vector<msg::CloudSlot> slots;
  slots.reserve(points.size());
  for (const MapPoint& point : points)
    slots.push_back({point.position.x(), point.position.y(), point.position.z(), point.static_probability});
  return msg::make_cloud(vision::thin_out(std::move(slots), kMost), "intensity", stamp_ns, map_frame);
}

msg::DiagnosticArray make_diagnostics(const msg::TrackingResult& result, const PoseTrust& trust,
                                      const SlamCounters& counters, const std::string& trouble, std::int64_t stamp_ns) {
  constexpr std::uint8_t kOk = 0, kWarn = 1, kError = 2;
  msg::DiagnosticStatus status;
  status.name = "rtd-slam: tracking";
  status.level = result.state == msg::TrackingState::kLost ? kError : (trouble.empty() ? kOk : kWarn);
  status.message = trouble.empty() ? to_string(result.state) : trouble;
  status.values = {{"state", to_string(result.state)},
                   {"inliers", std::to_string(result.inliers)},
                   {"view", to_string(trust.view)},
                   {"agreement", text(trust.agreement)},
                   {"view_removed", text(trust.view_removed)},
                   {"since_ok_s", text(trust.since_ok_s)},
                   {"position_sigma_m", std::to_string(trust.position_sigma_m)},
                   {"rotation_sigma_deg", std::to_string(trust.rotation_sigma_deg)},
                   {"keyframes", std::to_string(result.keyframes)},
                   {"landmarks", std::to_string(result.landmarks)},
                   {"map", std::to_string(result.map_id)},
                   {"maps", std::to_string(result.maps)},
                   {"frames", std::to_string(counters.frames)},
                   {"frames_tracked", std::to_string(counters.tracked)},
                   {"frames_doubtful", std::to_string(counters.doubtful)},
                   {"frames_dropped", std::to_string(counters.dropped)},
                   {"frames_duplicate", std::to_string(counters.duplicates)},
                   {"frames_unusable", std::to_string(counters.unusable_frames)},
                   {"features_invalid", std::to_string(counters.invalid_features)},
                   {"source_restarts", std::to_string(counters.source_restarts)},
                   {"loops_closed", std::to_string(counters.loops)},
                   {"slam_ms", text(static_cast<double>(result.stage_ms[msg::kStageSlamTotal]))}};
  return {{msg::to_time(stamp_ns), ""}, {status}};
}

}  // namespace rtd::slam
