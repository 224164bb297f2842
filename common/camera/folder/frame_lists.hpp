// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/camera/frame_source.hpp"

namespace rtd::camera {

/// "stamp file" of rgb.txt or depth.txt.
struct StampedFile {
  std::int64_t stamp_ns = 0;
  std::string file;  ///< relative to the folder
};

/// A colour image with its depth image.
struct FilePair {
  StampedFile color, depth;
};

/// The pairs of a sequence in playing order and what was left out on the way.
struct PairList {
  std::vector<FilePair> pairs;  ///< colour stamps strictly increasing
  std::vector<SkippedInput> skipped;
  std::uint64_t depth_alone = 0;  ///< depth images that no colour image was found for
  bool numbered = false;          ///< the stamps are numbers of frames, as seconds: a rate makes times of them
  std::string how;                ///< "by associations.txt": for people
};

/// What the folder's lists are read with.
struct ListRules {
  std::int64_t tolerance_ns = kPairingToleranceNs;  ///< between the stamps of colour and depth
  bool count_frames = false;                        ///< stamps of associations do not matter: frames are numbered
  bool outside = false;                             ///< images may lie outside the folder
};

/// The pairs of a list `stamp file stamp file`, as they are written; a depth image may occur twice. Throws SourceError:
/// stamps that are not finite, or that go up and down too often to be times; images outside the folder.
PairList read_associations(const std::filesystem::path& folder, const std::string& list, const ListRules& rules = {});

/// The pairs of a list of colour and one of depth, `stamp file`, closest first within the tolerance. Throws as above.
PairList read_two_lists(const std::filesystem::path& folder, const std::string& color, const std::string& depth,
                        const ListRules& rules = {});

/// The pairs of files by their names: of the same number, or, where the names are times (seconds with a point, or
/// milliseconds, microseconds, nanoseconds since 1970; Redwood's NUMBER-MICROSECONDS), closest within the tolerance; in
/// their order where the numbers do not fit, but there are as many of both.
PairList pair_by_names(const std::vector<std::string>& color, const std::vector<std::string>& depth,
                       std::int64_t tolerance_ns = kPairingToleranceNs);

/// Gives numbered frames the times of a table whose lines begin with "time, number"; they stay numbered when it lacks
/// one of them. Throws SourceError as read_associations().
void apply_table(PairList& list, const std::filesystem::path& table, const ListRules& rules);

/// Gives numbered frames times: the first at 0, `fps` of them a second.
void apply_rate(PairList& list, double fps);

}  // namespace rtd::camera
