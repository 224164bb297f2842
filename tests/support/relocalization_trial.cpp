// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/relocalization_trial.hpp"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <thread>

#include "common/camera/open/source_factory.hpp"
#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/service/monotonic_clock.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

constexpr std::int64_t kPeriodNs = 33'333'333;
constexpr double kWrong_m = 0.10, kWrong_deg = 5;

/// Feeds frames at 30 a second, whatever stamps they had.
class Player {
 public:
  Player(const slam::SlamConfig& config, slam::MappingMode mode)
      : slam_(config, mode, service::monotonic_ns), threaded_(mode == slam::MappingMode::kThreaded) {}
  slam::FrameResult play(const msg::FeatureFrame& frame) {
    auto copy = std::make_unique<msg::FeatureFrame>(frame);
    copy->seq = next_;
    copy->stamp_ns = 1'000'000'000 + static_cast<std::int64_t>(next_++) * kPeriodNs;
    const std::int64_t start_ns = service::monotonic_ns();
    const slam::SlamOutput output = slam_.process(*copy);
    if (threaded_) {  // as the camera would: the mapper has the rest of the period
      std::this_thread::sleep_for(std::chrono::nanoseconds(kPeriodNs - (service::monotonic_ns() - start_ns)));
    }
    return output.result;
  }

 private:
  slam::SlamSystem slam_;
  bool threaded_;
  std::uint64_t next_ = 0;
};

/// The truth at a moment, between its two nearest poses.
std::optional<Eigen::Isometry3d> true_pose(std::int64_t stamp_ns, const geometry::Trajectory& truth) {
  constexpr std::int64_t kMaxGapNs = 50'000'000;
  const auto after = std::lower_bound(truth.begin(), truth.end(), stamp_ns,
                                      [](const auto& pose, std::int64_t stamp) { return pose.stamp_ns < stamp; });
  if (after == truth.begin() || after == truth.end()) return std::nullopt;
  const auto before = std::prev(after);
  if (after->stamp_ns - before->stamp_ns > kMaxGapNs) return std::nullopt;
  const double share =
      static_cast<double>(stamp_ns - before->stamp_ns) / static_cast<double>(after->stamp_ns - before->stamp_ns);
  const Eigen::Isometry3d way = before->T_world_body.inverse() * after->T_world_body;
  return before->T_world_body * geometry::se3_exp(share * geometry::se3_log(way));
}

}  // namespace

FeatureClip record_features(const std::string& source_uri, std::size_t first, std::size_t count, bool masks,
                            double truth_offset_s) {
  const auto offset_ns = static_cast<std::int64_t>(truth_offset_s * 1e9);
  const auto source = camera::make_source(source_uri);
  const auto front_end = make_front_end({.mode = masks ? "true-mask" : "off"});
  FeatureClip clip;
  std::optional<camera::SourceFrame> frame;
  for (std::size_t i = 0; i < first + count && (frame = source->next()); ++i) {
    if (i < first) continue;
    clip.frames.push_back(make_feature_frame(frame->image, front_end->process(*frame).features));
    clip.T_world_camera.push_back(frame->T_world_camera
                                      ? frame->T_world_camera
                                      : true_pose(frame->image.stamp_ns + offset_ns, source->groundtruth()));
  }
  return clip;
}

WorldAlignment::WorldAlignment(const std::vector<PosePair>& pairs) {
  Eigen::Matrix3Xd estimate(3, pairs.size()), truth(3, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    estimate.col(static_cast<Eigen::Index>(i)) = pairs[i].estimate.translation();
    truth.col(static_cast<Eigen::Index>(i)) = pairs[i].truth.translation();
  }
  positions_ = eval::align(estimate, truth, eval::AlignmentKind::kRigid);
  R_truth_estimate_ = positions_.T_groundtruth_estimate.linear();
  constexpr int kIterations = 20;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Affine3d body = Eigen::Affine3d::Identity(), world = Eigen::Affine3d::Identity();
    body.linear().setZero();
    world.linear().setZero();
    for (const PosePair& pair : pairs) {
      body.linear() += (R_truth_estimate_ * pair.estimate.linear()).transpose() * pair.truth.linear();
    }
    R_camera_body_ = body.rotation();
    for (const PosePair& pair : pairs) {
      world.linear() += pair.truth.linear() * (pair.estimate.linear() * R_camera_body_).transpose();
    }
    R_truth_estimate_ = world.rotation();
  }
}

double WorldAlignment::error_m(const PosePair& pair) const {
  return (positions_ * pair.estimate.translation() - pair.truth.translation()).norm();
}

double WorldAlignment::error_deg(const PosePair& pair) const {
  const Eigen::AngleAxisd error(R_truth_estimate_ * pair.estimate.linear() * R_camera_body_ *
                                pair.truth.linear().transpose());
  return error.angle() * 180 / std::numbers::pi;
}

WorldAlignment align_worlds(const FeatureClip& clip, const slam::SlamConfig& config) {
  Player player(config, slam::MappingMode::kSynchronous);
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < clip.frames.size(); ++i) {
    const slam::FrameResult result = player.play(*clip.frames[i]);
    if (result.state != msg::TrackingState::kOk || !clip.T_world_camera[i]) continue;
    pairs.push_back({result.T_world_camera, *clip.T_world_camera[i]});
  }
  return WorldAlignment(pairs);
}

RelocalizationOutcome run_relocalization(const FeatureClip& mapped, const FeatureClip& again,
                                         const WorldAlignment& alignment, const RelocalizationTrial& trial,
                                         const slam::SlamConfig& config, slam::MappingMode mode) {
  Player player(config, mode);
  for (std::size_t i = 0; i < trial.mapped && i < mapped.frames.size(); ++i) player.play(*mapped.frames[i]);
  auto covered = std::make_unique<msg::FeatureFrame>(*mapped.frames.front());
  covered->count = 0;
  RelocalizationOutcome outcome;
  for (std::size_t i = 0; i < trial.covered; ++i) player.play(*covered);
  for (std::size_t i = trial.resume; i < std::min(trial.resume + trial.length, again.frames.size()); ++i) {
    const slam::FrameResult result = player.play(*again.frames[i]);
    outcome.maps = std::max<std::size_t>(outcome.maps, result.maps);
    outcome.worst_ms = std::max(outcome.worst_ms, static_cast<double>(result.stage_ms[msg::kStageSlamTotal]));
    outcome.worst_search_ms =
        std::max(outcome.worst_search_ms, static_cast<double>(result.stage_ms[msg::kStageRelocalize]));
    if (trial.on_frame && !msg::has_pose(result.state)) trial.on_frame(result, 0, 0);
    if (!msg::has_pose(result.state) || !again.T_world_camera[i]) continue;
    const PosePair pair{result.T_world_camera, *again.T_world_camera[i]};
    const double error_m = alignment.error_m(pair), error_deg = alignment.error_deg(pair);
    if (trial.on_frame) trial.on_frame(result, error_m, error_deg);
    if (result.map_id != 0 || error_m > kWrong_m || error_deg > kWrong_deg) ++outcome.wrong;
    if (result.state != msg::TrackingState::kOk) continue;
    if (!outcome.found) {
      outcome.found = true;
      outcome.after_s = static_cast<double>(i - trial.resume) * kPeriodNs * 1e-9;
      outcome.error_m = error_m;
      outcome.error_deg = error_deg;
    }
    outcome.worst_error_m = std::max(outcome.worst_error_m, error_m);
    outcome.worst_error_deg = std::max(outcome.worst_error_deg, error_deg);
  }
  return outcome;
}

}  // namespace rtd::test_support
