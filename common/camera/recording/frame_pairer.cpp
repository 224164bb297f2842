// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/frame_pairer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/camera/depth_alignment.hpp"
#include "common/camera/recording/ros_images.hpp"

namespace rtd::camera {
namespace {

std::string place_of(const StampedMessage& color) {
  return color.message.topic + " at " + std::to_string(color.stamp_ns) + " ns";
}

/// Of the size and up to 4096 bytes, evenly spread: noise makes them differ from image to image. The first four are
/// ROS 1's count of the publisher, which a relay changes.
std::size_t fingerprint(const std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kSamples = 4096, kCount = 4;
  std::string samples = std::to_string(bytes.size());
  for (std::size_t i = kCount; i < bytes.size(); i += 1 + bytes.size() / kSamples)
    samples.push_back(static_cast<char>(bytes[i]));
  return std::hash<std::string>()(samples);
}

}  // namespace

void FramePairer::add_color(StampedMessage color, SkipLog& skips) {
  newest_recorded_ns_ = std::max(newest_recorded_ns_, color.message.recorded_ns);
  const std::size_t print = fingerprint(color.message.bytes), print_before = std::exchange(last_color_print_, print);
  if (last_color_ns_ && color.stamp_ns == *last_color_ns_) {
    if (print == print_before && color.stamp_ns != 0)
      return skips.add({SkipReason::kRepeated, place_of(color) + " is the frame before once more"});
    const char* const detail = color.stamp_ns == 0 ? ": the stamps are all 0, as of a driver that does not fill them"
                                                   : " has the stamp of the frame before";
    return skips.add({SkipReason::kStampDoubled, place_of(color) + detail});
  }
  if (last_color_ns_ && color.stamp_ns < *last_color_ns_) {
    return skips.add({SkipReason::kStampBackwards, place_of(color) + " is older than the frame before"});
  }
  last_color_ns_ = color.stamp_ns;
  colors_.push_back(std::move(color));
}

void FramePairer::add_depth(StampedMessage depth) {
  newest_recorded_ns_ = std::max(newest_recorded_ns_, depth.message.recorded_ns);
  const auto place =
      std::lower_bound(depths_.begin(), depths_.end(), depth.stamp_ns,
                       [](const StampedMessage& other, std::int64_t stamp_ns) { return other.stamp_ns < stamp_ns; });
  if (place != depths_.end() && place->stamp_ns == depth.stamp_ns) return;
  depths_.insert(place, std::move(depth));
  if (depths_.size() > kMaxPending) forget_oldest();
}

bool FramePairer::decided() const {
  const bool settled = options_.at_once && !depths_.empty() && depths_.back().stamp_ns >= colors_.front().stamp_ns;
  return settled || finished_ || colors_.size() > kMaxPending ||
         newest_recorded_ns_ - colors_.front().message.recorded_ns >= kLookaheadNs;
}

std::optional<std::size_t> FramePairer::partner_of_front() const {
  const std::vector<geometry::StampPair> pairs =
      geometry::associate(geometry::stamps_of(colors_), geometry::stamps_of(depths_), options_.tolerance_ns);
  if (pairs.empty() || pairs.front().first != 0) return std::nullopt;
  return pairs.front().second;
}

/// No colour image to come is as old.
void FramePairer::forget_before(std::int64_t stamp_ns) {
  while (!depths_.empty() && depths_.front().stamp_ns < stamp_ns) forget_oldest();
}

void FramePairer::forget_oldest() {
  depths_.pop_front();
  ++depth_alone_;
}

std::optional<FramePairer::Pair> FramePairer::next(SkipLog& skips) {
  if (finished_ && colors_.empty()) depth_alone_ += std::exchange(depths_, {}).size();
  skips.counters().depth_alone += std::exchange(depth_alone_, 0);
  while (!colors_.empty() && decided()) {
    const std::optional<std::size_t> partner = partner_of_front();
    StampedMessage color = std::move(colors_.front());
    colors_.pop_front();
    if (!partner) {
      skips.add({SkipReason::kNoDepthPartner, fmt::format("{} has no depth image within {:g} s", place_of(color),
                                                          static_cast<double>(options_.tolerance_ns) * 1e-9)});
      continue;
    }
    const auto place = depths_.begin() + static_cast<std::ptrdiff_t>(*partner);
    Pair pair{std::move(color), std::move(*place)};
    depths_.erase(place);
    forget_before(pair.color.stamp_ns - options_.tolerance_ns);
    return pair;
  }
  return std::nullopt;
}

std::string no_stamps(const std::string& topic, const std::string& instead) {
  return fmt::format("the stamps on {} are all 0, the driver does not fill header.stamp: {} are used", topic, instead);
}

std::optional<SourceFrame> decode_pair(const FramePairer::Pair& pair, int grey_bits, double float_unit_m,
                                       const SourceInfo& info,
                                       const std::optional<vision::DepthRegistration>& registration, SkipLog& skips) {
  ImageRead color = decode_color(pair.color.message, grey_bits);
  if (color.problem) {
    skips.add(*color.problem);
    return std::nullopt;
  }
  ImageRead depth = decode_depth(pair.depth.message, float_unit_m);
  if (depth.problem) {
    skips.add(*depth.problem);
    return std::nullopt;
  }
  if (registration && depth.image.size() == registration->depth_size()) depth.image = (*registration)(depth.image);
  if (!registration) depth.image = scaled_to(color.image.size(), depth.image);
  const auto mismatch = size_mismatch(name_of(pair.color.message), color.image, depth.image, info.camera);
  if (mismatch) {
    skips.add(*mismatch);
    return std::nullopt;
  }
  SourceFrame frame = to_frame(pair.color.stamp_ns, std::move(color.image), std::move(depth.image), info);
  set_depth_stamp(frame, pair.depth.stamp_ns, info);
  return frame;
}

}  // namespace rtd::camera
