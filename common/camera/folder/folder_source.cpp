// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/folder/folder_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/camera/calibration_forms.hpp"
#include "common/camera/depth_figures.hpp"
#include "common/camera/folder/ground_truth.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

/// What programs call the file with their calibration, here or one folder up.
constexpr std::array kCalibrationFiles = {"camera_intrinsic*.json",
                                          "intrinsic*.json",
                                          "camera*.json",
                                          "calib*.json",
                                          "cam_params.json",
                                          "transforms.json",
                                          "camera_info.y*ml",
                                          "camchain*.yaml",
                                          "sensor*.yaml",
                                          "cam0/sensor.yaml",
                                          "camera*.y*ml",
                                          "calib*.y*ml",
                                          "calibration.txt",
                                          "calib.txt",
                                          "cameras.txt",
                                          "sparse/cameras.txt",
                                          "camera*intrinsic*.txt",
                                          "intrinsic*.txt",
                                          "camera.txt",
                                          "K.txt",
                                          "../calibration.yaml",
                                          "../camera_intrinsic.json",
                                          "../camera-intrinsics.txt",
                                          "../cam_params.json"};

bool nearly_same_shape(cv::Size a, cv::Size b) {
  constexpr double kNearly = 0.02;
  return std::abs(static_cast<double>(a.width) * b.height / (static_cast<double>(a.height) * b.width) - 1) < kNearly;
}

/// The same camera in another number of pixels; pixel centres are whole numbers.
geometry::CameraModel scaled(const geometry::CameraModel& camera, cv::Size size_px) {
  geometry::CameraModel::Parameters p = camera.parameters();
  const double x = static_cast<double>(size_px.width) / p.width, y = static_cast<double>(size_px.height) / p.height;
  p.fx *= x;
  p.fy *= y;
  p.cx = (p.cx + 0.5) * x - 0.5;
  p.cy = (p.cy + 0.5) * y - 0.5;
  p.width = size_px.width;
  p.height = size_px.height;
  return geometry::CameraModel(p);
}

cv::Size size_of(const geometry::CameraModel& camera) {
  return {camera.parameters().width, camera.parameters().height};
}

std::string camera_text(const geometry::CameraModel& camera) {
  const auto& p = camera.parameters();
  return fmt::format("fx {:.6g} fy {:.6g} cx {:.6g} cy {:.6g} at {} px", p.fx, p.fy, p.cx, p.cy,
                     size_text(size_of(camera)));
}

/// Units of a metre of 16-bit depth that no file gives: 5000 where the values cannot be millimetres.
double guess_depth_unit(const cv::Mat& depth) {
  constexpr double kTumUnits = 5000, kMillimetres = 1000, kSensorsReach_m = 15, kNearlyAll = 0.98;
  int measured = 0, fives = 0;
  for (int row = 0; row < depth.rows; row += 2) {
    for (int column = 0; column < depth.cols; column += 2) {
      const std::uint16_t value = depth.at<std::uint16_t>(row, column);
      measured += value > 0;
      fives += value > 0 && value % 5 == 0;
    }
  }
  DepthFigures as_millimetres;
  as_millimetres.add(depth, 1 / kMillimetres);
  const bool too_far = as_millimetres.quantile_m(kNearlyAll).value_or(0) > kSensorsReach_m;
  const bool whole_millimetres = measured > 1000 && fives > kNearlyAll * measured &&
                                 as_millimetres.median_m().value_or(0) > kSensorsReach_m / 4;  // of a flat test image
  return too_far || whole_millimetres ? kTumUnits : kMillimetres;
}

/// A file whose name alone speaks for it may be anything: what cannot be read is passed over.
std::optional<Calibration> calibration_by_name(const FolderContents& contents, std::optional<cv::Size> image_px) {
  for (const char* const pattern : kCalibrationFiles) {
    for (const std::string& file : find_files(contents, pattern)) {
      try {
        return read_calibration(contents.folder / file, image_px, contents.below(file));
      } catch (const SourceError&) {
      }
    }
  }
  return std::nullopt;
}

/// Settings of other programs next to the data, under names that do not speak for them: "orb2.yaml".
std::vector<std::pair<std::string, std::string>> settings_beside(const FolderContents& contents) {
  std::vector<std::pair<std::string, std::string>> found;  // file and form
  for (const std::string& file : find_files(contents, "*.y*ml")) {
    try {
      const std::string text = io::read_file(contents.folder / file, io::kCalibration, contents.below(file));
      if (const auto form = read_calibration_form(text, file)) found.emplace_back(file, form->form);
    } catch (const io::IoError&) {
    } catch (const SourceError&) {  // of a lens that no model fits
    }
  }
  return found;
}

