// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/folder/layouts.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <sstream>

#include "common/camera/unread_forms.hpp"
#include "common/io/folder_walk.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColorImages =
    "rgb/*|color/*|colour/*|image/*|images/*|rgb_*/*|color_*/*|*_rgb/*|*_color/*|rgb*/*|color*/*|img*/*|image_left/*|"
    "left/*|image*/*|cam0/data/*";
constexpr const char* kDepthImages =
    "depth/*|depths/*|aligned_depth*/*|depth_aligned*/*|depth_to_*/*|depth_*/*|*_depth/*|depth*/*|depth_left/*|"
    "depth0/data/*|*depth*/*";
constexpr const char* kAssociations =
    "associations.txt|associated.txt|associate.txt|association.txt|rgbd_assoc*.txt|*_assoc*.txt";
constexpr const char* kAnyPoses =
    "groundtruth.txt|gt.txt|*.freiburg|traj.txt|trajectory.txt|trajectory.log|*.log|poses.txt|pose.txt|poses/*|pose/*|"
    "*groundtruth*/data.csv|groundtruth*.csv";
constexpr const char* kNone = "";

/// The first that fits is taken: what needs more comes before what needs less.
constexpr Layout kLayouts[] = {
    {"OpenLORIS",
     kNone,
     kNone,
     kNone,
     "color.txt",
     "aligned_depth.txt",
     "sensors.yaml|../sensors.yaml",
     kNone,
     kNone,
     1000,
     30,
     {},
     PoseAxes::kOptical,
     "its ground truth is that of the robot's base: rtd benchmark openloris uses it"},
    {"ICL-NUIM",
     "*.gt.freiburg|*gt.freiburg",
     "living_room_traj*|office_room_traj*|traj?_frei_png|*icl*nuim*",
     kAssociations,
     "rgb/*",
     "depth/*",
     kNone,
     kNone,
     "*.freiburg|groundtruth.txt",
     5000,
     30,
     {481.2, -480, 319.5, 239.5, 640, 480}},
    {"ETH3D", "calibration.txt", kNone, "associated.txt", "rgb.txt", "depth.txt", "calibration.txt", kNone,
     "groundtruth.txt", 5000},
    {"TUM RGB-D", kNone, kNone, kAssociations, "rgb.txt", "depth.txt", kNone, kNone, "groundtruth.txt", 5000},
    {"7-Scenes",
     kNone,
     kNone,
     kNone,
     "frame-*.color.*",
     "frame-*.depth.*",
     "info.txt|_info.txt|../camera-intrinsics.txt",
     kNone,
     "frame-*.pose.txt",
     1000,
     30,
     {585, 585, 320, 240, 640, 480}},
    {"ScanNet export", "intrinsic/*|intrinsic_color.txt|intrinsics_color.txt|pose/*.txt", kNone, kNone, "color/*",
     "depth/*", "intrinsic/intrinsic_color.txt|intrinsic_color.txt|intrinsics_color.txt|_info.txt|scene*.txt",
     "intrinsic/intrinsic_depth.txt|intrinsic_depth.txt|intrinsics_depth.txt", "pose/*.txt", 1000},
    {"TartanAir",
     kNone,
     kNone,
     kNone,
     "image_left/*_left.*|image_lcam_front/*",
     "depth_left/*.npy|depth_lcam_front/*",
     kNone,
     kNone,
     "pose_left.txt|pose_lcam_front.txt",
     0,
     30,
     {320, 320, 320, 240, 640, 480},
     PoseAxes::kNed},
    {"Replica", kNone, kNone, kNone, "results/frame*", "results/depth*", "cam_params.json|../cam_params.json", kNone,
     "traj.txt", 6553.5},
    {"Redwood",
     "rgb/*-????????????.*|color/*-????????????.*|image/*-????????????.*",
     kNone,
     kNone,
     "rgb/*-*|color/*-*|image/*-*",
     "depth/*-*",
     kNone,
     kNone,
     "trajectory.log|*.log",
     1000,
     30,
     {525, 525, 319.5, 239.5, 640, 480}},
    {"Stray Scanner",
     "camera_matrix.csv",
     kNone,
     kNone,
     "rgb/*",
     "depth/*",
     "camera_matrix.csv",
     kNone,
     kNone,
     1000,
     60,
     {0, 0, 0, 0, 1920, 1440},
     PoseAxes::kOptical,
     "the poses in odometry.csv are those of ARKit, not ground truth",
     "odometry.csv"},
    {"Open3D", "*intrinsic*.json", kNone, kNone, kColorImages, kDepthImages, "camera_intrinsic.json|*intrinsic*.json",
     kNone, kAnyPoses, 1000},
    {"colour and depth folders", kNone, kNone, kNone, kColorImages, kDepthImages, kNone, kNone, kAnyPoses},
    {"colour and depth in one folder", kNone, kNone, kNone, "*color*|*rgb*|*image*|frame*", "*depth*", kNone, kNone,
     kAnyPoses},
};

