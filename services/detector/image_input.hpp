// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "common/bus/frame_topics.hpp"
#include "common/service/runtime.hpp"
#include "common/service/topic_source.hpp"

namespace rtd::detector {

/// An image as it came; the pixels are decoded by the worker.
struct Arrival {
  std::int64_t stamp_ns = 0;
  std::shared_ptr<const msg::FrameView> frame;       ///< raw, of this host
  std::shared_ptr<const msg::CompressedImage> jpeg;  ///< of any host
};

/// Where the images come from. Input "frame": shared memory; "jpeg": the network. "auto": raw frames, which never leave
/// their host; a camera without raw frames here is on another host, and its JPEGs are
/// subscribed to, which the camera encodes only then. Thread-safe.
class ImageInput {
 public:
  using OnImage = std::function<void(Arrival)>;
  ImageInput(service::Runtime& runtime, const std::string& input, OnImage on_image);

  /// Checks again where the camera is; to be called regularly.
  void update();
  /// Number of cameras matched.
  int matched() const;

 private:
  void read_jpegs();
  bool camera_is_elsewhere();

  service::Runtime& runtime_;
  const OnImage on_image_;
  const bool automatic_;
  mutable std::mutex mutex_;
  std::int64_t unmatched_since_ns_ = 0;  ///< since when a camera is known without raw frames here; 0: there is none
  const std::shared_ptr<bus::SourceGate> camera_;  ///< of both: a camera writes either
  bus::FrameReader frames_;
  bus::Reader<msg::CompressedImage> jpegs_;
};

}  // namespace rtd::detector