/// Loads what a TUM folder may have, else throws; settings of another program are named, not guessed at.
Calibration required_calibration(const FolderContents& contents, const std::string& uri) {
  const auto settings = settings_beside(contents);
  if (settings.empty()) return load_calibration(contents.folder);
  std::string files;
  for (const auto& [file, form] : settings) files += fmt::format("{}{} ({})", files.empty() ? "" : ", ", file, form);
  throw SourceError(fmt::format(
      "no calibration for {}, but next to the data: {}. Choose one: --source '{}{}calibration={}'",
      contents.folder.string(), files, uri, uri.find('?') == std::string::npos ? '?' : '&', settings.front().first));
}

/// A path without the folder that it is said of.
std::string inside(const fs::path& folder, const std::string& path) {
  const std::string start = (folder / "").string();
  return path.starts_with(start) ? path.substr(start.size()) : path;
}

std::int64_t median_period_ns(const std::vector<FilePair>& pairs) {
  std::vector<std::int64_t> periods_ns;
  for (std::size_t i = 1; i < pairs.size(); ++i)
    periods_ns.push_back(pairs[i].color.stamp_ns - pairs[i - 1].color.stamp_ns);
  std::ranges::sort(periods_ns);
  return periods_ns.empty() ? 0 : periods_ns[periods_ns.size() / 2];
}

}  // namespace

FolderSource::FolderSource(std::string uri, const fs::path& folder, Options options)
    : options_(std::move(options)), contents_(recognise_folder(folder, options_.outside)) {
  info_.uri = std::move(uri);
  read_pairs();
  const FirstImages first = look_at_first_images();
  calibrate(first);
  if (*contents_.layout->note != '\0') note(contents_.layout->note);
  read_first(contents_.folder.string());
}

void FolderSource::read_pairs() {
  const ListRules rules{options_.tolerance_ns, options_.calibration.fps.has_value(), options_.outside};
  if (!contents_.associations.empty()) {
    list_ = read_associations(contents_.folder, contents_.associations, rules);
  } else if (!contents_.color_list.empty()) {
    list_ = read_two_lists(contents_.folder, contents_.color_list, contents_.depth_list, rules);
  } else {
    list_ = pair_by_names(contents_.color, contents_.depth, options_.tolerance_ns);
    for (const std::string& table : find_files(contents_, contents_.layout->stamps))
      if (list_.numbered && !rules.count_frames) apply_table(list_, contents_.folder / table, rules);
  }
  for (SkippedInput& input : list_.skipped) skips_.add(std::move(input));
  skips_.counters().depth_alone = list_.depth_alone;
  info_.frames = list_.pairs.size();
  note(fmt::format("took {} for {}: {} pairs {}", contents_.folder.string(), contents_.layout->name, list_.pairs.size(),
                   list_.how));
  if (!list_.pairs.empty()) return;
  throw SourceError(
      "no usable frame in " + contents_.folder.string() +
      (list_.how.find(".txt") == std::string::npos ? ": no colour image has a depth image" : ": its lists are empty") +
      skips_.summary());
}

FolderSource::FirstImages FolderSource::look_at_first_images() const {
  constexpr std::size_t kMost = 8;
  FirstImages first;
  for (std::size_t i = 0; i < std::min(kMost, list_.pairs.size()); ++i) {
    const FilePair& pair = list_.pairs[i];
    if (!first.color_px) {
      if (const ImageRead color = read_color(contents_.folder / pair.color.file, contents_.below()); !color.problem)
        first.color_px = color.image.size();
    }
    const bool measured = !first.depth.empty() && cv::countNonZero(first.depth) > 0;
    if (!measured) {
      if (const ImageRead depth = read_depth(contents_.folder / pair.depth.file, contents_.below()); !depth.problem)
        first.depth = depth.image;
    }
    if (measured && first.color_px) break;
  }
  return first;
}

/// By what the user gave, the folder's own files, the camera that its name means, or its layout's.
std::optional<Calibration> FolderSource::calibration_of_files(const FirstImages& first) const {
  const fs::path& folder = contents_.folder;
  if (options_.calibration.has_camera()) return requested_calibration(options_.calibration, folder, first.color_px);
  const auto& [fx, fy, cx, cy, width, height] = contents_.layout->camera;
  const bool smaller = fx == 0 && first.color_px && first.color_px->width < width;  // than where the camera is given
  const std::optional<cv::Size> unsaid_px =
      smaller ? cv::Size(static_cast<int>(width), static_cast<int>(height)) : first.color_px;
  for (const std::string files : {"calibration.yaml", contents_.layout->calibration})
    for (const std::string& file : find_files(contents_, files))
      return read_calibration(folder / file, unsaid_px, contents_.below(file));
  if (auto known = known_calibration(folder)) return known;
  if (auto found = calibration_by_name(contents_, first.color_px)) return found;
  const std::string origin = std::string("all of ") + contents_.layout->name;
  if (fx == 0) return std::nullopt;
  return make_calibration({{"fx", fx}, {"fy", fy}, {"cx", cx}, {"cy", cy}, {"width", width}, {"height", height}},
                          origin, std::nullopt);
}

