// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <initializer_list>

namespace rtd::service {

/// Gives a closed stdin, stdout or stderr (`2>&-`) to /dev/null. The next file that is opened would get its number, and
/// messages would be written into that file. First thing in main.
inline void hold_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) < 0) ::open("/dev/null", O_RDWR);  // takes the lowest free number, this one
  }
}

/// The same, and output that is no longer read (`| head -1`) is dropped instead of ending the process: a run, or a
/// service, continues to its results. For tools whose only result is what they print, the signal is right.
inline void outlive_readers() {
  hold_standard_streams();
  ::signal(SIGPIPE, SIG_IGN);
}

}  // namespace rtd::service
