// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/web/site.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "common/io/input_file.hpp"

namespace rtd::viewer {
namespace {

namespace fs = std::filesystem;

const char* mime_type(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  return "application/octet-stream";
}

constexpr std::size_t kMaxSeen = 100'000;  // Debian has 600 files; what a wrong folder has is not listed to its end

bool lies_in(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

/// The scripts below the folder, by their names in requests, with links resolved. Those that lead out are left out.
std::map<std::string, fs::path> scripts_below(const fs::path& three) {
  std::map<std::string, fs::path> files;
  std::error_code error;
  const fs::path folder = fs::canonical(three, error);
  if (error) return files;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  const fs::recursive_directory_iterator end;
  for (std::size_t seen = 0; !error && entry != end && seen++ < kMaxSeen; entry.increment(error)) {
    if (entry->path().extension() != ".js") continue;
    std::error_code unusable;
    const fs::path file = fs::canonical(entry->path(), unusable);
    if (unusable || !lies_in(file, folder) || !fs::is_regular_file(file, unusable)) continue;
    files.emplace(entry->path().lexically_relative(folder).string(), file);
  }
  return files;
}

}  // namespace

Site::Site(const fs::path& three) : three_(scripts_below(three)) {}

std::optional<SiteFile> Site::file(std::string_view path) const {
  if (!path.starts_with('/')) return std::nullopt;
  std::string name(path.substr(1));
  constexpr std::string_view kThree = "three/";
  if (name.starts_with(kThree)) return three_file(name.substr(kThree.size()));
  if (name.empty()) name = "index.html";
  const auto known = page_files().find(name);
  if (known == page_files().end()) return std::nullopt;
  return SiteFile{.content = std::string(known->second), .type = mime_type(name)};
}

/// Its modules import "../build/three.module.js", which Debian has one folder up.
std::optional<SiteFile> Site::three_file(std::string name) const {
  constexpr std::string_view kBuild = "build/";
  if (name.starts_with(kBuild)) name.erase(0, kBuild.size());
  const auto known = three_.find(name);
  if (known == three_.end()) return std::nullopt;
  std::optional<std::string> script = io::try_read_file(known->second, {"a script", 16 * io::kMegabyte});
  if (!script) return std::nullopt;
  return SiteFile{.content = *std::move(script), .type = mime_type(name), .keeps = true};
}

bool Site::has_three() const {
  return three_.contains("three.module.js");
}

}  // namespace rtd::viewer
