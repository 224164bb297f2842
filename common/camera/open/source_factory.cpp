// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/open/source_factory.hpp"

#include <algorithm>
#include <filesystem>

#include "common/camera/folder/folder_source.hpp"
#include "common/camera/live_uri.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/camera/synthetic/synthetic_source.hpp"
#include "common/io/printable.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/parts.hpp"

namespace rtd::camera {

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
