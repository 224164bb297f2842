// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/component/launcher/rtd_command.hpp"

namespace rtd::fuzz {

/// `rtd run` on an endless source with all services, a recorder beside it, and who of them lives.
class ServiceRun {
 public:
  ServiceRun(const std::string& vendor, std::uint32_t domain);

  /// False when the camera does not send within a minute.
  bool wait_for_frames();
  /// Services that said they started, and the launcher.
  std::vector<std::string> services();
  /// Process id of the newest start; -1: none.
  pid_t pid_of(const std::string& service);
  bool lives(const std::string& service);
  /// Waits until it lives, restarted or not; hands out the launcher's output meanwhile.
  bool wait_until_alive(const std::string& service, std::chrono::milliseconds timeout);
  void let_run(std::chrono::milliseconds time);
  /// Ctrl-C. Reports on stdout when a process has to be killed: what the vendor does at the end with the state that
  /// others have spoilt is not under test.
  void end();
  const std::string& output() const { return rtd_.output(); }
  /// Lines of the launcher about deaths and restarts, each once.
  std::vector<std::string> take_deaths();

 private:
  launcher::ScratchFolder scratch_;
  const std::string out_;
  launcher::RtdCommand rtd_, recorder_;
  std::size_t deaths_reported_ = 0;
};

}  // namespace rtd::fuzz
