// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/recording_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <vector>

#include "common/io/byte_sink.hpp"
#include "common/io/folder_walk.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/framing.hpp"

namespace rtd::mcap {
namespace fs = std::filesystem;
namespace {

struct KnownFormat {
  std::string_view begin;
  const char* advice;
};

constexpr std::array kOtherFormats = {
    KnownFormat{io::kBagMagic,
                "a ROS 1 bag: 'rtd info' shows what it contains, --source bag:FILE plays it, and 'rtd convert FILE.bag "
                "NEW.mcap' makes an MCAP file of it"},
    KnownFormat{
        io::kDb3Magic,
        "a rosbag2 database: 'rtd info' shows what it contains, --source db3:FILE plays it, and 'rtd convert FILE.db3 "
        "NEW.mcap' makes an MCAP file of it"},
    KnownFormat{io::kZstdMagic, "compressed with zstd: unpack it first ('zstd -d')"},
    KnownFormat{"\x04\x22\x4d\x18", "compressed with LZ4: unpack it first ('lz4 -d')"},
    KnownFormat{"version https://git-lfs", "a pointer of Git LFS: fetch the file itself with 'git lfs pull'"},
    KnownFormat{"\x1f\x8b", "compressed with gzip: unpack it first ('gunzip')"},
};

std::string first_bytes(const io::ByteSource& source) {
  std::array<std::byte, 24> bytes{};
  const std::size_t count = source.read(0, bytes);
  return {reinterpret_cast<const char*>(bytes.data()), count};
}

std::string other_format(const io::ByteSource& source) {
  const std::string begin = first_bytes(source);
  for (const KnownFormat& format : kOtherFormats)
    if (begin.starts_with(format.begin)) return format.advice;
  return {};
}

std::string explain(const io::ByteSource& source) {
  if (source.size() == 0) return "the file is empty: nothing was recorded, or the disk was full from the start";
  if (const std::string other = other_format(source); !other.empty()) return "this is " + other;
  return "this is not an MCAP file: it does not begin with the MCAP magic; 'rtd record' writes such files";
}

}  // namespace

fs::path recording_path(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return path;
  std::vector<fs::path> files = io::FolderWalk().paths(path);
  std::erase_if(files, [](const fs::path& file) { return file.extension() != io::kMcapExtension; });
  if (files.size() == 1) return files.front();
  if (files.empty())
    throw io::IoError(EISDIR,
                      path.string() + ": this folder holds no .mcap file: name a recording or a folder with one");
  throw io::IoError(EISDIR, path.string() + ": this folder holds " + std::to_string(files.size()) +
                                " .mcap files: name one of them, e.g. " + files.front().string() +
                                ", or join them: rtd record join " + path.string() + " -o FILE");
}

std::string other_format(const std::string& path) {
  try {
    return other_format(io::FileSource(recording_path(path)));
  } catch (const io::IoError& error) {
    throw RecordingFileError(error.what());
  }
}

bool looks_like_recording(const io::ByteSource& source) {
  if (first_bytes(source).starts_with(kMagic)) return true;
  const SourceWindow window(source);
  const auto header = frame_at(window, kMagic.size());
  return header && header->opcode == Opcode::kHeader && begins_record(window, kMagic.size());
}

void require_recording(const io::ByteSource& source, const std::string& path) {
  if (!looks_like_recording(source)) throw RecordingFileError(path + ": " + explain(source));
}

io::FileSource open_recording(const std::string& path) {
  try {
    const fs::path file = recording_path(path);
    require_recording(io::FileSource(file), path);
    return io::FileSource(file);
  } catch (const io::IoError& error) {
    throw RecordingFileError(error.what());
  }
}

}  // namespace rtd::mcap
