// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/live/device_health.hpp"

#include <fmt/format.h>

#include <functional>
#include <string_view>

namespace rtd::camera {
namespace {

constexpr std::int64_t kFaultNs = 1'000'000'000;       // what lasts as long is reported
constexpr std::int64_t kRateWindowNs = 2'000'000'000;  // frames are counted over
constexpr double kRateShare = 0.75;                    // of the nominal rate

}  // namespace

void DeviceHealth::restart(std::int64_t now_ns, double fps) {
  *this = {};
  fps_ = fps;
  started_ns_ = color_changed_ns_ = depth_seen_ns_ = now_ns;
}

void DeviceHealth::note_color(std::int64_t now_ns, const std::vector<std::uint8_t>& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t hash = std::hash<std::string_view>{}(text);
  if (color_hash_ && *color_hash_ == hash) return;
  color_hash_ = hash;
  color_changed_ns_ = now_ns;
}

void DeviceHealth::note_frame(std::int64_t now_ns, bool has_depth) {
  if (has_depth) depth_seen_ns_ = now_ns;
  frames_ns_.push_back(now_ns);
  while (frames_ns_.front() <= now_ns - kRateWindowNs) frames_ns_.pop_front();
}

bool DeviceHealth::frozen(std::int64_t now_ns) const {
  return color_hash_ && now_ns - color_changed_ns_ >= kFaultNs;
}

std::string DeviceHealth::fault(std::int64_t now_ns) const {
  if (frozen(now_ns)) {
    return fmt::format(
        "the colour image has been the same to the bit for {:.1f} s, and its frames are left out: unplug the camera "
        "and plug it in again",
        static_cast<double>(now_ns - color_changed_ns_) * 1e-9);
  }
  if (now_ns - depth_seen_ns_ >= kFaultNs && !frames_ns_.empty()) {
    return fmt::format(
        "no pixel of the depth image has had a measurement for {:.1f} s: is the sensor covered, too close to "
        "everything (0.4 m), in sunlight, or its projector off?",
        static_cast<double>(now_ns - depth_seen_ns_) * 1e-9);
  }
  return lost_frames(now_ns);
}

std::string DeviceHealth::lost_frames(std::int64_t now_ns) const {
  if (fps_ <= 0 || now_ns - started_ns_ < kRateWindowNs || frames_ns_.empty()) return {};
  const double rate = static_cast<double>(frames_ns_.size()) / (static_cast<double>(kRateWindowNs) * 1e-9);
  if (rate >= kRateShare * fps_) return {};
  return fmt::format(
      "only {:.1f} of {:g} frames/s arrive: use a USB 3 port of its own, a smaller mode (?width=&height=&fps=), or "
      "more light (automatic exposure lowers the rate)",
      rate, fps_);
}

}  // namespace rtd::camera
