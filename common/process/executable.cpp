// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/process/executable.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <set>
#include <sstream>

#include "common/service/config.hpp"

namespace rtd::process {
namespace fs = std::filesystem;
namespace {

constexpr char kPrefix[] = "rtd-";

std::vector<fs::path> search_directories() {
  std::vector<fs::path> directories = {own_directory()};
  const char* path = std::getenv("PATH");
  std::stringstream entries(path == nullptr ? "" : path);
  for (std::string entry; std::getline(entries, entry, ':');) {
    if (!entry.empty()) directories.emplace_back(entry);
  }
  return directories;
}

bool is_executable(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0;
}

std::vector<char*> argument_vector(const std::string& executable, const std::vector<std::string>& arguments) {
  std::vector<char*> argv = {const_cast<char*>(executable.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  return argv;
}

}  // namespace

std::string own_directory() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path().string();
}

std::string find_executable(const std::string& name) {
  for (const fs::path& directory : search_directories()) {
    const fs::path candidate = directory / name;
    if (is_executable(candidate)) return candidate.string();
  }
  return {};
}

std::string missing_executable(const std::string& name) {
  const bool viewer = name == "rtd-viewer";
  const std::string package = viewer ? "rtd-slam-viewer" : "rtd-slam";
  return name + " is neither next to rtd (" + own_directory() + ") nor in PATH: install the package " + package +
         ", or build it with 'cmake --build <build folder> --target " + name + "'" +
         (viewer ? " (needs libboost-dev and libjs-three)" : "");
}

std::string require_executable(const std::string& name) {
  std::string path = find_executable(name);
  if (path.empty()) throw service::ConfigError(missing_executable(name));
  return path;
}

std::vector<std::string> installed_commands() {
  std::set<std::string> names;
  for (const fs::path& directory : search_directories()) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(directory, error)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with(kPrefix) && name.find('.') == std::string::npos && is_executable(entry.path())) {
        names.insert(name.substr(sizeof(kPrefix) - 1));
      }
    }
  }
  return {names.begin(), names.end()};
}

std::string replace_process(const std::string& executable, const std::vector<std::string>& arguments) {
  const std::vector<char*> argv = argument_vector(executable, arguments);
  execv(argv[0], argv.data());
  return "cannot run " + executable + ": " + std::strerror(errno);
}

std::string start_companion(const std::string& executable, const std::vector<std::string>& arguments) {
  const std::vector<char*> argv = argument_vector(executable, arguments);
  const pid_t parent = getpid(), pid = fork();
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(1);  // it died before the line above
    dup2(STDERR_FILENO, STDOUT_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  return pid > 0 ? "" : "cannot run " + executable + ": " + std::strerror(errno);
}

std::string output_of(const std::string& executable, const std::vector<std::string>& arguments) {
  std::string command = "'" + executable + "'", text;
  for (const std::string& argument : arguments) command += " '" + argument + "'";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((command + " 2>/dev/null").c_str(), "r"), pclose);
  std::array<char, 4096> part{};
  while (pipe != nullptr && std::fgets(part.data(), static_cast<int>(part.size()), pipe.get()) != nullptr)
    text += part.data();
  return text;
}

int run_in_foreground(const std::string& executable, const std::vector<std::string>& arguments) {
  const std::vector<char*> argv = argument_vector(executable, arguments);
  const pid_t pid = fork();
  if (pid == 0) {
    execv(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (pid < 0) return 126;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace rtd::process
