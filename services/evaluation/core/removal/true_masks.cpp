// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/removal/true_masks.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "services/camera/core/source_factory.hpp"
#include "services/evaluation/core/trajectory/trajectory.hpp"

namespace rtd::launcher {
namespace fs = std::filesystem;
namespace {

constexpr char kTum[] = "tum:", kSynthetic[] = "synthetic:";
constexpr std::int64_t kSettledNs = 1'000'000'000;

bool is_synthetic(const std::string& uri) {
  return uri.rfind(kSynthetic, 0) == 0;
}

fs::path mask_folder(const std::string& uri) {
  if (uri.rfind(kTum, 0) != 0) return {};
  const std::string folder = uri.substr(sizeof kTum - 1);
  return fs::path(folder.substr(0, folder.find('?'))) / "mask";
}

/// Gives the mask of a stamp; empty optional = unknown. Asked in order of time.
using MaskOf = std::function<std::optional<cv::Mat>(std::int64_t stamp_ns)>;

MaskOf masks_of_folder(const fs::path& folder) {
  std::map<std::int64_t, std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    try {
      files[eval::parse_stamp_ns(entry.path().stem().string())] = entry.path().string();
    } catch (const std::invalid_argument&) {
      continue;  // not named by a stamp: belongs to nobody
    }
  }
  return [files](std::int64_t stamp_ns) -> std::optional<cv::Mat> {
    const auto found = files.find(stamp_ns);
    if (found == files.end()) return std::nullopt;
    const cv::Mat mask = cv::imread(found->second, cv::IMREAD_GRAYSCALE);
    if (mask.empty()) return std::nullopt;
    return mask;
  };
}

/// Plays the scene again: the same options give the same bits.
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

bool has_true_masks(const std::string& source_uri) {
  std::error_code error;
  const fs::path folder = mask_folder(source_uri);
  return is_synthetic(source_uri) || (!folder.empty() && fs::is_directory(folder, error));
}

std::optional<RunRemoval> judge_removal(const std::string& source_uri, const std::vector<JudgedFrame>& frames,
                                        const JudgeLimits& limits) {
  if (frames.empty() || limits.most_frames == 0 || !has_true_masks(source_uri)) return std::nullopt;
  const MaskOf mask_of =
      is_synthetic(source_uri) ? masks_of_scene(source_uri) : masks_of_folder(mask_folder(source_uri));
  RunRemoval removal;
  std::int64_t first_ns = 0;
  const std::size_t step = 1 + (frames.size() - 1) / limits.most_frames;
  for (std::size_t i = 0; i < frames.size() && (!limits.go_on || limits.go_on()); i += step) {
    const JudgedFrame& frame = frames[i];
    const std::optional<cv::Mat> mask = mask_of(frame.stamp_ns);
    if (!mask) continue;
    if (removal.frames++ == 0) first_ns = frame.stamp_ns;
    removal.all.count(frame.features, *mask);
    if (frame.stamp_ns - first_ns >= kSettledNs) removal.settled.count(frame.features, *mask);
  }
  if (removal.frames == 0) return std::nullopt;
  return removal;
}

}  // namespace rtd::launcher
