// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// What takes a reader longest, or most memory, for so many bytes.
namespace rtd::worst {

struct Case {
  std::string name;
  std::function<void()> read;  ///< what is thrown is an answer, too
};

/// Of `bytes` each. Files are written into `folder`.
std::vector<Case> texts(std::size_t bytes, const std::filesystem::path& folder);
std::vector<Case> images(std::size_t bytes);
std::vector<Case> recordings(std::size_t bytes, const std::filesystem::path& folder);
std::vector<Case> models(std::size_t bytes, const std::filesystem::path& folder);

/// Writes `content` into a new file; returns its path.
std::filesystem::path file_of(const std::filesystem::path& folder, const std::string& name, const std::string& content);

/// `part` again and again.
std::string repeated(const std::string& part, std::size_t bytes);

}  // namespace rtd::worst
