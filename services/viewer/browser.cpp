// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/browser.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "common/io/atomic_file.hpp"

namespace rtd::viewer {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// In a session of its own: the browser outlives the viewer, and Ctrl-C is not for it.
bool start_detached(const char* program, std::string argument) {
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_t files;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  posix_spawn_file_actions_init(&files);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, descriptor, "/dev/null", O_RDWR, 0);
  std::string name = program;
  const std::array<char*, 3> arguments{name.data(), argument.data(), nullptr};
  pid_t process = 0;
  const bool started = posix_spawnp(&process, program, &files, &attributes, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return started;
}

}  // namespace

bool open_in_browser(const std::string& address) {
  const std::string folder = variable("XDG_RUNTIME_DIR");
  const bool display = !variable("DISPLAY").empty() || !variable("WAYLAND_DISPLAY").empty();
  if (folder.empty() || !display || !variable("SSH_CONNECTION").empty()) return false;
  const std::string file = folder + "/rtd-viewer.html";
  try {
    io::write_file(file, fmt::format("<!doctype html><meta http-equiv=refresh content=\"0; url={}\">\n", address));
  } catch (const io::IoError&) {
    return false;
  }
  return start_detached("xdg-open", file);
}

}  // namespace rtd::viewer
