// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <ostream>
#include <string>

#include "common/service/exit_code.hpp"

namespace CLI {
class App;
}

/// What command-line tools share.
namespace rtd::service {

/// app.parse(), but options that do not exist are named, with the nearest one that does, before those that are missing:
/// who writes --sorce has not forgotten --source. Throws CLI::ParseError.
void parse(CLI::App& app, int argc, const char* const* argv);

/// The main function of a tool: parses the command line into what `app` is bound to, then runs `work`. Returns the exit
/// code of `work`; 0 after --help, 2 for a wrong command line.
int run_command(CLI::App& app, int argc, const char* const* argv, const std::function<int()>& work);

/// Gives the help of `app` lines of at most 100 characters. Call it before subcommands are added.
void wrap_help(CLI::App& app);

/// Returns the exit code of `work`. What it throws becomes a line on `err` and exit code 2 for an error of one of the
/// types `Usage`, else 1.
template <class... Usage>
int report_errors(const std::string& program, std::ostream& err, const std::function<int()>& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    err << program << ": " << error.what() << '\n';
    return (... || (dynamic_cast<const Usage*>(&error) != nullptr)) ? kUsageOrConfig : kRunFailed;
  }
}

/// SIGINT, SIGTERM and SIGHUP as a readable descriptor. Make one before any thread is started: the threads inherit the
/// blocked mask. Child processes of PosixProcessHost start with an empty mask.
class InterruptSignals {
 public:
  InterruptSignals();
  ~InterruptSignals();
  InterruptSignals(const InterruptSignals&) = delete;
  InterruptSignals& operator=(const InterruptSignals&) = delete;

  int fd() const { return fd_; }
  /// Signals that came since the last call.
  int take();

 private:
  sigset_t previous_{};
  int fd_ = -1;
};

/// Says how far long work is: one line with a bar that is rewritten on a terminal, a line every ten seconds elsewhere;
/// nothing for work that ends within a second.
class Progress {
 public:
  /// `total` in any unit: files, bytes, ...
  Progress(std::ostream& err, std::string work, std::uint64_t total);
  ~Progress();  ///< clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// One more is done.
  void advance() { reach(done_ + 1); }
  /// So many are done.
  void reach(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;
  std::ostream& err_;
  std::string work_;
  std::uint64_t total_, done_ = 0;
  bool interactive_, shown_ = false;
  Clock::time_point started_ = Clock::now(), next_ = started_ + std::chrono::seconds(1);
};

/// "reading  [######..............]  30 %, 12 s left"
std::string progress_line(const std::string& work, std::uint64_t done, std::uint64_t total, double elapsed_s);

/// "1.54 MB", "812 B": decimal units, three digits.
std::string bytes_text(std::uint64_t bytes);
/// "12.345 s" of a duration.
std::string seconds_text(std::uint64_t duration_ns);
/// "2026-11-21 14:03:12.512 UTC" for times of this century, else seconds.
std::string time_text(std::uint64_t time_ns);

}  // namespace rtd::service
