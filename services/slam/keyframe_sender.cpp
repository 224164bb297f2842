// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/keyframe_sender.hpp"

#include <chrono>

#include "common/concurrency/thread_priority.hpp"

namespace rtd::slam {
namespace {

msg::KeyframeFeature make_feature(const msg::Feature& f) {
  return {f.u_px, f.v_px, f.depth_m, f.angle_rad, msg::kNoId, f.static_probability, f.octave, f.flags, f.descriptor};
}

bool on_person(const msg::Feature& feature) {
  return (feature.flags & msg::kFeatureInHighMask) != 0;
}

msg::KeyframeFeatures make_head(const Frame& frame) {
  msg::KeyframeFeatures message;
  message.stamp_ns = frame.stamp_ns;
  message.intrinsics = {frame.camera.fx, frame.camera.fy, frame.camera.cx, frame.camera.cy};
  message.disparity_px_m = frame.camera.disparity_px_m;
  message.readout_s = frame.readout_s;
  message.width = static_cast<std::uint32_t>(frame.width_px);
  message.height = static_cast<std::uint32_t>(frame.height_px);
  message.features.reserve(frame.features.size());
  return message;
}

bool rests(const Landmark& landmark, bool witnesses) {
  constexpr std::size_t kEnoughViews = 3;
  return has_measured_depth(landmark) && (witnesses ? landmark.witness : landmark.observations.size() >= kEnoughViews);
}

std::chrono::nanoseconds time_of(const msg::KeyframeFeatures& message, int bytes_per_s) {
  constexpr double kHeadBytes = 96, kFeatureBytes = 60;  // on the wire
  const double bytes = kHeadBytes + kFeatureBytes * static_cast<double>(message.features.size());
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * bytes / bytes_per_s));
}

}  // namespace

msg::KeyframeFeatures make_features(const Frame& frame) {
  msg::KeyframeFeatures message = make_head(frame);
  for (const msg::Feature& feature : frame.features) {
    if (!on_person(feature)) message.features.push_back(make_feature(feature));
  }
  return message;
}

msg::KeyframeFeatures make_features(const Map& map, const Keyframe& keyframe, bool witnesses) {
  msg::KeyframeFeatures message = make_head(*keyframe.frame);
  message.keyframe_id = keyframe.id;
  const Eigen::Isometry3d T_camera_world = keyframe.T_world_camera.inverse();
  for (std::size_t i = 0; i < keyframe.frame->features.size(); ++i) {
    if (on_person(keyframe.frame->features[i])) continue;
    msg::KeyframeFeature& feature = message.features.emplace_back(make_feature(keyframe.frame->features[i]));
    const LandmarkId id = keyframe.landmarks[i];
    const Landmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark == nullptr || !rests(*landmark, witnesses)) continue;
    const auto depth_m = static_cast<float>((T_camera_world * landmark->position).z());
    if (!(depth_m > 0)) continue;
    feature.landmark_id = id;
    feature.depth_m = depth_m;
  }
  return message;
}

KeyframeSender::KeyframeSender(bus::Bus& bus, const ServiceConfig& config, const SlamSystem& slam,
                               const MapPublisher& publisher)
    : config_(config.atlas),
      witnesses_(config.core.witness.used),
      slam_(slam),
      publisher_(publisher),
      requests_(std::make_shared<Requests>(1, concurrency::Overflow::kDropOldest)),
      writer_(bus.writer(bus::topics::kKeyframeFeatures)) {
  thread_ = std::thread([this] { loop(); });
  reader_ = bus.reader<msg::KeyframeRequest>(
      bus::topics::kKeyframeRequest, [requests = requests_](std::shared_ptr<const msg::KeyframeRequest> request) {
        requests->push(std::move(request));
      });
}

KeyframeSender::~KeyframeSender() {
  requests_->close();
  thread_.join();
}

void KeyframeSender::send(msg::KeyframeFeatures features) {
  features.session_ns = publisher_.session().session_ns;
  writer_.write(features);
}

void KeyframeSender::loop() {
  using Time = std::chrono::steady_clock;
  constexpr int kNicer = 5;  // as the mapper: what holds the map must not wait for less urgent work
  concurrency::lower_thread_priority(kNicer);
  std::shared_ptr<const msg::KeyframeRequest> request;
  std::span<const std::uint32_t> ids;  // of it, still to be sent
  Time::time_point allowed_at = Time::now();
  while (!requests_->closed()) {
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(allowed_at - Time::now());
    if (auto newest = ids.empty() ? requests_->pop() : requests_->pop_for(wait)) {
      request = *std::move(newest);
      ids = request->keyframe_ids;
    } else if (!ids.empty() && !requests_->closed()) {
      const std::optional<msg::KeyframeFeatures> features = next(request->session_ns, ids);
      if (!features) continue;
      writer_.write(*features);
      allowed_at = Time::now() + time_of(*features, config_.bytes_per_s);
    }
  }
}

/// Of the first of `ids` that the map has, which goes with all before it.
std::optional<msg::KeyframeFeatures> KeyframeSender::next(std::int64_t session_ns,
                                                          std::span<const std::uint32_t>& ids) const {
  const MapPublisher::Session session = publisher_.session();
  return slam_.read_map([&](const Map& map) -> std::optional<msg::KeyframeFeatures> {
    const bool present = session.session_ns == session_ns && session.map == slam_.map_session();
    const Keyframe* keyframe = nullptr;
    for (; keyframe == nullptr && !ids.empty(); ids = ids.subspan(1))
      keyframe = present ? map.find_keyframe(ids.front()) : nullptr;
    if (keyframe == nullptr) return std::nullopt;
    msg::KeyframeFeatures features = make_features(map, *keyframe, witnesses_);
    features.session_ns = session_ns;
    return features;
  });
}

}  // namespace rtd::slam
