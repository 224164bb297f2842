// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/image_faults.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace rtd::test_support {
namespace {

constexpr double kDarkness = 0.02;  // of the light: no corner is left

/// Patches of several sizes with corners for features.
cv::Mat texture(const cv::Size& size) {
  cv::RNG random(7);
  cv::Mat painted(size, CV_8UC3, cv::Scalar(90, 90, 90));
  for (const int cell_px : {64, 20, 9}) {
    cv::Mat cells(size.height / cell_px + 1, size.width / cell_px + 1, CV_8UC3), patches;
    random.fill(cells, cv::RNG::UNIFORM, 0, 256);
    cv::resize(cells, patches, {}, cell_px, cell_px, cv::INTER_NEAREST);
    cv::addWeighted(painted, 0.6, patches(cv::Rect({}, size)), 0.4, 0, painted);
  }
  return painted;
}

/// Comes in from the left, sways, and leaves to the right.
cv::Rect place(const ImageFault& fault, double t_s, const cv::Size& image) {
  constexpr double kHeight = 0.9, kSway = 0.06, kSwayPeriod_s = 1.6;
  const double height = kHeight * image.height, width = fault.amount * image.area() / height;
  const double passing_s = std::min(0.5, (fault.end_s - fault.begin_s) / 4);
  const double away = std::max({0.0, 1 - (t_s - fault.begin_s) / passing_s, 1 - (fault.end_s - t_s) / passing_s});
  const double side = t_s - fault.begin_s < fault.end_s - t_s ? -1 : 1;
  const double sway = std::max(kSway * image.width, (image.width - width) / 2);
  const double centre = image.width / 2.0 + side * away * (image.width + width) / 2 +
                        (1 - away) * sway * std::sin(2 * std::numbers::pi * (t_s - fault.begin_s) / kSwayPeriod_s);
  return {static_cast<int>(std::lround(centre - width / 2)), static_cast<int>(std::lround(image.height - height)),
          static_cast<int>(std::lround(width)), static_cast<int>(std::lround(height))};
}

cv::Rect seen_part(const ImageFault& fault, double t_s, const cv::Size& image) {
  return place(fault, t_s, image) & cv::Rect({}, image);
}

bool is_on(const ImageFault& fault, double t_s) {
  return t_s >= fault.begin_s && t_s < fault.end_s;
}

bool is_hidden(const vision::Detection& box, const cv::Rect& behind) {
  const cv::Rect2d area(box.x_px, box.y_px, box.width_px, box.height_px);
  return (area & cv::Rect2d(behind)).area() > 0.5 * area.area();
}

void occlude(const ImageFault& fault, double t_s, camera::SourceFrame& frame) {
  constexpr double kDistance_m = 0.8;
  vision::RgbdImage& image = frame.image;
  const cv::Rect whole = place(fault, t_s, image.color_bgr.size());
  const cv::Rect seen = whole & cv::Rect({}, image.color_bgr.size());
  if (seen.empty()) return;
  image.color_bgr = image.color_bgr.clone();
  image.depth = image.depth.clone();
  texture(whole.size())(seen - whole.tl()).copyTo(image.color_bgr(seen));
  image.depth(seen).setTo(std::lround(kDistance_m / image.depth_scale_m));
  if (frame.dynamic_mask.empty()) return;
  frame.dynamic_mask = frame.dynamic_mask.clone();
  frame.dynamic_mask(seen).setTo(255);
}

void blur(const ImageFault& fault, vision::RgbdImage& image) {
  cv::Mat smeared;
  cv::blur(image.color_bgr, smeared, {std::max(1, static_cast<int>(std::lround(fault.amount))), 1});
  image.color_bgr = smeared;
}

}  // namespace

double ImageFaults::seconds(const camera::SourceFrame& frame) {
  if (!first_ns_) first_ns_ = frame.image.stamp_ns;
  return static_cast<double>(frame.image.stamp_ns - *first_ns_) * 1e-9;
}

std::vector<vision::Detection> ImageFaults::seen(const camera::SourceFrame& frame,
                                                 std::vector<vision::Detection> boxes) {
  constexpr float kScore = 0.8F;
  const double t_s = seconds(frame);
  for (const ImageFault& fault : faults_) {
    if (!is_on(fault, t_s)) continue;
    if (fault.kind == ImageFault::Kind::kDark) return {};
    if (fault.kind == ImageFault::Kind::kBlur) continue;
    const cv::Rect before = seen_part(fault, t_s, frame.image.color_bgr.size());
    std::erase_if(boxes, [&](const vision::Detection& box) { return is_hidden(box, before); });
    if (fault.kind != ImageFault::Kind::kPerson || before.empty()) continue;
    const cv::Rect2f box(before);
    boxes.push_back({"person", kScore, box.x, box.y, box.width, box.height});
  }
  return boxes;
}

void ImageFaults::apply(camera::SourceFrame& frame) {
  const double t_s = seconds(frame);
  for (const ImageFault& fault : faults_) {
    if (!is_on(fault, t_s)) continue;
    switch (fault.kind) {
      case ImageFault::Kind::kOcclude:
      case ImageFault::Kind::kPerson:
        occlude(fault, t_s, frame);
        break;
      case ImageFault::Kind::kDark:
        frame.image.color_bgr = frame.image.color_bgr * kDarkness;
        break;
      case ImageFault::Kind::kBlur:
        blur(fault, frame.image);
        break;
    }
  }
}

}  // namespace rtd::test_support
