// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/parts.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <set>

#include "common/io/byte_sink.hpp"
#include "common/io/byte_source.hpp"
#include "common/io/folder_walk.hpp"
#include "common/io/input_file.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/recording_file.hpp"

namespace rtd::recordings {
namespace fs = std::filesystem;
namespace {

using mcap::RecordingFileError;

constexpr const char* kMetadata = "metadata.yaml";
constexpr std::size_t kMostParts = 10'000;

/// Of rosbag2: a folder of ROS 1 bags is not one recording.
bool has_recording_name(const fs::path& file) {
  const fs::path name = io::is_packed_name(file) ? file.stem() : file.filename();
  return io::is_recording_name(name) && name.extension() != io::kBagExtension;
}

/// Runs of digits count as numbers: "walk_10" comes after "walk_9".
std::string order_of(const fs::path& path) {
  constexpr std::size_t kDigits = 12;
  std::string order, digits;
  for (const char c : path.filename().string() + '\0') {
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      digits += c;
      continue;
    }
    if (!digits.empty()) order += std::string(kDigits - std::min(kDigits, digits.size()), '0') + digits;
    digits.clear();
    order += c;
  }
  return order;
}

/// "walk_10.db3.zstd" -> "walk_": the same for all parts of a split recording.
std::string name_without_number(const fs::path& file) {
  std::string name = file.filename().string();
  name.resize(std::min(name.find('.'), name.size()));
  name.erase(name.find_last_not_of("0123456789") + 1);
  return name;
}

/// Throws io::IoError: too many files.
std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> files = io::FolderWalk().paths(folder);
  std::erase_if(files, [](const fs::path& file) { return !has_recording_name(file); });
  std::ranges::sort(files, {}, order_of);
  return files;
}

/// Whether the file of a recording is there. Throws RecordingFileError for what is not a regular file, and for links
/// that lead out of the folder.
bool is_there(const fs::path& folder, const fs::path& file) {
  try {
    io::FileSource(file, io::Links::kFollow, folder);
    return true;
  } catch (const io::IoError& error) {
    if (error.code().value() == ENOENT || error.code().value() == ENOTDIR) return false;
    throw RecordingFileError(std::string(error.what()) +
                             (error.code().value() == EXDEV ? "; name the file itself to use it all the same" : ""));
  }
}

/// rosbag2 before Humble wrote names relative to the folder above, too; of such, and of all that lead out of the
/// folder, the last part counts.
fs::path place_of(const fs::path& folder, const std::string& name) {
  const fs::path beside = fs::path(name).lexically_normal();
  const bool inside = beside.is_relative() && *beside.begin() != "..";
  return inside && is_there(folder, folder / beside) ? folder / beside : folder / beside.filename();
}

Parts parts_by_metadata(const fs::path& folder) {
  try {
    const std::string text = io::read_file(folder / kMetadata, io::kSettings, folder);
    const YAML::Node bag = YAML::Load(text)["rosbag2_bagfile_information"];
    if (!bag) throw RecordingFileError((folder / kMetadata).string() + " describes no recording of rosbag2");
    Parts parts;
    const auto format = bag["compression_format"].as<std::string>("");
    parts.packed_messages = bag["compression_mode"].as<std::string>("") == "MESSAGE";
    if (!format.empty() && format != "zstd") {
      throw RecordingFileError(folder.string() + ": its files are compressed with '" + format +
                               "': only zstd is known");
    }
    const YAML::Node names = bag["relative_file_paths"];
    if (names.size() > kMostParts)
      throw RecordingFileError((folder / kMetadata).string() + " names more than 10000 files");
    std::set<fs::path> taken;
    for (const YAML::Node& name : names) {
      const fs::path file = place_of(folder, name.as<std::string>());
      if (!taken.insert(fs::weakly_canonical(file)).second) continue;
      is_there(folder, file) ? parts.files.push_back(file) : parts.missing.push_back(name.as<std::string>());
    }
    if (parts.files.empty()) {
      throw RecordingFileError(folder.string() + ": none of the files that " + kMetadata + " names is in it" +
                               (parts.missing.empty() ? "" : ", e.g. " + parts.missing.front()));
    }
    return parts;
  } catch (const io::IoError& error) {
    throw RecordingFileError(error.what());
  } catch (const YAML::Exception& error) {
    throw RecordingFileError((folder / kMetadata).string() + " cannot be read: " + error.what() +
                             "; name the files themselves, or remove it to take them by their names");
  }
}

}  // namespace

Parts parts_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {{path}, {}, false};
  if (fs::exists(path / kMetadata, error)) return parts_by_metadata(path);
  Parts parts;
  try {
    parts.files = recordings_in(path);
  } catch (const io::IoError& failure) {
    throw RecordingFileError(failure.what());
  }
  if (parts.files.empty()) {
    throw RecordingFileError(path.string() +
                             ": this folder holds no recording (metadata.yaml, .mcap, .db3): name a "
                             "recording or a folder with one");
  }
  std::erase_if(parts.files, [&](const fs::path& file) { return !is_there(path, file); });
  const auto differs = [&](const fs::path& file) {
    return name_without_number(file) != name_without_number(parts.files.front());
  };
  if (std::ranges::any_of(parts.files, differs)) {
    throw RecordingFileError(path.string() + ": this folder holds " + std::to_string(parts.files.size()) +
                             " recordings of different names and no metadata.yaml: name one of them, e.g. " +
                             parts.files.front().string());
  }
  return parts;
}

bool holds_recording(const fs::path& folder) {
  std::error_code none;
  try {
    return fs::exists(folder / kMetadata, none) || !recordings_in(folder).empty();
  } catch (const io::IoError&) {
    return false;
  }
}

}  // namespace rtd::recordings
