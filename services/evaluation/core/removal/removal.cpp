// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/removal/removal.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "common/camera/open/source_factory.hpp"
#include "common/io/folder_walk.hpp"
#include "common/io/text.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::eval {
namespace fs = std::filesystem;
namespace {

constexpr int kGrowPx = 3;
constexpr std::int64_t kSettledNs = 1'000'000'000;

bool lies_on(const cv::Mat& mask, const run_record::JudgedFeature& feature) {
  if (mask.empty()) return false;
  const auto nearest = [](float px, int count) {
    return static_cast<int>(std::lround(std::clamp(px, 0.0F, static_cast<float>(count - 1))));
  };
  return mask.at<std::uint8_t>(nearest(feature.v_raw_px, mask.rows), nearest(feature.u_raw_px, mask.cols)) != 0;
}

/// Gives the mask of a stamp; an empty optional means unknown. Asked in order of time.
using MaskOf = std::function<std::optional<cv::Mat>(std::int64_t stamp_ns)>;

MaskOf masks_of_folder(const fs::path& folder) {
  std::map<std::int64_t, std::string> files;
  for (const fs::path& file : io::FolderWalk().paths(folder)) {
    try {
      files[io::parse_stamp_ns(file.stem().string())] = file.string();
    } catch (const std::invalid_argument&) {
      continue;  // not named by a stamp: not a mask
    }
  }
  return [files](std::int64_t stamp_ns) -> std::optional<cv::Mat> {
    const auto found = files.find(stamp_ns);
    if (found == files.end()) return std::nullopt;
    const cv::Mat mask = vision::read_image(found->second, {.pixels = vision::PixelsAs::kGrey}).pixels;
    if (mask.empty()) return std::nullopt;
    return mask;
  };
}

/// Renders the scene again: the same options give the same bits.
MaskOf masks_of_scene(const std::string& uri) {
  const std::shared_ptr<camera::FrameSource> source = camera::make_source(uri);
  return [source, frame = source->next()](std::int64_t stamp_ns) mutable -> std::optional<cv::Mat> {
    if (frame && frame->image.stamp_ns < stamp_ns) {
      source->pass_over(stamp_ns);
      frame = source->next();
    }
    if (!frame || frame->image.stamp_ns != stamp_ns) return std::nullopt;
    return frame->dynamic_mask;
  };
}

}  // namespace

void RemovalQuality::count(std::span<const run_record::JudgedFeature> features, const cv::Mat& moving) {
  constexpr int kSide = 2 * kGrowPx + 1;
  cv::Mat grown;
  if (!moving.empty()) cv::dilate(moving, grown, cv::getStructuringElement(cv::MORPH_RECT, {kSide, kSide}));
  for (const run_record::JudgedFeature& feature : features) {
    if (feature.removed) {
      ++(lies_on(grown, feature) ? removed_rightly : removed_wrongly);
    } else {
      ++(lies_on(moving, feature) ? kept_wrongly : kept_rightly);
    }
  }
}

std::optional<RunRemoval> judge_removal(const std::string& source_uri,
                                        const std::vector<run_record::JudgedFrame>& frames, const JudgeLimits& limits) {
  if (frames.empty() || limits.most_frames == 0 || !run_record::has_true_masks(source_uri)) return std::nullopt;
  const MaskOf mask_of = run_record::is_synthetic(source_uri) ? masks_of_scene(source_uri)
                                                              : masks_of_folder(run_record::mask_folder(source_uri));
  RunRemoval removal;
  std::int64_t first_ns = 0;
  const std::size_t step = 1 + (frames.size() - 1) / limits.most_frames;
  for (std::size_t i = 0; i < frames.size() && (!limits.go_on || limits.go_on()); i += step) {
    const run_record::JudgedFrame& frame = frames[i];
    const std::optional<cv::Mat> mask = mask_of(frame.stamp_ns);
    if (!mask) continue;
    if (removal.frames++ == 0) first_ns = frame.stamp_ns;
    removal.all.count(frame.features, *mask);
    if (frame.stamp_ns - first_ns >= kSettledNs) removal.settled.count(frame.features, *mask);
  }
  if (removal.frames == 0) return std::nullopt;
  return removal;
}

}  // namespace rtd::eval
