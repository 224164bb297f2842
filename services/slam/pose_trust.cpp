// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/pose_trust.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/se3.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::slam {
namespace {

double share_removed(const msg::TrackingResult& result) {
  const double all = static_cast<double>(result.features_static) + result.features_removed;
  return all > 0 ? result.features_removed / all : 0;
}

View view_of(const msg::TrackingResult& result, double view_removed) {
  constexpr double kCrowded = 0.5;
  constexpr std::uint32_t kFewest = 100;  // features of an image that shows something
  const bool ok = result.state == msg::TrackingState::kOk;
  if (!ok && result.features_static + result.features_removed < kFewest) return View::kBlind;
  if (view_removed >= kCrowded) return View::kCrowded;
  if (ok) return View::kClear;
  return result.state == msg::TrackingState::kDoubtful ? View::kContradicted : View::kUnknown;
}

}  // namespace

const char* to_string(View view) {
  switch (view) {
    case View::kClear:
      return "clear";
    case View::kCrowded:
      return "crowded";
    case View::kContradicted:
      return "contradicted";
    case View::kBlind:
      return "blind";
    case View::kUnknown:
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

}  // namespace rtd::slam
