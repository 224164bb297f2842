// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/recording_file.hpp"

#include <array>
#include <filesystem>
#include <string_view>

#include "common/mcap/byte_sink.hpp"
#include "common/mcap/framing.hpp"
#include "common/mcap/recording_path.hpp"

namespace rtd::launcher {
namespace {

struct KnownFormat {
  std::string_view begin;
  const char* advice;
};

constexpr std::array kOtherFormats = {
    KnownFormat{"#ROSBAG V2.0", "a ROS 1 bag: play it with --source bag:FILE or make an MCAP of it with 'rtd convert'"},
    KnownFormat{"SQLite format 3", "a rosbag2 database: make an MCAP of it with 'ros2 bag convert'"},
    KnownFormat{"\x28\xb5\x2f\xfd", "compressed with zstd: unpack it first ('zstd -d')"},
    KnownFormat{"\x04\x22\x4d\x18", "compressed with LZ4: unpack it first ('lz4 -d')"},
    KnownFormat{"version https://git-lfs", "a pointer of Git LFS: fetch the file itself with 'git lfs pull'"},
    KnownFormat{"\x1f\x8b", "compressed with gzip: unpack it first ('gunzip')"},
};

std::string first_bytes(const mcap::ByteSource& source) {
  std::array<std::byte, 24> bytes{};
  const std::size_t count = source.read(0, bytes);
  return {reinterpret_cast<const char*>(bytes.data()), count};
}

std::string explain(const mcap::ByteSource& source) {
  const std::string begin = first_bytes(source);
  if (begin.empty()) return "the file is empty: nothing was recorded, or the disk was full from the start";
  for (const KnownFormat& format : kOtherFormats)
    if (begin.starts_with(format.begin)) return std::string("this is ") + format.advice;
  return "this is no MCAP file: it does not begin with its magic; 'rtd record' writes them";
}

}  // namespace

bool looks_like_recording(const std::string& path) {
  try {
    return looks_like_recording(mcap::FileSource(mcap::recording_path(path)));
  } catch (const mcap::IoError& error) {
    throw RecordingFileError(error.what());
  }
}

bool looks_like_recording(const mcap::ByteSource& source) {
  if (first_bytes(source).starts_with(mcap::kMagic)) return true;
  const mcap::SourceWindow window(source);
  const auto header = mcap::frame_at(window, mcap::kMagic.size());
  return header && header->opcode == mcap::Opcode::kHeader && mcap::begins_record(window, mcap::kMagic.size());
}

mcap::FileSource open_recording(const std::string& path) {
  try {
    const std::filesystem::path file = mcap::recording_path(path);
    const mcap::FileSource source(file);
    if (!looks_like_recording(source)) throw RecordingFileError(path + ": " + explain(source));
    return mcap::FileSource(file);
  } catch (const mcap::IoError& error) {
    throw RecordingFileError(error.what());
  }
}

}  // namespace rtd::launcher
