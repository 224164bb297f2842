// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace rtd::camera {

/// How far the stamps of depth and colour lie apart in the newest frames.
class DepthOffsets {
 public:
  static constexpr std::size_t kNewest = 301;

  void add(std::int64_t depth_after_color_ns) {
    offsets_ns_.push_back(depth_after_color_ns);
    if (offsets_ns_.size() > kNewest) offsets_ns_.pop_front();
  }
  std::size_t size() const { return offsets_ns_.size(); }
  /// Depth minus colour, ms; empty without frames.
  std::optional<double> median_ms() const {
    if (offsets_ns_.empty()) return std::nullopt;
    std::vector<std::int64_t> sorted(offsets_ns_.begin(), offsets_ns_.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    return static_cast<double>(*middle) * 1e-6;
  }

 private:
  std::deque<std::int64_t> offsets_ns_;
};

/// How far away a source's depth is, to within 2 %, and whether its unit can be right. Not thread-safe.
class DepthFigures {
 public:
  /// Every eighth pixel of every eighth row of a CV_16UC1 image; `scale_m`: metres of a unit, the same for all images.
  void add(const cv::Mat& depth, double scale_m);

  /// Depth below which this share of the measured pixels lies, m; empty without any.
  std::optional<double> quantile_m(double share) const;
  std::optional<double> median_m() const { return quantile_m(0.5); }
  /// Share of the pixels without a measurement; 0 without any pixel.
  double hole_share() const;

  /// Why the unit is doubtful and which one is likely; empty when it is not: nearly all is nearer than 0.5 m, or
  /// farther than 13 m. `given`: a file or parameter gave the unit; otherwise it is enough that another one is more
  /// likely.
  std::string doubt(bool given) const;

 private:
  static constexpr double kBinsPerOctave = 48;
  static constexpr std::size_t kBins = 16 * 48 + 1;

  std::array<std::uint64_t, kBins> measured_{};  ///< by the logarithm of the units
  std::uint64_t eighths_ = 0, odd_eighths_ = 0;  ///< measured multiples of 8, and those not of 16
  std::uint64_t pixels_ = 0, holes_ = 0;
  double scale_m_ = 0;
};

/// Whether 16-bit depth is rotated left by three bits, (d << 3) | (d >> 13), as SUN3D stores millimetres and Kinect's
/// SDK leaves room for a player: the low three bits of nearly all values are 0, and as millimetres they would be far.
bool is_rotated(const cv::Mat& depth);
/// Undoes it.
void rotate_back(cv::Mat& depth);

/// The value below which this share of the positive, finite values lies; 0 without any. CV_32FC1.
double float_quantile(const cv::Mat& values, double share);

/// Whether floats are millimetres, not metres: nine tenths of them are beyond 100.
bool floats_are_millimetres(const cv::Mat& values);

}  // namespace rtd::camera
