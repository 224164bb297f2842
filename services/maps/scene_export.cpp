// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/maps/scene_export.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <ostream>
#include <vector>

#include "common/camera/open/source_factory.hpp"
#include "common/geometry/trajectory.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/vision/image_codecs.hpp"
#include "services/maps/scene.hpp"

namespace rtd::maps {
namespace {

namespace fs = std::filesystem;

/// An output folder, and what its masks are called after the image's name.
struct SceneFolder {
  fs::path path;
  const char* mask_suffix;
};

/// Makes pinhole images of what a lens bends.
class Undistortion {
 public:
  explicit Undistortion(const geometry::CameraModel& camera) {
    if (!camera.distorted()) return;
    from_px_.create(camera.parameters().height, camera.parameters().width);
    for (int v = 0; v < from_px_.rows; ++v) {
      for (int u = 0; u < from_px_.cols; ++u) {
        const Eigen::Vector2d raw_px = camera.distort({u, v});
        from_px_(v, u) = {static_cast<float>(raw_px.x()), static_cast<float>(raw_px.y())};
      }
    }
  }
  /// Black where the lens sees nothing.
  cv::Mat apply(const cv::Mat& image) const {
    cv::Mat straight = image;
    if (!from_px_.empty()) cv::remap(image, straight, from_px_, cv::noArray(), cv::INTER_LINEAR);
    return straight;
  }

