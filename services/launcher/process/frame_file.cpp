// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/process/frame_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/service/config.hpp"

namespace rtd::launcher {

FrameFile::FrameFile(const std::string& folder) {
  std::string path = folder + "/frames.XXXXXX";
  const int fd = ::mkostemp(path.data(), O_CLOEXEC);
  if (fd < 0) throw service::ConfigError("--out " + folder + ": cannot be written: " + std::strerror(errno));
  ::unlink(path.c_str());
  file_.reset(::fdopen(fd, "w+b"));
}

/// After a failure the file may end within a frame: nothing follows.
bool FrameFile::append(const run_record::FrameRecord& frame) {
  if (full_) return false;
  run_record::for_each_column(frame, [&](const char*, const auto& value) {
    full_ = full_ || std::fwrite(&value, sizeof value, 1, file_.get()) != 1;
  });
  return !full_;
}

std::vector<run_record::FrameRecord> FrameFile::read() {
  std::vector<run_record::FrameRecord> frames;
  std::fflush(file_.get());
  std::rewind(file_.get());
  for (bool whole = true;;) {
    run_record::FrameRecord frame;
    run_record::for_each_column(frame, [&](const char*, auto& value) {
      whole = whole && std::fread(&value, sizeof value, 1, file_.get()) == 1;
    });
    if (!whole) break;
    frames.push_back(frame);
  }
  std::fseek(file_.get(), 0, SEEK_END);
  return frames;
}

}  // namespace rtd::launcher
