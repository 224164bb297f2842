// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/unread_forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "common/io/byte_sink.hpp"
#include "common/io/folder_walk.hpp"
#include "common/io/input_file.hpp"
#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

struct UnreadForm {
  const char* ending;
  const char* what;
  const char* advice;
};

constexpr const char *kArchive = "an archive", *kVideo = "a video without depth";
constexpr const char* kTar = "unpack it (tar xf FILE) and give the folder";
constexpr const char* kNoDepth = "give a folder of colour and depth images, or a recording with both";

constexpr std::array kUnreadForms = {
    UnreadForm{".tgz", kArchive, kTar},
    UnreadForm{".tar.gz", kArchive, kTar},
    UnreadForm{".tar.bz2", kArchive, kTar},
    UnreadForm{".tar.xz", kArchive, kTar},
    UnreadForm{".tar.zst", kArchive, kTar},
    UnreadForm{".tar", kArchive, kTar},
    UnreadForm{".zip", kArchive, "unpack it (unzip FILE) and give the folder"},
    UnreadForm{".7z", kArchive, "unpack it (7z x FILE) and give the folder"},
    UnreadForm{".rar", kArchive, "unpack it (unrar x FILE) and give the folder"},
    UnreadForm{".bag.gz", "a packed bag", "unpack it (gunzip FILE) and give the bag"},
    UnreadForm{
        ".mkv", "a recording of Azure Kinect",
        "write its frames with Open3D (azure_kinect_mkv_reader.py --input FILE --output FOLDER) and give FOLDER, "
        "which has color/, depth/ and intrinsic.json"},
    UnreadForm{".klg", "a log of Kintinuous or ElasticFusion",
               "export its frames as colour and depth images into rgb/ and depth/ and give the folder with "
               "?intrinsics=fx,fy,cx,cy&depth_factor=1000"},
    UnreadForm{".sens", "a ScanNet stream",
               "export it with ScanNet's SensReader (reader.py --filename FILE --output_path FOLDER "
               "--export_color_images --export_depth_images --export_poses --export_intrinsics) and give FOLDER"},
    UnreadForm{".svo2", "a recording of a ZED camera",
               "play it with the ZED ROS 2 wrapper (svo_path:=FILE) and use ros2:COLOR,DEPTH, or record that with "
               "ros2 bag record"},
    UnreadForm{".svo", "a recording of a ZED camera",
               "play it with the ZED ROS 2 wrapper (svo_path:=FILE) and use ros2:COLOR,DEPTH, or record that with "
               "ros2 bag record"},
    UnreadForm{".r3d", "a recording of Record3D",
               "export it in Record3D as EXR + RGB images (it is also a zip archive, whose depth is compressed) and "
               "give that folder"},
    UnreadForm{
        ".db", "a database of RTAB-Map",
        "export its images in rtabmap-databaseViewer (RGB-D SLAM format) and give the folder; databases of rosbag2 "
        "end with .db3"},
    UnreadForm{".mp4", kVideo, kNoDepth},
    UnreadForm{".avi", kVideo, kNoDepth},
    UnreadForm{".mov", kVideo, kNoDepth},
};

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return text;
}

/// Half of the 1920 x 1440 px, as a frame may not have so many.
std::string advice_for_stray_scanner(const fs::path& folder) {
  std::error_code none;
  if (!fs::exists(folder / "rgb.mp4", none) || !fs::exists(folder / "camera_matrix.csv", none)) return {};
  return fmt::format(
      "{0} is a recording of Stray Scanner, whose colour is a video: take its frames out (mkdir {0}/rgb; ffmpeg -i "
      "{0}/rgb.mp4 -vf scale=iw/2:ih/2 -start_number 0 {0}/rgb/%06d.png) and give the folder again",
      folder.string());
}

}  // namespace

std::string advice_for_file(const fs::path& file) {
  std::error_code error;
  const std::string name = in_lower_case(file.filename().string());
  const auto form =
      std::ranges::find_if(kUnreadForms, [&](const UnreadForm& one) { return name.ends_with(one.ending); });
  if (form == kUnreadForms.end() || fs::is_directory(file, error)) return {};
  std::string advice = form->advice;
  for (std::size_t at = 0; (at = advice.find("FILE", at)) != std::string::npos; at += file.string().size())
    advice.replace(at, 4, file.string());
  return file.string() + " is " + form->what + ", which is not read as it is: " + advice;
}

std::string advice_for_folder(const fs::path& folder) {
  if (std::string advice = advice_for_stray_scanner(folder); !advice.empty()) return advice;
  for (const fs::path& file : io::FolderWalk().paths(folder))
    if (std::string advice = advice_for_file(file); !advice.empty()) return advice;
  return {};
}

}  // namespace rtd::camera
