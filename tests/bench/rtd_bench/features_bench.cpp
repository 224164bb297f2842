// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/features_bench.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "services/filter/core/orb/orb_extractor.hpp"

namespace rtd::bench {
namespace {

using Points = std::vector<cv::Point2f>;

double thread_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double spread_of(const Points& points, cv::Size size) {
  constexpr int kColumns = 20, kRows = 15;
  std::set<int> cells;
  for (const cv::Point2f& point : points) {
    const int column = std::clamp(static_cast<int>(point.x) * kColumns / size.width, 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(point.y) * kRows / size.height, 0, kRows - 1);
    cells.insert(row * kColumns + column);
  }
  return static_cast<double>(cells.size()) / (kColumns * kRows);
}

template <class Extract>
void time_one(ExtractorTimes& times, bool counted, cv::Size size, const Extract& extract) {
  const auto wall = std::chrono::steady_clock::now();
  const double cpu_ms = thread_cpu_ms();
  const auto features = extract();
  const double spent_ms = thread_cpu_ms() - cpu_ms;
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - wall;
  if (!counted) return;
  const Points points = features();
  times.wall_ms.push_back(passed.count());
  times.cpu_ms.push_back(spent_ms);
  times.found.push_back(static_cast<int>(points.size()));
  times.spread.push_back(spread_of(points, size));
}

class Contest {
 public:
  explicit Contest(const FeaturesOptions& options)
      : own_(own_config(options)), opencv_(cv::ORB::create(options.features, 1.2F, 8)) {}

  void take(const vision::RgbdImage& image, bool own_first, bool counted, FeaturesResult& result) {
    if (own_first) time_own(image, counted, result.own);
    time_opencv(image, counted, result.opencv);
    if (!own_first) time_own(image, counted, result.own);
  }

 private:
  static filter::OrbConfig own_config(const FeaturesOptions& options) {
    filter::OrbConfig config;
    config.feature_count = options.features;
    return config;
  }
  void time_own(const vision::RgbdImage& image, bool counted, ExtractorTimes& times) {
    time_one(times, counted, image.color_bgr.size(), [&] {
      return [features = own_.extract(image)] {
        Points points;
        for (const msg::Feature& feature : features) points.emplace_back(feature.u_raw_px, feature.v_raw_px);
        return points;
      };
    });
  }
  void time_opencv(const vision::RgbdImage& image, bool counted, ExtractorTimes& times) {
    time_one(times, counted, image.color_bgr.size(), [&] {
      cv::Mat gray, descriptors;
      std::vector<cv::KeyPoint> keypoints;
      cv::cvtColor(image.color_bgr, gray, cv::COLOR_BGR2GRAY);
      opencv_->detectAndCompute(gray, cv::noArray(), keypoints, descriptors);
      return [keypoints = std::move(keypoints)] {
        Points points;
        cv::KeyPoint::convert(keypoints, points);
        return points;
      };
    });
  }

  filter::OrbExtractor own_;
  cv::Ptr<cv::ORB> opencv_;
};

}  // namespace

FeaturesResult bench_features(camera::FrameSource& source, const FeaturesOptions& options,
                              const std::function<void(std::uint64_t)>& on_frame) {
  cv::setNumThreads(1);
  FeaturesResult result;
  result.own.name = "rtd-slam";
  result.opencv.name = "cv::ORB";
  Contest contest(options);
  std::vector<vision::RgbdImage> images;
  while (images.size() < options.frames) {
    auto frame = source.next();
    if (!frame) break;
    images.push_back(std::move(frame->image));
  }
  if (images.empty()) throw camera::SourceError("the source has no frames");
  result.width = images.front().color_bgr.cols;
  result.height = images.front().color_bgr.rows;
  for (std::uint64_t i = 0; i < options.warm_up; ++i) contest.take(images[i % images.size()], true, false, result);
  for (std::uint64_t i = 0; i < images.size(); ++i) {
    contest.take(images[i], i % 2 == 0, true, result);
    on_frame(i + 1);
  }
  return result;
}

}  // namespace rtd::bench
