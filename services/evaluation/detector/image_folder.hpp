// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rtd::launcher {

/// Every `step`-th image of a folder (jpg, jpeg, png, bmp), by name. Throws EvalDetectorError when there is no such
/// folder or no image in it; `option` is what names it on the command line.
std::vector<std::filesystem::path> images_in(const std::string& folder, const std::string& option, int step);

/// The file in `folder` that has the same name as `image` and one of the `endings`; empty when there is none.
std::filesystem::path partner_of(const std::filesystem::path& image, const std::string& folder,
                                 const std::vector<std::string>& endings);

/// Throws EvalDetectorError when `folder` is none.
void require_folder(const std::string& folder, const std::string& option);

}  // namespace rtd::launcher
