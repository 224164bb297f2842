// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/foreign_forms.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

struct ForeignForm {
  const char* ending;
  const char* what;
  const char* advice;
};

constexpr const char *kArchive = "an archive", *kVideo = "a video without depth";
constexpr const char* kTar = "unpack it (tar xf FILE) and give the folder";
constexpr const char* kNoDepth = "give a folder of colour and depth images, or a recording with both";

constexpr std::array kForeignForms = {
    ForeignForm{".tgz", kArchive, kTar},
    ForeignForm{".tar.gz", kArchive, kTar},
    ForeignForm{".tar.bz2", kArchive, kTar},
    ForeignForm{".tar.xz", kArchive, kTar},
    ForeignForm{".tar.zst", kArchive, kTar},
    ForeignForm{".tar", kArchive, kTar},
    ForeignForm{".zip", kArchive, "unpack it (unzip FILE) and give the folder"},
    ForeignForm{".7z", kArchive, "unpack it (7z x FILE) and give the folder"},
    ForeignForm{".rar", kArchive, "unpack it (unrar x FILE) and give the folder"},
    ForeignForm{".bag.gz", "a packed bag", "unpack it (gunzip FILE) and give the bag"},
    ForeignForm{
        ".mkv", "a recording of Azure Kinect",
        "write its frames with Open3D (azure_kinect_mkv_reader.py --input FILE --output FOLDER) and give FOLDER, "
        "which has color/, depth/ and intrinsic.json"},
    ForeignForm{".klg", "a log of Kintinuous or ElasticFusion",
                "export its frames as colour and depth images into rgb/ and depth/ and give the folder with "
                "?intrinsics=fx,fy,cx,cy&depth_factor=1000"},
    ForeignForm{".sens", "a ScanNet stream",
                "export it with ScanNet's SensReader (reader.py --filename FILE --output_path FOLDER "
                "--export_color_images --export_depth_images --export_poses --export_intrinsics) and give FOLDER"},
    ForeignForm{".svo2", "a recording of a ZED camera",
                "play it with the ZED ROS 2 wrapper (svo_path:=FILE) and use ros2:COLOR,DEPTH, or record that with "
                "ros2 bag record"},
    ForeignForm{".svo", "a recording of a ZED camera",
                "play it with the ZED ROS 2 wrapper (svo_path:=FILE) and use ros2:COLOR,DEPTH, or record that with "
                "ros2 bag record"},
    ForeignForm{".r3d", "a recording of Record3D",
                "export it in Record3D as EXR + RGB images (it is also a zip archive, whose depth is compressed) and "
                "give that folder"},
    ForeignForm{
        ".db", "a database of RTAB-Map",
        "export its images in rtabmap-databaseViewer (RGB-D SLAM format) and give the folder; databases of rosbag2 "
        "end with .db3"},
    ForeignForm{".mp4", kVideo, kNoDepth},
    ForeignForm{".avi", kVideo, kNoDepth},
    ForeignForm{".mov", kVideo, kNoDepth},
};

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return text;
}

}  // namespace

std::string advice_for_file(const fs::path& file) {
  std::error_code error;
  const std::string name = in_lower_case(file.filename().string());
  const auto form =
      std::ranges::find_if(kForeignForms, [&](const ForeignForm& one) { return name.ends_with(one.ending); });
  if (form == kForeignForms.end() || fs::is_directory(file, error)) return {};
  std::string advice = form->advice;
  for (std::size_t at = 0; (at = advice.find("FILE", at)) != std::string::npos; at += file.string().size())
    advice.replace(at, 4, file.string());
  return file.string() + " is " + form->what + ", which is not read as it is: " + advice;
}

std::string advice_for_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) files.push_back(entry.path());
  std::ranges::sort(files);
  for (const fs::path& file : files)
    if (std::string advice = advice_for_file(file); !advice.empty()) return advice;
  return {};
}

}  // namespace rtd::camera
