// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/tum/tum_export.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/camera/calibration.hpp"
#include "common/io/atomic_file.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) {
  try {
    io::write_file(file, text);
  } catch (const io::IoError& error) {
    throw SourceError(std::string("cannot write ") + error.what());
  }
}

void write_png(const fs::path& file, const cv::Mat& image) {
  try {
    if (!vision::write_image(file, image, {.durable = false})) throw SourceError("cannot encode " + file.string());
  } catch (const io::IoError& error) {
    throw SourceError(std::string("cannot write ") + error.what());
  }
}

void prepare(const fs::path& folder) {
  if (fs::exists(folder / "rgb.txt")) {
    throw SourceError(folder.string() + " holds a sequence already; name a new folder or remove it");
  }
  std::error_code error;
  for (const char* name : {"rgb", "depth"}) {
    fs::create_directories(folder / name, error);
    if (error) throw SourceError("cannot make " + (folder / name).string() + ": " + error.message());
  }
}

/// The depth image's own stamp; the calibration gives the rest of the time between the two images.
std::int64_t depth_stamp_ns(const vision::RgbdImage& image, const SourceInfo& info) {
  const std::int64_t offset_ns = std::llround((image.depth_offset_s - info.depth_offset_s) * 1e9);
  return std::max<std::int64_t>(0, image.stamp_ns + offset_ns);  // lists have no times before 0
}

/// The list files while they grow.
struct Lists {
  std::string rgb = "# timestamp filename\n", depth = rgb, associations;
  void add(const std::string& stamp, const std::string& depth_stamp, const std::string& file) {
    rgb += stamp + " rgb/" + file + '\n';
    depth += depth_stamp + " depth/" + file + '\n';
    associations += stamp + " rgb/" + file + ' ' + depth_stamp + " depth/" + file + '\n';
  }
};

}  // namespace

void check_end(const FrameSource& source, std::uint64_t max_frames) {
  if (source.info().frames == 0 && max_frames == 0) {
    throw SourceError("source " + source.info().uri + " is endless: limit it with --frames N");
  }
}

std::uint64_t export_tum(FrameSource& source, const fs::path& folder, std::uint64_t max_frames,
                         const OnFrame& on_frame) {
  check_end(source, max_frames);
  prepare(folder);
  const SourceInfo& info = source.info();
  Lists lists;
  std::uint64_t frames = 0;
  while (max_frames == 0 || frames < max_frames) {
    const std::optional<SourceFrame> frame = source.next();
    if (!frame) break;
    const std::string stamp = geometry::tum_stamp(frame->image.stamp_ns), file = stamp + ".png";
    write_png(folder / "rgb" / file, frame->image.color_bgr);
    write_png(folder / "depth" / file, frame->image.depth);
    if (!frame->dynamic_mask.empty()) {
      fs::create_directory(folder / "mask");
      write_png(folder / "mask" / file, frame->dynamic_mask);
    }
    lists.add(stamp, geometry::tum_stamp(depth_stamp_ns(frame->image, info)), file);
    ++frames;
    if (on_frame) on_frame(frames);
  }
  write_text(folder / "rgb.txt", lists.rgb);
  write_text(folder / "depth.txt", lists.depth);
  write_text(folder / "associations.txt", lists.associations);
  std::ostringstream groundtruth;
  geometry::write_tum_trajectory(groundtruth, source.groundtruth(), geometry::TumStyle::kGroundtruth);
  write_text(folder / "groundtruth.txt", groundtruth.str());
  write_text(folder / "calibration.yaml",
             to_yaml({info.camera, info.depth_scale_m, info.fps, info.readout_s, info.depth_offset_s}));
  return frames;
}

}  // namespace rtd::camera
