// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "common/process/posix_process_host.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::launcher {

/// Runs `rtd` as a user does: another process, its output caught, Ctrl-C as a signal.
class RtdCommand {
 public:
  explicit RtdCommand(std::string executable = RTD_EXECUTABLE) : executable_(std::move(executable)) {}

  void start(const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {executable_};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command_.clear();
    for (const std::string& word : command) command_ += word + ' ';
    process_ = host_.start({"rtd", command});
  }
  void interrupt() const { ::kill(static_cast<pid_t>(process_), SIGINT); }

  /// The exit code; a test failure and -1 when it did not end in time.
  int wait(std::chrono::milliseconds timeout = std::chrono::seconds(60)) {
    const auto give_up = std::chrono::steady_clock::now() + timeout;
    while (std::chrono::steady_clock::now() < give_up) {
      host_.wait(std::chrono::milliseconds(20));
      if (const auto exit = host_.poll_exit(process_)) return exit->signal != 0 ? -exit->signal : exit->code;
    }
    ADD_FAILURE() << command_ << "did not end in time:\n" << output_;
    host_.kill(process_);
    return -1;
  }
  int run(const std::vector<std::string>& arguments) {
    start(arguments);
    return wait();
  }
  /// Lets it run until its output holds `text`; false when that did not come.
  bool wait_for(const std::string& text, std::chrono::milliseconds timeout = std::chrono::seconds(30)) {
    const auto give_up = std::chrono::steady_clock::now() + timeout;
    while (output_.find(text) == std::string::npos && std::chrono::steady_clock::now() < give_up) {
      host_.wait(std::chrono::milliseconds(20));
    }
    return output_.find(text) != std::string::npos;
  }
  /// Takes what it has printed; no other code does, and with a full pipe it would stand still.
  void take_output() { host_.wait(std::chrono::milliseconds(0)); }
  const std::string& output() const { return output_; }
  /// The same with lines as they were printed.
  const std::string& printed() const { return printed_; }
  process::ProcessId process() const { return process_; }

 private:
  std::string executable_, command_, output_, printed_;
  process::ProcessId process_ = 0;
  /// A line that is continued below the one before is put behind it.
  void add(const std::string& line) {
    constexpr const char* kContinued = "      ";
    printed_ += line + '\n';
    const bool continues = line.starts_with(kContinued) && output_.ends_with('\n');
    if (continues) output_.back() = ' ';
    output_ += (continues ? line.substr(line.find_first_not_of(' ')) : line) + '\n';
  }
  process::PosixProcessHost host_{[this](const std::string&, const std::string& line) { add(line); }};
};

/// A folder of its own for each test, removed at the end.
class ScratchFolder : public test::TemporaryFolder {
 public:
  std::string operator/(const std::string& name) const { return file(name); }
};

inline std::string text_of(const std::string& path) {
  return test::read_text(path);
}

/// The process of a service, by its log; -1: it has not started.
inline pid_t pid_in(const std::string& log) {
  std::smatch found;
  return std::regex_search(log, found, std::regex("event=started .*pid=([0-9]+)")) ? std::stoi(found[1]) : -1;
}

/// As kill(2), but never to process -1, which is all processes of this host.
inline int send_signal(pid_t process, int signal) {
  return process > 1 ? ::kill(process, signal) : -1;
}

}  // namespace rtd::launcher
