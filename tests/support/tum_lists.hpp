// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/camera/folder/frame_lists.hpp"

namespace rtd::test_support {

/// The pairs of a folder with TUM's lists: by associations.txt when there is one, else by rgb.txt and depth.txt.
inline camera::PairList read_tum_lists(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder / "associations.txt"))
    return camera::read_associations(folder, "associations.txt");
  return camera::read_two_lists(folder, "rgb.txt", "depth.txt");
}

}  // namespace rtd::test_support
