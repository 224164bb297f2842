// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "common/camera/folder/frame_lists.hpp"

namespace rtd::camera {

/// Axes of the camera that the poses of a dataset belong to.
enum class PoseAxes {
  kOptical,  ///< x right, y down, z forward
  kNed,      ///< x forward, y right, z down (TartanAir)
};

/// A form of folders with colour and depth. Patterns are those of a shell, in any case, `|` separates
/// alternatives, of which the first that finds a file counts; lists end with .txt, everything else names images.
struct Layout {
  const char* name;
  const char* needs;               ///< what must be there besides; empty: nothing
  const char* folder_names;        ///< or what the folder, or the one that it lies in, is called
  const char* associations;        ///< a list of pairs, used before colour and depth
  const char *color, *depth;       ///< both lists, or both images
  const char* calibration;         ///< first before the files that any folder may have
  const char* depth_calibration;   ///< of another lens
  const char* poses;               ///< ground truth: a file, or one for each frame
  double depth_factor = 0;         ///< units of a metre in integers; 0: seen by the images
  double fps = 30;                 ///< of frames without times, Hz
  std::array<double, 6> camera{};  ///< fx fy cx cy width height that all such data have; else 0
  PoseAxes axes = PoseAxes::kOptical;
  const char* note = "";    ///< what must be known
  const char* stamps = "";  ///< a table "time, number" of numbered frames
};

/// A folder and what its layout found in it; files are relative to it.
struct FolderContents {
  std::filesystem::path folder;
  const Layout* layout = nullptr;
  std::string associations, color_list, depth_list;  ///< lists that are there
  std::vector<std::string> color, depth;             ///< images, where there is no list
  std::vector<std::string> poses;
  bool outside = false;  ///< files may lie elsewhere: by links, and where lists say so

  /// The folder that one of the files found, or an image of a list (""), must lie below; empty: it may lie anywhere.
  std::filesystem::path below(const std::string& file = "") const;
};

/// The first layout that fits, of the folder or of the only folder below that has one; `outside`: links may lead out of
/// it. Throws SourceError: no such folder, none fits, several below it, too many, or only forms without a reader.
FolderContents recognise_folder(const std::filesystem::path& folder, bool outside = false);

/// The files of a folder that a pattern finds, sorted by name.
std::vector<std::string> find_files(const FolderContents& contents, const std::string& pattern);

}  // namespace rtd::camera
