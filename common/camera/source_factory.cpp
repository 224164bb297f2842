// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/source_factory.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "common/camera/folder/folder_source.hpp"
#include "common/camera/live_uri.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/camera/synthetic/synthetic_source.hpp"
#include "common/camera/unread_forms.hpp"
#include "common/io/printable.hpp"
#include "common/io/recording_forms.hpp"
#include "common/io/text.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/parts.hpp"

namespace rtd::camera {

namespace {

/// Video nodes give depth that is not registered to colour, and no calibration that could register it.
void refuse_video_nodes(const std::string& text) {
  if (!text.starts_with("v4l2:")) return;
  throw SourceError("source '" + io::abridged(text) +
                    "': V4L2 cameras give no depth that is registered to colour; use the camera through openni2:, "
                    "realsense-dds: or its ROS 2 driver (ros2:COLOR,DEPTH)");
}

}  // namespace

SourceUri parse_source_uri(const std::string& text) {
  refuse_video_nodes(text);
  const std::size_t colon = text.find(':');
  if (const std::string advice = advice_for_file(text.substr(0, text.find('?'))); !advice.empty())
    throw SourceError(advice);
  if (colon == std::string::npos || colon == 0) {
    throw SourceError("source '" + io::abridged(text) + "' has no scheme; write " + all_source_forms());
  }
  SourceUri uri{text, text.substr(0, colon), text.substr(colon + 1), {}};
  const std::size_t question = uri.path.find('?');
  if (question == std::string::npos) return uri;
  std::istringstream parameters(uri.path.substr(question + 1));
  uri.path.resize(question);
  for (std::string part; std::getline(parameters, part, '&');) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw SourceError("source '" + io::abridged(text) + "': parameter '" + io::abridged(part) + "' is not key=value");
    }
    if (!uri.parameters.emplace(part.substr(0, equals), part.substr(equals + 1)).second) {
      throw SourceError("source '" + io::abridged(text) + "': parameter '" + io::abridged(part.substr(0, equals)) +
                        "' occurs twice");
    }
  }
  return uri;
}

std::int64_t parse_tolerance_ns(const std::string& uri, const std::string& value) {
  constexpr double kMaxMs = 1000;
  const std::optional<double> ms = io::parse_number(value);
  if (!ms || !(*ms > 0) || *ms > kMaxMs) {
    throw SourceError("source '" + io::abridged(uri) + "': tolerance_ms is '" + io::abridged(value) +
                      "', allowed: more than 0, at most 1000");
  }
  return static_cast<std::int64_t>(*ms * 1e6);
}

bool parse_flag(const std::string& uri, const std::string& key, const std::string& value) {
  if (value != "0" && value != "1") {
    throw SourceError("source '" + io::abridged(uri) + "': " + key + " is 0 or 1, not '" + io::abridged(value) + "'");
  }
  return value == "1";
}

namespace {

/// Lists of the form that tum: is named after.
bool has_tum_lists(const std::filesystem::path& folder) {
  std::error_code none;
  const auto has = [&](const char* list) { return std::filesystem::exists(folder / list, none); };
  return has("associations.txt") || (has("rgb.txt") && has("depth.txt"));
}

std::string folder_scheme(const std::filesystem::path& folder) {
  if (recordings::holds_recording(folder)) return "mcap:";
  return has_tum_lists(folder) ? "tum:" : "folder:";
}

}  // namespace

std::string complete_uri(const std::string& source) {
  const std::filesystem::path path = source.substr(0, source.find('?'));
  const bool has_scheme = path.string().find(':') != std::string::npos;
  if (has_scheme || !advice_for_file(path).empty()) return source;
  if (std::error_code none; std::filesystem::is_directory(path, none)) return folder_scheme(path) + source;
  if (io::is_packed_name(path)) return "mcap:" + source;
  const std::string extension = path.extension();
  if (extension.empty()) return source;
  const auto scheme = std::ranges::find(kSourceSchemes, extension, &SourceScheme::extension);
  return scheme == kSourceSchemes.end() ? source : std::string(scheme->name) + ':' + source;
}

