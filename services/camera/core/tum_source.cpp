// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/tum_source.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "common/msg/rgbd_frame.hpp"
#include "services/camera/core/image_files.hpp"
#include "services/camera/core/trajectory_file.hpp"

namespace rtd::camera {
namespace {

std::vector<StampedPose> read_groundtruth(const std::filesystem::path& folder, const std::vector<FilePair>& pairs) {
  const std::filesystem::path file = folder / "groundtruth.txt";
  if (!std::filesystem::exists(file) || pairs.empty()) return {};
  std::vector<StampedPose> poses = read_tum_trajectory(file);
  const std::int64_t from_ns = pairs.front().color.stamp_ns - kGroundtruthMarginNs;
  const std::int64_t to_ns = pairs.back().color.stamp_ns + kGroundtruthMarginNs;
  const auto outside = [=](const StampedPose& pose) { return pose.stamp_ns < from_ns || pose.stamp_ns > to_ns; };
  poses.erase(std::remove_if(poses.begin(), poses.end(), outside), poses.end());
  return poses;
}

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

TumSource::TumSource(std::string uri, std::filesystem::path folder, Options options)
    : folder_(std::move(folder)), options_(options) {
  PairList list = read_pairs(folder_);
  const Calibration calibration = load_calibration(folder_);
  pairs_ = std::move(list.pairs);
  for (SkippedInput& input : list.skipped) skip(std::move(input));
  groundtruth_ = read_groundtruth(folder_, pairs_);
  info_ = {std::move(uri), calibration.camera, calibration.depth_scale_m, calibration.fps, pairs_.size()};
  first_ = read_next();
  if (!first_) throw SourceError("no usable frame in " + folder_.string() + summary_of_skips());
}

std::optional<SourceFrame> TumSource::next() {
  std::optional<SourceFrame> frame = first_ ? std::exchange(first_, std::nullopt) : read_next();
  if (!frame) return frame;
  frame->image.seq = counters_.frames++;
  if (!frame->has_depth) ++counters_.frames_without_depth;
  return frame;
}

std::uint64_t TumSource::pass_over(std::int64_t stamp_ns) {
  std::uint64_t passed = 0;
  if (first_ && first_->image.stamp_ns < stamp_ns) {
    first_.reset();
    ++passed;
  }
  for (; !first_ && next_pair_ < pairs_.size() && pairs_[next_pair_].color.stamp_ns < stamp_ns; ++next_pair_) ++passed;
  counters_.frames += passed;
  return passed;
}

std::vector<SkippedInput> TumSource::take_skipped() {
  return std::exchange(skipped_, {});
}

std::optional<SourceFrame> TumSource::read_next() {
  while (next_pair_ < pairs_.size()) {
    if (std::optional<SourceFrame> frame = read_pair(pairs_[next_pair_++])) return frame;
  }
  return std::nullopt;
}

std::optional<SourceFrame> TumSource::read_pair(const FilePair& pair) {
  ImageRead color = read_color(folder_ / pair.color.file);
  if (color.problem) return skip(*color.problem), std::nullopt;
  ImageRead depth = read_depth(folder_ / pair.depth.file);
  if (depth.problem) return skip(*depth.problem), std::nullopt;
  if (const auto problem = check_sizes(pair, color.image, depth.image)) return skip(*problem), std::nullopt;
  SourceFrame frame;
  frame.image.stamp_ns = pair.color.stamp_ns;
  frame.image.color_bgr = std::move(color.image);
  frame.image.depth = std::move(depth.image);
  frame.image.depth_scale_m = info_.depth_scale_m;
  frame.image.camera = info_.camera;
  frame.has_depth = cv::countNonZero(frame.image.depth) > 0;
  if (options_.masks) frame.dynamic_mask = read_mask(pair);
  return frame;
}

std::optional<SkippedInput> TumSource::check_sizes(const FilePair& pair, const cv::Mat& color,
                                                   const cv::Mat& depth) const {
  if (color.cols > static_cast<int>(msg::kMaxFrameWidth) || color.rows > static_cast<int>(msg::kMaxFrameHeight)) {
    throw SourceError((folder_ / pair.color.file).string() + " has " + size_text(color.cols, color.rows) +
                      " px, but a frame carries at most " + size_text(msg::kMaxFrameWidth, msg::kMaxFrameHeight) +
                      " px; scale the images and the calibration down");
  }
  const auto& parameters = info_.camera.parameters();
  const cv::Size calibrated(parameters.width, parameters.height);
  if (color.size() == calibrated && depth.size() == calibrated) return std::nullopt;
  return SkippedInput{SkipReason::kSizeMismatch, pair.color.file + ": colour " + size_text(color.cols, color.rows) +
                                                     ", depth " + size_text(depth.cols, depth.rows) + ", calibration " +
                                                     size_text(parameters.width, parameters.height) + " px differ"};
}

cv::Mat TumSource::read_mask(const FilePair& pair) const {
  const std::filesystem::path name = std::filesystem::path(pair.color.file).filename().replace_extension(".png");
  const std::filesystem::path file = folder_ / "mask" / name;
  if (!std::filesystem::exists(file)) return {};
  const cv::Mat mask = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (mask.empty()) return {};
  return mask > 0;
}

void TumSource::skip(SkippedInput input) {
  ++counters_.skipped[static_cast<std::size_t>(input.reason)];
  skipped_.push_back(std::move(input));
}

std::string TumSource::summary_of_skips() const {
  if (skipped_.empty()) return ": its lists are empty";
  std::string text = ":";
  for (std::size_t i = 0; i < kSkipReasons; ++i) {
    if (counters_.skipped[i] == 0) continue;
    text += ' ' + std::to_string(counters_.skipped[i]) + " x " + to_string(static_cast<SkipReason>(i)) + ',';
  }
  return text + " first: " + skipped_.front().detail;
}

}  // namespace rtd::camera
