// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/left_out.hpp"

#include <algorithm>
#include <cmath>

#include "common/service/metric_names.hpp"

namespace rtd::camera {
namespace {

constexpr double kNearestUsed_m = 0.1, kFarthestUsed_m = 20;  // whatever filter and slam are configured to
constexpr int kStep_px = 8;                                   // between two pixels that are looked at

bool has_depth_in_range(const vision::RgbdImage& image) {
  for (int v = 0; v < image.depth.rows; v += kStep_px) {
    for (int u = 0; u < image.depth.cols; u += kStep_px) {
      const double depth_m = image.depth.at<std::uint16_t>(v, u) * image.depth_scale_m;
      if (depth_m >= kNearestUsed_m && depth_m <= kFarthestUsed_m) return true;
    }
  }
  return false;
}

}  // namespace

void LeftOut::open(std::uint64_t all, std::uint64_t most, const SourceCounters& at_opening) {
  all_ = all;
  most_ = most;
  at_opening_ = passed_ = now_ = at_opening;
}

void LeftOut::resume(std::uint64_t frames, const SourceCounters& passed) {
  before_ = frames;
  passed_ = now_ = passed;
}

void LeftOut::add(const ReadItem& item) {
  now_ = item.counters;
  ended_ = !item.frame;
  if (first_.empty() && !item.skipped.empty()) first_ = item.skipped.front().detail;
}

void LeftOut::add(const vision::RgbdImage& image) {
  if (!has_depth_in_range(image)) ++out_of_range_;
}

SourceCounters LeftOut::counters(std::uint64_t frames_in) const {
  const bool whole = all_ == 0 || (ended_ && (most_ == 0 || frames_in < most_));
  const auto part = [this](std::uint64_t frames) {
    return all_ == 0 ? 0 : std::min(1.0, static_cast<double>(frames) / static_cast<double>(all_));
  };
  const double end = whole ? 1 : part(frames_in), begin = part(before_);
  const auto met = [=](std::uint64_t now, std::uint64_t passed, std::uint64_t then) {
    const auto listed = [then](double share) { return std::llround(static_cast<double>(then) * share); };
    return now - passed + static_cast<std::uint64_t>(std::max(0LL, listed(end) - listed(begin)));
  };
  SourceCounters counters = now_;
  for (std::size_t i = 0; i < kSkipReasons; ++i)
    counters.skipped.at(i) = met(now_.skipped.at(i), passed_.skipped.at(i), at_opening_.skipped.at(i));
  counters.depth_alone = met(now_.depth_alone, passed_.depth_alone, at_opening_.depth_alone);
  return counters;
}

std::map<std::string, std::uint64_t> LeftOut::metrics(std::uint64_t frames_in) const {
  const SourceCounters out = counters(frames_in);
  std::map<std::string, std::uint64_t> metrics{{service::metric::kFramesLeftOut, out.frames_left_out()},
                                               {service::metric::kFramesOutOfRange, out_of_range_}};
  for (std::size_t i = 0; i < kSkipReasons; ++i) {
    const char* const reason = to_string(static_cast<SkipReason>(i));
    if (out.skipped.at(i) > 0) metrics[service::metric::kLeftOutPrefix + std::string(reason)] = out.skipped.at(i);
  }
  return metrics;
}

}  // namespace rtd::camera