void FolderSource::calibrate(const FirstImages& first) {
  const std::optional<Calibration> found = calibration_of_files(first);
  Calibration calibration = found ? *found : required_calibration(contents_, info_.uri);
  y_up_ = calibration.y_up;
  note(fmt::format("camera: {} by {}", camera_text(calibration.camera), inside(contents_.folder, calibration.origin)));
  if (y_up_) {
    note(
        "fy is negative: the y axis of ICL-NUIM's camera points up. Images are the same, so the positive value is "
        "taken; true poses are mirrored into a camera whose y axis points down");
  }
  if (first.color_px) fit(calibration.camera, *first.color_px);
  apply(calibration, info_);
  choose_depth_unit(calibration, first);
  align_depth(first);
  set_times(calibration);
}

/// The camera of the images, or of what a frame carries of them.
void FolderSource::fit(geometry::CameraModel& camera, cv::Size image_px) {
  const cv::Size frame_px = size_in_frame(image_px);
  if (!nearly_same_shape(image_px, size_of(camera))) return;
  if (frame_px != image_px) large_px_ = image_px;
  if (image_px == size_of(camera) && large_px_.empty()) return;
  camera = scaled(camera, frame_px);
  note(fmt::format("its images have {} px{}: scaled to {}", size_text(image_px),
                   large_px_.empty() ? "" : ", more than a frame carries", camera_text(camera)));
}

void FolderSource::choose_depth_unit(const Calibration& calibration, const FirstImages& first) {
  if (first.depth.type() == CV_32FC1) {
    choose_float_unit(first.depth);
    return;
  }
  const std::optional<double>& requested = options_.calibration.depth_factor;
  info_.depth_unit_given = requested || calibration.depth_factor_given;
  std::string by = requested ? "?depth_factor=" : inside(contents_.folder, calibration.origin);
  if (requested) info_.depth_scale_m = 1 / *requested;
  rotated_ = !requested && !first.depth.empty() && is_rotated(first.depth);
  if (rotated_) {
    info_.depth_scale_m = kMillimetre;
    note("depth: millimetres, rotated by three bits as SUN3D stores them");
    return;
  }
  if (!info_.depth_unit_given) {
    const double usual = contents_.layout->depth_factor;
    by = usual > 0 ? std::string("the layout") : std::string("the images");
    info_.depth_scale_m =
        1 / (usual > 0 || first.depth.empty() ? std::max(usual, 1000.0) : guess_depth_unit(first.depth));
  }
  note(fmt::format("depth: {:.6g} units per metre by {}", 1 / info_.depth_scale_m, by));
}

/// Floats are metres unless they are far too large for that, or the user says otherwise.
void FolderSource::choose_float_unit(const cv::Mat& values) {
  constexpr double kMillimetres = 1000, kNearlyAll = 0.9;
  const bool large = floats_are_millimetres(values);
  const double per_metre = options_.calibration.depth_factor.value_or(large ? kMillimetres : 1);
  const bool far = float_quantile(values, kNearlyAll) / per_metre > kFloatDepthUnitM * 65534;
  info_.depth_scale_m = far ? kMillimetre : kFloatDepthUnitM;
  float_step_ = info_.depth_scale_m * per_metre;
  note(fmt::format("depth: floats in {}, up to {:.0f} m",
                   per_metre == 1 ? "metres" : fmt::format("1/{:g} m", per_metre), info_.depth_scale_m * 65534));
}

/// Depth through another lens is registered, depth in another number of pixels scaled; both are seen from one place.
void FolderSource::align_depth(const FirstImages& first) {
  if (first.depth.empty()) return;
  const cv::Size depth_px = first.depth.size(), color_px = size_of(info_.camera);
  std::optional<geometry::CameraModel> lens;
  for (const std::string& file : find_files(contents_, contents_.layout->depth_calibration)) {
    lens = read_calibration(contents_.folder / file, depth_px, contents_.below(file)).camera;
    note(fmt::format("depth has the lens of {}: it is registered to colour", file));
    break;
  }
  if (!lens && depth_px != color_px && nearly_same_shape(depth_px, color_px)) {
    lens = scaled(info_.camera, depth_px);
    note(fmt::format("depth of {} px is scaled to {}", size_text(depth_px), size_text(color_px)));
  }
  if (lens) registration_.emplace(info_.camera, *lens, Eigen::Isometry3d::Identity(), info_.depth_scale_m);
}

