// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/unpack.hpp"

#include <unistd.h>
#include <zstd.h>

#include <cerrno>
#include <cstdlib>
#include <memory>
#include <vector>

namespace rtd::recordings {
namespace fs = std::filesystem;
namespace {

struct FreeStream {
  void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
};

std::uint64_t room_at(const fs::path& file) {
  std::error_code none;
  const fs::space_info space = fs::space(file.parent_path(), none);
  return none ? UINT64_MAX : space.available / 10 * 9;
}

}  // namespace

TemporaryFile::TemporaryFile() {
  std::string name = (fs::temp_directory_path() / "rtd_recording_XXXXXX").string();
  const int descriptor = mkstemp(name.data());
  if (descriptor < 0) throw io::IoError(errno, name + " cannot be made (TMPDIR names another folder)");
  close(descriptor);
  path_ = name;
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

bool is_packed(const io::ByteSource& source) {
  constexpr std::uint32_t kMagic = 0xFD2FB528;
  std::array<std::byte, 4> begin{};
  return source.read(0, begin) == begin.size() && io::load<std::uint32_t>(begin.data()) == kMagic;
}

std::string unpack(const io::ByteSource& source, io::FileSink& sink, const Progress& progress) {
  const std::unique_ptr<ZSTD_DStream, FreeStream> stream(ZSTD_createDStream());
  std::vector<std::byte> in(ZSTD_DStreamInSize()), out(ZSTD_DStreamOutSize());
  const std::uint64_t room = room_at(sink.path());
  std::size_t unfinished = 1;  // zstd's hint: 0 at the end of a frame
  std::uint64_t offset = 0;
  while (const std::size_t count = source.read(offset, in)) {
    ZSTD_inBuffer input{in.data(), count, 0};
    while (input.pos < input.size) {
      ZSTD_outBuffer output{out.data(), out.size(), 0};
      unfinished = ZSTD_decompressStream(stream.get(), &output, &input);
      if (ZSTD_isError(unfinished) != 0) {
        return std::string("damaged near byte ") + std::to_string(offset + input.pos) + ": " +
               ZSTD_getErrorName(unfinished) + "; what follows is lost";
      }
      if (sink.position() + output.pos > room) throw io::IoError(ENOSPC, "unpacked it takes more room than is free");
      sink.append({io::ByteView(out).first(output.pos)});
    }
    offset += count;
    progress(offset);
  }
  return unfinished == 0 ? std::string() : "it ends within a zstd frame; what follows is lost";
}

}  // namespace rtd::recordings
