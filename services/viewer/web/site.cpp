// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/web/site.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace rtd::viewer {
namespace {

const char* mime_type(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  return "application/octet-stream";
}

bool is_plain(std::string_view name) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./";
  return name.find_first_not_of(kLetters) == std::string_view::npos && name.find("..") == std::string_view::npos;
}

}  // namespace

std::optional<SiteFile> Site::file(std::string_view path) const {
  if (!path.starts_with('/') || !is_plain(path)) return std::nullopt;
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
  if (!name.ends_with(".js")) return std::nullopt;
  std::ifstream file(three_ / name, std::ios::binary);
  if (!file) return std::nullopt;
  return SiteFile{
      .content = std::string(std::istreambuf_iterator<char>(file), {}), .type = mime_type(name), .keeps = true};
}

bool Site::has_three() const {
  return std::filesystem::exists(three_ / "three.module.js");
}

}  // namespace rtd::viewer