namespace {

std::unique_ptr<FrameSource> make_folder_source(const SourceUri& uri) {
  FolderSource::Options options;
  for (const auto& [key, value] : uri.parameters) {
    if (key == "masks" || key == "outside") {
      (key == "masks" ? options.masks : options.outside) = parse_flag(uri.text, key, value);
    } else if (key == "tolerance_ms") {
      options.tolerance_ns = parse_tolerance_ns(uri.text, value);
    } else if (!take_calibration_parameter(options.calibration, uri.text, key, value)) {
      throw SourceError("source '" + io::abridged(uri.text) + "': unknown parameter '" + io::abridged(key) + "'; " +
                        uri.scheme + ": knows masks, outside, tolerance_ms, fps, " + kCalibrationParameters);
    }
  }
  if (uri.path.empty())
    throw SourceError("source '" + io::abridged(uri.text) + "' needs a folder: " + uri.scheme + ":FOLDER");
  return std::make_unique<FolderSource>(uri.text, uri.path, std::move(options));
}

RecordingOptions recording_options(const SourceUri& uri) {
  if (uri.path.empty())
    throw SourceError("source '" + io::abridged(uri.text) + "' needs a file: " + uri.scheme + ":FILE");
  RecordingOptions options;
  const std::map<std::string, std::string*> known = {{"color", &options.topics.color},
                                                     {"depth", &options.topics.depth},
                                                     {"info", &options.topics.info},
                                                     {"depth_info", &options.topics.depth_info}};
  for (const auto& [key, value] : uri.parameters) {
    if (const auto found = known.find(key); found != known.end()) {
      *found->second = value;
    } else if (key != "fps" && take_calibration_parameter(options.calibration, uri.text, key, value)) {
      continue;
    } else if (key == "registered") {
      options.registered = parse_flag(uri.text, key, value);
    } else if (key == "tolerance_ms") {
      options.tolerance_ns = parse_tolerance_ns(uri.text, value);
    } else {
      throw SourceError("source '" + io::abridged(uri.text) + "': unknown parameter '" + io::abridged(key) + "'; " +
                        uri.scheme + ": knows color, depth, info, depth_info, registered, tolerance_ms, " +
                        kCalibrationParameters);
    }
  }
  return options;
}

/// Bags and databases are read where they lie; all else, also folders and packed ones of these, as MCAP.
std::unique_ptr<recordings::Reader> open_file(const SourceUri& uri) {
  using recordings::Form;
  std::error_code none;
  const bool lies_there = !std::filesystem::is_directory(uri.path, none) && !io::is_packed_name(uri.path);
  const Form form = uri.scheme == "bag" ? Form::kBag : uri.scheme == "db3" ? Form::kDb3 : Form::kMcap;
  try {
    return recordings::open_reader(uri.path, lies_there ? form : Form::kMcap);
  } catch (const mcap::RecordingFileError& error) {
    throw SourceError(error.what());
  }
}

std::unique_ptr<FrameSource> make_recording_source(const SourceUri& uri) {
  const RecordingOptions options = recording_options(uri);
  return open_recording(uri.text, open_file(uri), options);
}

bool is_recording(const SourceUri& uri) {
  return is_of_kind(uri.text, SourceKind::kRecording);
}

}  // namespace

std::vector<RecordedTopic> auxiliary_topics(const std::string& text) {
  const SourceUri uri = parse_source_uri(text);
  if (!is_recording(uri)) return {};
  const std::unique_ptr<recordings::Reader> recording = open_file(uri);
  std::vector<RecordedTopic> auxiliary = recording->topics();
  std::vector<std::string> names = transform_topics(*recording);
  if (const std::string own = own_frames_topic(*recording); !own.empty()) {
    names.push_back(own);
  } else {
    const ImageTopics used = choose_topics(*recording, recording_options(uri).topics);
    names.insert(names.end(), {used.color, used.depth, used.info, used.depth_info});
  }
  std::erase_if(auxiliary, [&](const auto& topic) { return std::ranges::find(names, topic.name) != names.end(); });
  return auxiliary;
}

std::unique_ptr<recordings::Reader> recording_of(const std::string& text) {
  const SourceUri uri = parse_source_uri(text);
  return is_recording(uri) ? open_file(uri) : nullptr;
}

std::unique_ptr<FrameSource> make_source(const std::string& text) {
  const SourceUri uri = parse_source_uri(text);
  if (is_of_kind(text, SourceKind::kFolder)) return make_folder_source(uri);
  if (uri.scheme == "synthetic") return std::make_unique<SyntheticSource>(uri.text, parse_synthetic_options(uri));
  if (is_recording(uri)) return make_recording_source(uri);
  if (is_live(text)) {
    throw SourceError(
        "source '" + io::abridged(text) +
        "' is a running camera: only `rtd run` and rtd-camera play it; record it first (rtd record) and use mcap:FILE");
  }
  std::vector<std::string> known;
  for (const SourceScheme& scheme : kSourceSchemes) known.emplace_back(scheme.name);
  std::ranges::sort(known);
  throw SourceError("source '" + io::abridged(text) + "': unknown scheme '" + io::abridged(uri.scheme) +
                    "'; known: " + msg::word_list(known, ", "));
}

}  // namespace rtd::camera
