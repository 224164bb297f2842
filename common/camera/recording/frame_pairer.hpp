// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "common/camera/frame_source.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/vision/depth_registration.hpp"

namespace rtd::camera {

/// A message and the stamp in its header.
struct StampedMessage {
  std::int64_t stamp_ns = 0;
  RecordedMessage message;
};

/// Pairs colour with depth images of a stream as the lists of a TUM folder are paired (geometry::associate()): closest
/// first, within the tolerance, each depth image once. It decides on a colour image when everything recorded within
/// kLookaheadNs after it has been seen, and so holds a few frames only; of a running camera, whose images come in
/// order, already when a depth image as new as the colour image has come.
class FramePairer {
 public:
  static constexpr std::int64_t kLookaheadNs = 300'000'000;
  static constexpr std::size_t kMaxPending = 64;

  struct Options {
    std::int64_t tolerance_ns = kPairingToleranceNs;
    bool at_once = false;  ///< a running camera's
  };
  struct Pair {
    StampedMessage color, depth;
  };

  FramePairer() = default;
  explicit FramePairer(const Options& options) : options_(options) {}

  /// A colour image that is not newer than the one before is left out and counted, as a repeat if it is the same.
  void add_color(StampedMessage color, SkipLog& skips);
  void add_depth(StampedMessage depth);
  /// Nothing more comes: what is left is decided.
  void finish() { finished_ = true; }
  /// The next pair; empty when more must be seen first. Colour without depth is left out and counted.
  std::optional<Pair> next(SkipLog& skips);

 private:
  bool decided() const;
  std::optional<std::size_t> partner_of_front() const;
  void forget_before(std::int64_t stamp_ns);
  void forget_oldest();

  const Options options_;
  std::deque<StampedMessage> colors_, depths_;  ///< by stamp
  std::optional<std::int64_t> last_color_ns_;
  std::size_t last_color_print_ = 0;
  std::uint64_t depth_alone_ = 0;  ///< not counted yet
  std::int64_t newest_recorded_ns_ = 0;
  bool finished_ = false;
};

/// "the stamps on TOPIC are all 0 ...": a remark; `instead` is what takes their place.
std::string no_stamps(const std::string& topic, const std::string& instead);

/// The frame that a pair makes, 16-bit grey of so many bits, depth in floats rounded to float_unit_m, then registered
/// unless it is already; empty, and counted, when it cannot be decoded or its sizes do not fit.
std::optional<SourceFrame> decode_pair(const FramePairer::Pair& pair, int grey_bits, double float_unit_m,
                                       const SourceInfo& info,
                                       const std::optional<vision::DepthRegistration>& registration, SkipLog& skips);

}  // namespace rtd::camera