 private:
  cv::Mat_<cv::Vec2f> from_px_;
};

/// 255 = use, 0 = something moves here or the lens sees nothing; empty when there is no such file.
cv::Mat mask_of(const fs::path& cells_file, cv::Size size_px, const Undistortion& undistortion) {
  const cv::Mat cells = vision::read_image(cells_file, {.pixels = vision::PixelsAs::kGrey}).pixels;
  if (cells.empty()) return {};
  cv::Mat still, mask;
  cv::threshold(cells, still, 128, 255, cv::THRESH_BINARY_INV);  // CellMotion: above is dynamic
  cv::resize(still, mask, size_px, 0, 0, cv::INTER_NEAREST);
  const cv::Mat seen = undistortion.apply(cv::Mat(size_px, CV_8U, cv::Scalar(255))) == 255;
  return mask & seen;
}

void write(const fs::path& file, const cv::Mat& image) {
  fs::create_directories(file.parent_path());
  vision::write_image(file, image, {.durable = false});
}

/// The static landmarks that a keyframe sees, with the colours of its image.
void add_points(Scene& scene, const slam::MapContents& contents, const slam::Keyframe& keyframe, const cv::Mat& image) {
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    const auto landmark = std::ranges::lower_bound(contents.landmarks, keyframe.landmarks[i], {}, &slam::Landmark::id);
    if (keyframe.landmarks[i] == slam::kNoLandmark || landmark->static_probability < 0.5) continue;
    const Eigen::Vector2i at = scene.pixel_of(keyframe, i).cast<int>();
    const auto& bgr = image.at<cv::Vec3b>(std::clamp(at.y(), 0, image.rows - 1), std::clamp(at.x(), 0, image.cols - 1));
    scene.points.try_emplace(landmark->id, ScenePoint{&*landmark, {bgr[2], bgr[1], bgr[0]}});
  }
}

using Keyframes = std::map<std::int64_t, const slam::Keyframe*>;  ///< by stamp

/// Of the largest map.
Keyframes keyframes_of(const slam::MapContents& contents) {
  const std::vector<MapPart> maps = report_on(contents, 0).maps;
  const auto largest = std::ranges::max_element(maps, {}, &MapPart::keyframes);
  Keyframes keyframes;
  for (const slam::Keyframe& keyframe : contents.keyframes)
    if (keyframe.map == largest->id) keyframes[keyframe.frame->stamp_ns] = &keyframe;
  return keyframes;
}

/// Plays the source and writes the images of the keyframes, with their masks.
Scene write_images(const slam::MapContents& contents, const Keyframes& keyframes, camera::FrameSource& source,
                   const fs::path& masks, const std::vector<SceneFolder>& folders) {
  Scene scene{.camera = source.info().camera.parameters(), .masked = fs::is_directory(masks)};
  const Undistortion undistortion(source.info().camera);
  for (auto next = keyframes.begin(); next != keyframes.end();) {
    source.pass_over(next->first);
    const std::optional<camera::SourceFrame> frame = source.next();
    if (!frame) break;
    next = keyframes.lower_bound(frame->image.stamp_ns);
    if (next == keyframes.end() || next->first != frame->image.stamp_ns) continue;
    const slam::Keyframe& keyframe = *next++->second;
    const std::string name = geometry::tum_stamp(frame->image.stamp_ns) + ".png";
    const cv::Mat image = undistortion.apply(frame->image.color_bgr);
    const cv::Mat mask = mask_of(masks / name, image.size(), undistortion);
    if (scene.masked && mask.empty()) continue;
    for (const SceneFolder& folder : folders) {
      write(folder.path / "images" / name, image);
      if (!mask.empty()) write(folder.path / "masks" / (name + folder.mask_suffix), mask);
    }
    scene.images.push_back({&keyframe, name});
    add_points(scene, contents, keyframe, image);
  }
  return scene;
}

void write_models(const Scene& scene, const SceneRequest& request) {
  if (!request.colmap.empty()) {
    const fs::path model = fs::path(request.colmap) / "sparse" / "0";
    fs::create_directories(model);
    write_colmap_model(scene, model);
  }
  if (!request.nerfstudio.empty()) {
    write_transforms(scene, request.nerfstudio);
    const fs::path dense = fs::path(request.folder) / "static_map.ply",
                   points = fs::path(request.nerfstudio) / "points.ply";
    fs::is_regular_file(dense) ? fs::copy_file(dense, points), void() : write_points(scene, points);
  }
}

std::vector<SceneFolder> folders_of(const SceneRequest& request) {
  std::vector<SceneFolder> folders;
  if (!request.colmap.empty()) folders.push_back({request.colmap, ".png"});
  if (!request.nerfstudio.empty()) folders.push_back({request.nerfstudio, ""});
  if (folders.empty()) throw service::ConfigError("nothing to write: give --colmap OUT, --nerfstudio OUT or both");
  for (const SceneFolder& folder : folders)
    if (fs::exists(folder.path))
      throw service::ConfigError(folder.path.string() + " exists already: choose another name");
  return folders;
}

std::unique_ptr<camera::FrameSource> source_of(const SceneRequest& request) {
  const std::string uri =
      request.source.empty() ? run_record::read_run_json(fs::path(request.folder) / "run.json").source : request.source;
  try {
    return camera::make_source(camera::complete_uri(uri));
  } catch (const camera::SourceError& error) {
    throw service::ConfigError(fmt::format(
        "the images come from the source of the run, {}: {}; --source names it where it is now, or a recording of the "
        "run ('rtd run --record FILE.mcap')",
        uri, error.what()));
  }
}

/// Returns the exit code.
int write_scene(const SceneRequest& request, std::ostream& out, std::ostream& err) {
  const std::vector<SceneFolder> folders = folders_of(request);
  const fs::path run = request.folder;
  const std::unique_ptr<camera::FrameSource> source = source_of(request);
  const fs::path map = run / "map.rtdmap";
  if (!fs::is_regular_file(map))
    throw service::ConfigError(map.string() +
                               ": no such file; 'rtd run' writes it, but for --localize-only and --save-map");
  const slam::MapContents contents = slam::load_map_file(map);
  const Keyframes keyframes = keyframes_of(contents);
  const Scene scene = write_images(contents, keyframes, *source, run / "masks", folders);
  const std::size_t without = keyframes.size() - scene.images.size();
  if (scene.images.empty())
    throw service::ConfigError(
        fmt::format("none of the {} keyframes has an image in {}{}: --source names the source of "
                    "the run",
                    keyframes.size(), source->info().uri, scene.masked ? " and a mask" : ""));
  write_models(scene, request);
  for (const SceneFolder& folder : folders)
    out << fmt::format("{}: {} keyframes {} masks, {} landmarks\n", folder.path.string(), scene.images.size(),
                       scene.masked ? "with" : "without", scene.points.size());
  if (!scene.masked)
    err << "rtd export: no masks: people and moving things will leave ghosts; 'rtd run --dense' keeps the masks\n";
  if (without > 0)
    err << fmt::format("rtd export: {} of {} keyframes left out: the source has no such frame, or the run no mask\n",
                       without, keyframes.size());
  return scene.masked && without == 0 ? service::kOk : service::kPartialLoss;
}

}  // namespace

void add_scene_command(CLI::App& app, SceneRequest& request) {
  CLI::App* command = app.add_subcommand(
      "scene", "Export a run for Gaussian splatting: images, poses, points, masks of what moves (COLMAP, nerfstudio)");
  command->add_option("folder", request.folder, "Folder of a run (--out of 'rtd run --dense')")->required();
  command->add_option("--colmap", request.colmap, "New folder: images, masks, sparse/0 with COLMAP's text files");
  command->add_option("--nerfstudio", request.nerfstudio, "New folder: images, masks, transforms.json, points.ply");
  command->add_option("--source", request.source, "Where the images are (default: the source of the run)");
  command->footer(
      "Exit code: 0 done, 1 the output cannot be written, 2 run or source cannot be read, or the output exists, 3 "
      "done, but masks or images of keyframes are missing");
}

int export_scene(const SceneRequest& request, std::ostream& out, std::ostream& err) {
  return service::report_errors<service::ConfigError, camera::SourceError, run_record::RunFileError,
                                slam::MapFileError>("rtd export", err, [&] { return write_scene(request, out, err); });
}

}  // namespace rtd::maps
