// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/tum/tum_source.hpp"

#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "common/msg/rgbd_frame.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/camera/core/image_files.hpp"

namespace rtd::camera {
namespace {

geometry::Trajectory read_groundtruth(const std::filesystem::path& folder, const std::vector<FilePair>& pairs) {
  const std::filesystem::path file = folder / "groundtruth.txt";
  if (!std::filesystem::exists(file) || pairs.empty()) return {};
  try {
    return poses_of_span(geometry::read_tum_trajectory(file, geometry::TumRows::kAsWritten),
                         pairs.front().color.stamp_ns, pairs.back().color.stamp_ns);
  } catch (const geometry::TrajectoryError& error) {
    throw SourceError(error.what());  // a wrong reference would falsify every figure
  }
}

}  // namespace

TumSource::TumSource(std::string uri, std::filesystem::path folder, Options options)
    : folder_(std::move(folder)), options_(options) {
  PairList list = read_pairs(folder_);
  const Calibration calibration = load_calibration(folder_);
  pairs_ = std::move(list.pairs);
  for (SkippedInput& input : list.skipped) skips_.add(std::move(input));
  groundtruth_ = read_groundtruth(folder_, pairs_);
  info_ = {std::move(uri), calibration.camera, calibration.depth_scale_m, calibration.fps, pairs_.size()};
  first_ = read_next();
  if (!first_)
    throw SourceError("no usable frame in " + folder_.string() +
                      (pairs_.empty() ? ": its lists are empty" : skips_.summary()));
}

std::optional<SourceFrame> TumSource::next() {
  std::optional<SourceFrame> frame = first_ ? std::exchange(first_, std::nullopt) : read_next();
  if (frame) skips_.number(*frame);
  return frame;
}

std::uint64_t TumSource::pass_over(std::int64_t stamp_ns) {
  std::uint64_t passed = 0;
  if (first_ && first_->image.stamp_ns < stamp_ns) {
    first_.reset();
    ++passed;
  }
  for (; !first_ && next_pair_ < pairs_.size() && pairs_[next_pair_].color.stamp_ns < stamp_ns; ++next_pair_) ++passed;
  skips_.counters().frames += passed;
  return passed;
}

std::optional<SourceFrame> TumSource::read_next() {
  while (next_pair_ < pairs_.size()) {
    if (std::optional<SourceFrame> frame = read_pair(pairs_[next_pair_++])) return frame;
  }
  return std::nullopt;
}

std::optional<SourceFrame> TumSource::read_pair(const FilePair& pair) {
  ImageRead color = read_color(folder_ / pair.color.file);
  if (color.problem) return skips_.add(*color.problem), std::nullopt;
  ImageRead depth = read_depth(folder_ / pair.depth.file);
  if (depth.problem) return skips_.add(*depth.problem), std::nullopt;
  if (const auto problem = check_sizes(pair, color.image, depth.image)) return skips_.add(*problem), std::nullopt;
  SourceFrame frame = to_frame(pair.color.stamp_ns, std::move(color.image), std::move(depth.image), info_);
  if (options_.masks) frame.dynamic_mask = read_mask(pair);
  return frame;
}

std::optional<SkippedInput> TumSource::check_sizes(const FilePair& pair, const cv::Mat& color,
                                                   const cv::Mat& depth) const {
  if (color.cols > static_cast<int>(msg::kMaxFrameWidth) || color.rows > static_cast<int>(msg::kMaxFrameHeight)) {
    throw SourceError((folder_ / pair.color.file).string() + " has " + size_text(color.size()) +
                      " px, but a frame carries at most " +
                      size_text(cv::Size(msg::kMaxFrameWidth, msg::kMaxFrameHeight)) +
                      " px; scale the images and the calibration down");
  }
  return size_mismatch(pair.color.file, color, depth, info_.camera);
}

cv::Mat TumSource::read_mask(const FilePair& pair) const {
  const std::filesystem::path name = std::filesystem::path(pair.color.file).filename().replace_extension(".png");
  const std::filesystem::path file = folder_ / "mask" / name;
  if (!std::filesystem::exists(file)) return {};
  const cv::Mat mask = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (mask.empty()) return {};
  return mask > 0;
}

}  // namespace rtd::camera
