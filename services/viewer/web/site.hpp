// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace rtd::viewer {

/// A file as the browser gets it.
struct SiteFile {
  std::string content;
  const char* type = "";  ///< MIME
  bool keeps = false;     ///< may be cached for a day: belongs to a library
};

/// The page's own files, compiled in, by path: "index.html", "app.js".
const std::map<std::string, std::string_view>& page_files();

/// What is served over HTTP: the page at "/", and three.js at "/three/". Both are fixed lists of names: a request never
/// becomes a path. Immutable, so thread-safe.
class Site {
 public:
  /// `three`: the folder of Debian's libjs-three. Lists the .js files that are in it now; links that lead out of it are
  /// left out.
  explicit Site(const std::filesystem::path& three);
  /// Empty: there is no such file.
  std::optional<SiteFile> file(std::string_view path) const;
  bool has_three() const;

 private:
  std::optional<SiteFile> three_file(std::string name) const;
  std::map<std::string, std::filesystem::path> three_;  ///< by name below the folder
};

}  // namespace rtd::viewer
