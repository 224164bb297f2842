// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/depth_figures.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>

namespace rtd::camera {
namespace {

constexpr int kPixelStep = 8;
constexpr std::uint64_t kFewestPixels = 30;
constexpr double kMostPixels = 0.9;                  // a share of the pixels
constexpr double kTooNear_m = 0.5, kTooFar_m = 13;   // for nearly all
constexpr double kUsual_m = 0.5, kFarIndoors_m = 6;  // of the median
constexpr double kReach_m = 15;

struct Unit {
  double per_metre;
  const char* name;
};
constexpr std::array kUnits = {Unit{1000, "millimetres"}, Unit{5000, "1/5000 m as in TUM's images"},
                               Unit{10000, "0.1 mm"}, Unit{1, "metres"}};

}  // namespace

void DepthFigures::add(const cv::Mat& depth, double scale_m) {
  scale_m_ = scale_m;
  for (int row = kPixelStep / 2; row < depth.rows; row += kPixelStep) {
    const auto* const pixels = depth.ptr<std::uint16_t>(row);
    for (int column = kPixelStep / 2; column < depth.cols; column += kPixelStep) {
      ++pixels_;
      pixels[column] == 0 ? ++holes_
                          : ++measured_[static_cast<std::size_t>(kBinsPerOctave * std::log2(pixels[column]))];
      eighths_ += pixels[column] != 0 && pixels[column] % 8 == 0;
      odd_eighths_ += pixels[column] % 16 == 8;
    }
  }
}

std::optional<double> DepthFigures::quantile_m(double share) const {
  const std::uint64_t all = pixels_ - holes_;
  if (all == 0) return std::nullopt;
  const double wanted = share * static_cast<double>(all);
  std::uint64_t below = 0;
  std::size_t bin = 0;
  for (; bin + 1 < kBins; ++bin) {
    below += measured_[bin];
    if (static_cast<double>(below) > wanted) break;
  }
  return std::exp2((static_cast<double>(bin) + 0.5) / kBinsPerOctave) * scale_m_;
}

double DepthFigures::hole_share() const {
  return pixels_ == 0 ? 0 : static_cast<double>(holes_) / static_cast<double>(pixels_);
}

std::string DepthFigures::doubt(bool given) const {
  if (pixels_ - holes_ < kFewestPixels) return {};
  const double low_m = *quantile_m(1 - kMostPixels), middle_m = *median_m(), high_m = *quantile_m(kMostPixels);
  const double farthest_m = *quantile_m(0.99);
  const auto fits = [&](const Unit& unit) {
    const double factor = 1 / (scale_m_ * unit.per_metre);  // of the depths, if this were the unit
    return middle_m * factor > kUsual_m && middle_m * factor < kFarIndoors_m && farthest_m * factor < kReach_m;
  };
  const bool near = high_m < kTooNear_m || (!given && middle_m < kUsual_m);
  const bool far = low_m > kTooFar_m || (!given && middle_m > kFarIndoors_m);
  if (!near && !far) return {};
  const bool eighths = static_cast<double>(eighths_) > kMostPixels * static_cast<double>(pixels_ - holes_);
  if (eighths && 10 * odd_eighths_ > eighths_)
    return fmt::format(
        "most depth lies between {:.2g} and {:.2g} m with {:.6g} units per metre, and its low three bits "
        "are 0: no unit makes that right. SUN3D's depth, rotated by three bits, is read without ?depth_factor=",
        low_m, high_m, 1 / scale_m_);
  const auto likely = std::ranges::find_if(kUnits, fits);
  const bool sure = high_m < kTooNear_m || low_m > kTooFar_m;
  if (likely == kUnits.end() && !sure) return {};
  std::string text = fmt::format("most depth lies between {:.2g} and {:.2g} m with {:.6g} units per metre: ", low_m,
                                 high_m, 1 / scale_m_);
  if (likely == kUnits.end()) return text + "check the unit (?depth_factor=UNITS_PER_METRE)";
  return text + fmt::format("the unit is likely {}, median {:.2g} m then (?depth_factor={:g})", likely->name,
                            middle_m / (scale_m_ * likely->per_metre), likely->per_metre);
}

bool is_rotated(const cv::Mat& depth) {
  constexpr double kMillimetre_m = 0.001;
  std::vector<int> eighths;
  int measured = 0;
  for (int row = 0; row < depth.rows; row += 2) {
    for (int column = 0; column < depth.cols; column += 2) {
      const int value = depth.at<std::uint16_t>(row, column);
      measured += value > 0;
      if (value > 0 && value % 8 == 0) eighths.push_back(value / 8);
    }
  }
  if (measured < 1000 || static_cast<double>(eighths.size()) < kMostPixels * measured) return false;
  // Millimetres have both: whole steps of 16 would be another unit.
  const auto even = std::ranges::count_if(eighths, [](int eighth) { return eighth % 2 == 0; });
  DepthFigures figures;
  figures.add(depth, kMillimetre_m);
  return 10 * even < 9 * std::ssize(eighths) && figures.median_m().value_or(0) > kUsual_m * 8;
}

void rotate_back(cv::Mat& depth) {
  for (int row = 0; row < depth.rows; ++row) {
    auto* const pixels = depth.ptr<std::uint16_t>(row);
    for (int column = 0; column < depth.cols; ++column) pixels[column] = std::rotr(pixels[column], 3);
  }
}

double float_quantile(const cv::Mat& values, double share) {
  std::vector<float> positive;
  for (int row = 0; row < values.rows; row += 2) {
    for (int column = 0; column < values.cols; column += 2) {
      const float value = values.at<float>(row, column);
      if (value > 0 && std::isfinite(value)) positive.push_back(value);
    }
  }
  if (positive.empty()) return 0;
  const auto at = positive.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(positive.size() - 1));
  std::ranges::nth_element(positive, at);
  return static_cast<double>(*at);
}

bool floats_are_millimetres(const cv::Mat& values) {
  constexpr double kNoRoom_m = 100;  // m: no depth camera measures it, and renderers show something nearer, too
  return float_quantile(values, 1 - kMostPixels) > kNoRoom_m;
}

}  // namespace rtd::camera
