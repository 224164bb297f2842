// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/io/recording_forms.hpp"
#include "common/msg/word_list.hpp"

namespace rtd::camera {

enum class SourceKind {
  kFolder,     ///< frames in files
  kRecording,  ///< a file, or a folder of files, with topics
  kTopics,     ///< topics of a running camera
  kDevice,     ///< a running camera of this host or network
  kScene,      ///< computed frames
};

/// A scheme of source URIs, "scheme:path?key=value&key=value".
struct SourceScheme {
  const char* name;
  SourceKind kind;
  const char* form;            ///< what to write
  const char* extension = "";  ///< of a file whose path may leave the scheme out
};

inline constexpr std::array<SourceScheme, 9> kSourceSchemes{{
    {"folder", SourceKind::kFolder, "folder:FOLDER"},
    {"tum", SourceKind::kFolder, "tum:FOLDER"},
    {"bag", SourceKind::kRecording, "bag:FILE", io::kBagExtension},
    {"db3", SourceKind::kRecording, "db3:FILE", io::kDb3Extension},
    {"mcap", SourceKind::kRecording, "mcap:FILE", io::kMcapExtension},
    {"ros2", SourceKind::kTopics, "ros2:COLOR,DEPTH[,INFO]"},
    {"openni2", SourceKind::kDevice, "openni2:[URI]", ".oni"},
    {"realsense-dds", SourceKind::kDevice, "realsense-dds:[SERIAL]"},
    {"synthetic", SourceKind::kScene, "synthetic:SCENE[?key=value&...]"},
}};

/// Of "scheme:..."; null for an unknown scheme and for a plain path.
inline const SourceScheme* scheme_of(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos) return nullptr;
  const auto found = std::ranges::find_if(
      kSourceSchemes, [&](const SourceScheme& scheme) { return uri.substr(0, colon) == scheme.name; });
  return found == kSourceSchemes.end() ? nullptr : &*found;
}

inline bool is_of_kind(std::string_view uri, SourceKind kind) {
  const SourceScheme* const scheme = scheme_of(uri);
  return scheme != nullptr && scheme->kind == kind;
}

/// "tum:FOLDER, bag:FILE, ... or synthetic:SCENE[?key=value&...]", without running cameras.
inline std::string stored_source_forms() {
  std::vector<std::string> forms;
  for (const SourceScheme& scheme : kSourceSchemes)
    if (scheme.kind != SourceKind::kTopics && scheme.kind != SourceKind::kDevice) forms.emplace_back(scheme.form);
  return msg::word_list(forms);
}

/// The same of all sources; `recording_options` follow the last form of a recording.
inline std::string all_source_forms(const std::string& recording_options = "") {
  std::vector<std::string> forms;
  std::size_t last_recording = 0;
  for (const SourceScheme& scheme : kSourceSchemes) {
    if (scheme.kind == SourceKind::kRecording) last_recording = forms.size();
    forms.emplace_back(scheme.form);
  }
  forms[last_recording] += recording_options;
  return msg::word_list(forms);
}

/// For --source.
inline std::string source_help() {
  return all_source_forms(" [?color=TOPIC&depth=TOPIC&calibration=FILE]");
}

}  // namespace rtd::camera
