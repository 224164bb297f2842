// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <iostream>
#include <memory>

#include "common/io/printable.hpp"

namespace rtd::service {

/// Of messages: paths and lists of names are long, what a program did not expect may be longer.
inline constexpr std::size_t kLongestLine = 2000;

/// First thing in main. Gives a closed stdin, stdout or stderr (`2>&-`) to /dev/null: the next file that is opened
/// would get its number, and messages would be written into that file. From now on all that is written to std::cout
/// and std::cerr is printable, whoever wrote what it quotes, and lines of std::cerr have an end; std::clog is stderr as
/// it is, for who moves the cursor.
inline void prepare_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) < 0) ::open("/dev/null", O_RDWR);  // takes the lowest free number, this one
  }
  // Never destroyed: threads may still write while the process ends.
  [[maybe_unused]] static const auto* const out = std::make_unique<io::PrintableOutput>(std::cout).release();
  [[maybe_unused]] static const auto* const err =
      std::make_unique<io::PrintableOutput>(std::cerr, kLongestLine).release();
}

/// The same, and output that is no longer read (`| head -1`) is dropped instead of ending the process: a run, or a
/// service, continues to its results. For tools whose only result is what they print, the signal is right.
inline void outlive_readers() {
  prepare_standard_streams();
  ::signal(SIGPIPE, SIG_IGN);
}

}  // namespace rtd::service
