// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::eval {

/// Public datasets whose sequences are known by the names of their folders.
enum class Dataset { kTum, kBonn, kOpenloris };

struct NamedDataset {
  Dataset dataset;
  const char* name;         ///< on the command line
  const char* title;        ///< for people
  const char* folder_form;  ///< how its folders are named
};

inline constexpr std::array<NamedDataset, 3> kDatasets{{
    {Dataset::kTum, "tum", "TUM RGB-D", "rgbd_dataset_freiburgN_NAME"},
    {Dataset::kBonn, "bonn", "Bonn RGB-D Dynamic", "rgbd_bonn_NAME"},
    {Dataset::kOpenloris, "openloris", "OpenLORIS-Scene", "office1-1, corridor1-2, cafe1-1, ..."},
}};

const NamedDataset& named(Dataset dataset);
/// Null for an unknown name.
const NamedDataset* find_dataset(std::string_view name);

/// The short name of a sequence: fr3_walking_xyz of rgbd_dataset_freiburg3_walking_xyz, crowd of rgbd_bonn_crowd. Empty
/// when the dataset has no folder of such a name.
std::string sequence_name(Dataset dataset, const std::string& folder_name);

/// The sequences over which publications give the mean; none: there is no such mean.
std::span<const char* const> mean_sequences(Dataset dataset);

/// A sequence that can be run.
struct Sequence {
  std::string name;  ///< the short one
  std::filesystem::path folder;
  std::size_t frames = 0;  ///< colour images in its list
};

/// What was found and is left out.
struct LeftOut {
  std::string folder;
  std::string reason;  ///< the cause and the fix
};

struct FoundSequences {
  std::vector<Sequence> sequences;  ///< by name
  std::vector<LeftOut> left_out;
};

/// The sequences of a dataset in `folders` and below them, and what cannot be run: incomplete, still packed, without
/// ground truth, of another dataset, of no known name, there twice. Throws service::ConfigError for a folder that does
/// not exist.
FoundSequences find_sequences(Dataset dataset, const std::vector<std::string>& folders);

/// Makes the folder `into` in TUM's layout of a sequence of OpenLORIS-Scene, for the colour camera of its D435i: lists,
/// calibration.yaml from sensors.yaml, the ground truth moved from the robot's base to the camera by trans_matrix.yaml,
/// and links to the images. Depth is in millimetres. Throws camera::SourceError naming file, cause and fix.
void prepare_openloris(const std::filesystem::path& sequence, const std::filesystem::path& into);

}  // namespace rtd::eval