/// Stamps of the frames, their rate, and the true poses in the same time.
void FolderSource::set_times(const Calibration& calibration) {
  GroundTruth truth = read_ground_truth(contents_, list_, y_up_);
  const std::optional<double>& requested = options_.calibration.fps;
  if (list_.numbered || requested) {
    info_.fps = requested ? *requested : calibration.fps_given ? calibration.fps : contents_.layout->fps;
    const std::vector<FilePair> before = list_.pairs;
    const bool numbered = list_.numbered;
    apply_rate(list_, info_.fps);
    std::vector<std::int64_t> old_ns, new_ns;
    for (std::size_t i = 0; i < before.size(); ++i) {
      old_ns.push_back(before[i].color.stamp_ns);
      new_ns.push_back(list_.pairs[i].color.stamp_ns);
    }
    truth.poses = retimed(truth.poses, old_ns, new_ns, numbered ? 0 : kTrueWithinNs);
    note(fmt::format("times: {:g} frames per second{}", info_.fps, requested ? "" : " (?fps= gives another rate)"));
  } else {
    const auto period_ns = static_cast<double>(median_period_ns(list_.pairs));
    const bool unknown = !calibration.fps_given && period_ns > 0;
    info_.fps = unknown ? std::clamp(1e9 / period_ns, 0.1, 1000.0) : calibration.fps;
  }
  const bool any = !truth.poses.empty();
  groundtruth_ =
      poses_of_span(std::move(truth.poses), list_.pairs.front().color.stamp_ns, list_.pairs.back().color.stamp_ns);
  if (!truth.note.empty())
    note(fmt::format("ground truth: {}; {} belong to the frames", truth.note, groundtruth_.size()));
  info_.remarks = std::move(truth.remarks);
  if (any && groundtruth_.empty())
    info_.remarks.emplace_back("ground truth not used: no pose at the time of the frames");
}

std::optional<std::int64_t> FolderSource::advance() {
  if (next_pair_ == list_.pairs.size()) return std::nullopt;
  return list_.pairs[next_pair_++].color.stamp_ns;
}

/// Lists of an extract name images that it does not have.
bool FolderSource::is_there() const {
  const FilePair& pair = list_.pairs[next_pair_ - 1];
  const auto has_content = [this](const std::string& file) {
    try {
      return io::FileSource(contents_.folder / file, io::Links::kFollow, contents_.below()).size() > 0;
    } catch (const io::IoError&) {
      return false;
    }
  };
  return has_content(pair.color.file) && has_content(pair.depth.file);
}

ImageRead FolderSource::read_depth_units(const std::string& file) const {
  ImageRead depth = read_depth(contents_.folder / file, contents_.below());
  if (depth.problem) return depth;
  if (rotated_ && depth.image.type() == CV_16UC1) rotate_back(depth.image);
  if (depth.image.type() == CV_32FC1) {
    const double step = float_step_ > 0 ? float_step_ : kFloatDepthUnitM;
    depth.image = quantize_depth(depth.image, step);
  }
  if (registration_ && depth.image.size() == registration_->depth_size()) depth.image = (*registration_)(depth.image);
  return depth;
}

std::optional<SourceFrame> FolderSource::decode() {
  const FilePair& pair = list_.pairs[next_pair_ - 1];
  ImageRead color = read_color(contents_.folder / pair.color.file, contents_.below());
  ImageRead depth = color.problem ? ImageRead{} : read_depth_units(pair.depth.file);
  std::optional<SkippedInput> problem = color.problem ? color.problem : depth.problem;
  if (!problem) {
    if (color.image.size() == large_px_)
      cv::resize(color.image, color.image, size_of(info_.camera), 0, 0, cv::INTER_AREA);
    check_frame_size(color.image.cols, color.image.rows, (contents_.folder / pair.color.file).string());
    const std::string unit = info_.depth_unit_given ? fmt::format("&depth_factor={:.6g}", 1 / info_.depth_scale_m) : "";
    problem = size_mismatch(pair.color.file, color.image, depth.image, info_.camera, unit);
  }
  if (problem) {
    skips_.add(*problem);
    return std::nullopt;
  }
  SourceFrame frame = to_frame(pair.color.stamp_ns, std::move(color.image), std::move(depth.image), info_);
  set_depth_stamp(frame, pair.depth.stamp_ns, info_);
  if (options_.masks) frame.dynamic_mask = read_mask(pair);
  return frame;
}

cv::Mat FolderSource::read_mask(const FilePair& pair) const {
  const fs::path name = fs::path(pair.color.file).filename().replace_extension(".png");
  const fs::path file = contents_.folder / "mask" / name;
  const cv::Mat mask = vision::read_image(file, {.pixels = vision::PixelsAs::kGrey}, contents_.below()).pixels;
  if (mask.empty()) return {};
  return mask > 0;
}

}  // namespace rtd::camera