bool matches(const std::string& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), FNM_CASEFOLD | FNM_PERIOD) == 0;
}

std::vector<std::string> split(const std::string& text, char mark) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, mark);) parts.push_back(part);
  return parts;
}

bool is_one_name(const std::string& pattern) {
  return pattern.find_first_of("*?") == std::string::npos;
}

/// The files below `folder` that one alternative finds, part by part of its path. What has exactly the name of a file
/// is taken for it whatever it is: who reads it says why it cannot be read.
std::vector<std::string> find_one(io::FolderWalk& walk, const fs::path& folder, const std::string& pattern) {
  const std::size_t slash = pattern.find('/');
  const std::string here = pattern.substr(0, slash);
  std::vector<std::string> found;
  if (slash != std::string::npos && here == "..") {
    io::FolderWalk above(folder / "..");
    for (const std::string& file : find_one(above, folder / "..", pattern.substr(slash + 1)))
      found.push_back("../" + file);
    return found;
  }
  for (const io::FolderEntry& entry : walk.entries(folder)) {
    if (!matches(here, entry.name)) continue;
    if (slash == std::string::npos) {
      if (!entry.is_folder || is_one_name(here)) found.push_back(entry.name);
    } else if (entry.is_folder && found.empty()) {  // one folder
      for (const std::string& file : find_one(walk, folder / entry.name, pattern.substr(slash + 1)))
        found.push_back(entry.name + "/" + file);
    }
  }
  return found;
}

bool has_extension(const std::string& file, const std::vector<std::string>& extensions) {
  std::string extension = fs::path(file).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return std::ranges::find(extensions, extension) != extensions.end();
}

/// The images of the first alternative that finds some.
std::vector<std::string> find_images(io::FolderWalk& walk, const fs::path& folder, const std::string& pattern,
                                     const std::vector<std::string>& extensions) {
  for (const std::string& alternative : split(pattern, '|')) {
    std::vector<std::string> files = find_one(walk, folder, alternative);
    std::erase_if(files, [&](const std::string& file) { return !has_extension(file, extensions); });
    if (!files.empty()) return files;
  }
  return {};
}

const std::vector<std::string> kColorExtensions = {".png", ".jpg", ".jpeg", ".ppm"};
const std::vector<std::string> kDepthExtensions = {".png", ".pgm", ".tif", ".tiff", ".exr", ".npy"};

bool is_list(const std::string& pattern) {
  return pattern.ends_with(".txt");
}

std::vector<std::string> find_files(io::FolderWalk& walk, const fs::path& folder, const std::string& pattern) {
  for (const std::string& alternative : split(pattern, '|'))
    if (std::vector<std::string> files = find_one(walk, folder, alternative); !files.empty()) return files;
  return {};
}

std::string first_file(io::FolderWalk& walk, const fs::path& folder, const std::string& pattern) {
  const std::vector<std::string> files = find_files(walk, folder, pattern);
  return files.empty() ? std::string() : files.front();
}

bool is_named(const fs::path& folder, const std::string& patterns) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  for (const std::string& pattern : split(patterns, '|'))
    if (matches(pattern, whole.filename().string()) || matches(pattern, whole.parent_path().filename().string()))
      return true;
  return false;
}

/// Color patterns of one folder may find the depth images, too.
void leave_out(std::vector<std::string>& files, const std::vector<std::string>& others) {
  std::erase_if(files, [&](const std::string& file) { return std::ranges::binary_search(others, file); });
}

std::optional<FolderContents> fitting(io::FolderWalk& walk, const fs::path& folder, const Layout& layout) {
  const std::string needs = layout.needs, names = layout.folder_names;
  const bool required = !needs.empty() || !names.empty();
  if (required && find_files(walk, folder, needs).empty() && !is_named(folder, names)) return std::nullopt;
  FolderContents contents{folder, &layout, first_file(walk, folder, layout.associations), {}, {}, {}, {}, {}};
  if (contents.associations.empty() && is_list(layout.color)) {
    contents.color_list = first_file(walk, folder, layout.color);
    contents.depth_list = first_file(walk, folder, layout.depth);
    if (contents.color_list.empty() || contents.depth_list.empty()) return std::nullopt;
  } else if (contents.associations.empty()) {
    contents.depth = find_images(walk, folder, layout.depth, kDepthExtensions);
    if (contents.depth.empty()) return std::nullopt;
    contents.color = find_images(walk, folder, layout.color, kColorExtensions);
    leave_out(contents.color, contents.depth);
    if (contents.color.empty()) return std::nullopt;
  }
  contents.poses = find_files(walk, folder, layout.poses);
  return contents;
}

