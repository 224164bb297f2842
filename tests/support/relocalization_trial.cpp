// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/relocalization_trial.hpp"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <thread>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/camera/core/source_factory.hpp"
#include "services/launcher/core/evaluation/alignment.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

constexpr std::int64_t kPeriodNs = 33'333'333;
constexpr double kWrong_m = 0.10, kWrong_deg = 5;

struct PosePair {
  Eigen::Isometry3d estimate, truth;  ///< T_world_camera, each in its own world
};

double angle_deg(const Eigen::Isometry3d& T) {
  return geometry::rotation_angle_rad(T) * 180 / std::numbers::pi;
}

/// Estimate and truth of the mapped part, and what follows from them for other poses.
class Comparison {
 public:
  void add(const PosePair& pair) { pairs_.push_back(pair); }
  void align() {
    Eigen::Matrix3Xd estimate(3, pairs_.size()), truth(3, pairs_.size());
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      estimate.col(static_cast<Eigen::Index>(i)) = pairs_[i].estimate.translation();
      truth.col(static_cast<Eigen::Index>(i)) = pairs_[i].truth.translation();
    }
    alignment_ = eval::align(estimate, truth, eval::AlignmentKind::kRigid);
  }
  double error_m(const PosePair& pair) const {
    return (alignment_ * pair.estimate.translation() - pair.truth.translation()).norm();
  }
  /// Against the turn from the nearest mapped pose: the truth's body need not be the camera's.
  double error_deg(const PosePair& pair) const {
    const auto nearest = std::min_element(pairs_.begin(), pairs_.end(), [&](const PosePair& a, const PosePair& b) {
      return angle_deg(a.truth.inverse() * pair.truth) < angle_deg(b.truth.inverse() * pair.truth);
    });
    return angle_deg((nearest->estimate.inverse() * pair.estimate).inverse() * (nearest->truth.inverse() * pair.truth));
  }

 private:
  std::vector<PosePair> pairs_;
  eval::Alignment alignment_;
};

/// Feeds frames at 30 a second, whatever stamps they had.
class Player {
 public:
  Player(const slam::SlamConfig& config, slam::MappingMode mode)
      : slam_(config, mode, service::monotonic_ns), threaded_(mode == slam::MappingMode::kThreaded) {}
  msg::TrackingResult play(const msg::FeatureFrame& frame) {
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

std::optional<Eigen::Isometry3d> true_pose(const camera::SourceFrame& frame,
                                           const std::vector<camera::StampedPose>& truth) {
  constexpr std::int64_t kMaxGapNs = 10'000'000;
  if (frame.T_world_camera) return frame.T_world_camera;
  const auto gap = [&](const camera::StampedPose& pose) { return std::abs(pose.stamp_ns - frame.image.stamp_ns); };
  const auto nearest =
      std::min_element(truth.begin(), truth.end(), [&](const auto& a, const auto& b) { return gap(a) < gap(b); });
  if (nearest == truth.end() || gap(*nearest) > kMaxGapNs) return std::nullopt;
  return nearest->T_world_camera;
}

}  // namespace

FeatureClip record_features(const std::string& source_uri, std::size_t first, std::size_t count, bool masks) {
  const auto source = camera::make_source(source_uri);
  const auto front_end = make_front_end({.mode = masks ? "true-mask" : "off"});
  FeatureClip clip;
  std::optional<camera::SourceFrame> frame;
  for (std::size_t i = 0; i < first + count && (frame = source->next()); ++i) {
    if (i < first) continue;
    clip.frames.push_back(make_feature_frame(frame->image, front_end->process(*frame).features));
    clip.T_world_camera.push_back(true_pose(*frame, source->groundtruth()));
  }
  return clip;
}

RelocalizationOutcome run_relocalization(const FeatureClip& mapped, const FeatureClip& again,
                                         const RelocalizationTrial& trial, const slam::SlamConfig& config,
                                         slam::MappingMode mode) {
  Player player(config, mode);
  Comparison comparison;
  for (std::size_t i = 0; i < trial.mapped && i < mapped.frames.size(); ++i) {
    const msg::TrackingResult result = player.play(*mapped.frames[i]);
    if (result.state != msg::TrackingState::kOk || !mapped.T_world_camera[i]) continue;
    comparison.add({msg::to_isometry(result.T_world_camera), *mapped.T_world_camera[i]});
  }
  comparison.align();
  auto covered = std::make_unique<msg::FeatureFrame>(*mapped.frames.front());
  covered->count = 0;
  RelocalizationOutcome outcome;
  for (std::size_t i = 0; i < trial.covered; ++i) player.play(*covered);
  for (std::size_t i = trial.resume; i < std::min(trial.resume + trial.length, again.frames.size()); ++i) {
    const msg::TrackingResult result = player.play(*again.frames[i]);
    outcome.maps = std::max<std::size_t>(outcome.maps, result.maps);
    outcome.worst_ms = std::max(outcome.worst_ms, static_cast<double>(result.stage_ms[msg::kStageSlamTotal]));
    outcome.worst_search_ms =
        std::max(outcome.worst_search_ms, static_cast<double>(result.stage_ms[msg::kStageRelocalize]));
    if (trial.on_frame && !msg::has_pose(result.state)) trial.on_frame(result, 0, 0);
    if (!msg::has_pose(result.state) || !again.T_world_camera[i]) continue;
    const PosePair pair{msg::to_isometry(result.T_world_camera), *again.T_world_camera[i]};
    const double error_m = comparison.error_m(pair), error_deg = comparison.error_deg(pair);
    if (trial.on_frame) trial.on_frame(result, error_m, error_deg);
    if (result.map_id != 0 || error_m > kWrong_m || error_deg > kWrong_deg) ++outcome.wrong;
    if (result.state != msg::TrackingState::kOk) continue;
    if (!outcome.found) {
      outcome.found = true;
      outcome.after_s = static_cast<double>(i - trial.resume) * kPeriodNs * 1e-9;
      outcome.error_m = error_m, outcome.error_deg = error_deg;
    }
    outcome.worst_error_m = std::max(outcome.worst_error_m, error_m);
    outcome.worst_error_deg = std::max(outcome.worst_error_deg, error_deg);
  }
  return outcome;
}

}  // namespace rtd::test_support
