// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/image_input.hpp"

#include <utility>

#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::detector {
namespace {

constexpr std::int64_t kMatchingTakesNs = 500'000'000;  // a camera of this host is found and matched within this

}  // namespace

ImageInput::ImageInput(service::Runtime& runtime, const std::string& input, OnImage on_image)
    : runtime_(runtime),
      on_image_(std::move(on_image)),
      automatic_(input == "auto"),
      camera_(service::follow_source("camera", runtime.heartbeat.process_gone())) {
  if (input == "jpeg") {
    read_jpegs();
    return;
  }
  frames_ = bus::FrameReader(
      runtime.bus,
      [this](std::shared_ptr<const msg::FrameView> frame) {
        const std::int64_t stamp_ns = frame->stamp_ns;
        on_image_({stamp_ns, std::move(frame), nullptr});
      },
      camera_->callbacks());
}

void ImageInput::read_jpegs() {
  jpegs_ = runtime_.bus.reader<msg::CompressedImage>(
      bus::topics::kColorJpeg,
      [on_image = on_image_](std::shared_ptr<const msg::CompressedImage> jpeg) {
        const std::int64_t stamp_ns = msg::to_ns(jpeg->header.stamp);
        on_image({stamp_ns, nullptr, std::move(jpeg)});
      },
      camera_->callbacks());
}

/// A camera that is ready has its writers; so has the replay in its place.
bool ImageInput::camera_is_elsewhere() {
  if (!runtime_.heartbeat.ready("camera") && !runtime_.heartbeat.ready("replay")) {
    unmatched_since_ns_ = 0;
    return false;
  }
  const std::int64_t now_ns = service::monotonic_ns();
  if (unmatched_since_ns_ == 0) unmatched_since_ns_ = now_ns;
  return now_ns - unmatched_since_ns_ > kMatchingTakesNs;
}

void ImageInput::update() {
  const std::lock_guard lock(mutex_);
  if (!automatic_) return;
  if (frames_.matched() > 0) {
    unmatched_since_ns_ = 0;
    if (!jpegs_) return;
    jpegs_ = {};
    SPDLOG_INFO("event=input_chosen input=frame cause=\"the camera is on this host\"");
  } else if (!jpegs_ && camera_is_elsewhere()) {
    read_jpegs();
    SPDLOG_INFO("event=input_chosen input=jpeg cause=\"the camera is on another host\"");
  }
}

int ImageInput::matched() const {
  const std::lock_guard lock(mutex_);
  return (frames_ ? frames_.matched() : 0) + (jpegs_ ? jpegs_.matched() : 0);
}

}  // namespace rtd::detector