std::optional<FolderContents> fitting_layout(io::FolderWalk& walk, const fs::path& folder) {
  for (const Layout& layout : kLayouts)
    if (auto contents = fitting(walk, folder, layout)) return contents;
  return std::nullopt;
}

/// Looks for layouts in a folder and those below it.
class Search {
 public:
  explicit Search(io::FolderWalk& walk) : walk_(walk) {}

  /// At a folder and at most `levels` below it, each folder once. Throws SourceError: too many.
  void look_at(const fs::path& folder, int levels) {
    if (!walk_.enter(folder)) return;
    if (++looked_at_ > kMostFolders)
      throw SourceError(folder.string() + " and the folders next to it are more than " + std::to_string(kMostFolders) +
                        ": name the one with the sequence");
    if (auto contents = fitting_layout(walk_, folder)) {
      found.push_back(*contents);
    } else if (levels > 0) {
      for (const io::FolderEntry& entry : walk_.entries(folder))
        if (entry.is_folder) look_at(folder / entry.name, levels - 1);
    }
  }

  std::vector<FolderContents> found;

 private:
  static constexpr int kMostFolders = 1000;
  io::FolderWalk& walk_;
  int looked_at_ = 0;
};

std::string known_layouts() {
  std::string names;
  for (const Layout& layout : kLayouts) names += (names.empty() ? "" : ", ") + std::string(layout.name);
  return names;
}

SourceError several(const fs::path& folder, const std::vector<FolderContents>& found) {
  constexpr std::size_t kShown = 8;
  std::string text = folder.string() + " holds " + std::to_string(found.size()) + " sequences: name one of them:";
  for (std::size_t i = 0; i < std::min(kShown, found.size()); ++i) text += "\n  " + found[i].folder.string();
  return SourceError(text + (found.size() > kShown ? "\n  ..." : ""));
}

SourceError unknown(const fs::path& folder, const io::FolderWalk& walk) {
  if (!walk.led_out().empty())
    return SourceError("folder " + folder.string() + " has no colour and depth: " + walk.led_out().string() +
                       " is a link that leads out of it; " + kOutsideAdvice);
  if (const std::string advice = advice_for_folder(folder); !advice.empty()) return SourceError(advice);
  return SourceError("folder " + folder.string() + " has no colour and depth in a layout that is known (" +
                     known_layouts() +
                     "). TUM's needs rgb.txt and depth.txt, or associations.txt; without lists, put the "
                     "colour images (PNG, JPEG) into rgb/ and the depth images (" +
                     "16-bit PNG, PGM, TIFF, EXR, npy) of the same numbers into depth/");
}

constexpr int kLevels = 3;  // an archive unpacks into its own folder, and that holds chess/seq-01

}  // namespace

fs::path FolderContents::below(const std::string& file) const {
  return outside ? fs::path() : file.starts_with("../") ? folder / ".." : folder;
}

std::vector<std::string> find_files(const FolderContents& contents, const std::string& pattern) {
  io::FolderWalk walk(contents.below());
  try {
    return find_files(walk, contents.folder, pattern);
  } catch (const io::IoError&) {  // of a folder above with too many files
    return {};
  }
}

FolderContents recognise_folder(const fs::path& folder, bool outside) {
  std::error_code error;
  if (const std::string advice = advice_for_file(folder); !advice.empty()) throw SourceError(advice);
  if (!fs::exists(folder, error)) throw SourceError("folder " + folder.string() + " does not exist");
  if (!fs::is_directory(folder, error)) throw SourceError(folder.string() + " is not a folder");
  io::FolderWalk walk(outside ? fs::path() : folder);
  Search search(walk);
  try {
    search.look_at(folder, kLevels);
  } catch (const io::IoError& failure) {
    throw SourceError(failure.what());
  }
  if (search.found.size() > 1) throw several(folder, search.found);
  if (search.found.empty()) throw unknown(folder, walk);
  search.found.front().outside = outside;
  return search.found.front();
}

}  // namespace rtd::camera
