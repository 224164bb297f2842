// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/command_line.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/service/standard_streams.hpp"

namespace rtd::service {
namespace {

constexpr std::chrono::milliseconds kRewriteEvery{200}, kRepeatEvery{10000};
constexpr std::size_t kBarCells = 20;

/// Lines of at most 100 characters; what does not fit continues in the column of the descriptions.
class WrappedHelp final : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::istringstream lines(CLI::Formatter::make_help(app, std::move(name), mode));
    std::string text;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() && (text.empty() || text.ends_with("\n\n"))) continue;
      while (line.size() > kColumns) {
        const std::size_t end = line.rfind(' ', kColumns);
        if (end == std::string::npos || end <= get_column_width()) break;
        text += line.substr(0, end) + '\n';
        line = std::string(line.front() == ' ' ? get_column_width() : 0, ' ') + line.substr(end + 1);
      }
      text += line + '\n';
    }
    return text;
  }

 private:
  static constexpr std::size_t kColumns = 100;
};

}  // namespace

void wrap_help(CLI::App& app) {
  app.formatter(std::make_shared<WrappedHelp>());
}

namespace {

/// The command whose options were written: that of the last subcommand.
const CLI::App& innermost(const CLI::App& app) {
  const auto commands = app.get_subcommands();
  return commands.empty() ? app : innermost(*commands.front());
}

/// "--sorce (did you mean --source?)".
std::string with_advice(const CLI::App& command, const std::string& word) {
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  const std::string near = word.starts_with("--") ? io::nearest_name(word.substr(0, word.find('=')), known) : "";
  return near.empty() ? word : word + " (did you mean " + near + "?)";
}

/// CLI11 quotes what was given, all of it: the words of the command line, or what is between their '=' and ','.
std::string with_short_values(std::string message, int argc, const char* const* argv) {
  constexpr std::size_t kShort = 120;
  for (int i = 1; i < argc && message.size() > kShort; ++i) {
    std::string_view value = argv[i];
    while (value.size() > kShort) {
      if (const std::size_t place = message.find(value); place != std::string::npos)
        message.replace(place, value.size(), io::abridged(value));
      value.remove_prefix(std::min(value.find_first_of("=,"), value.size() - 1) + 1);
    }
  }
  return message;
}

void parse_words(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::RequiredError&) {
    std::vector<std::string> unknown;
    for (const std::string& word : app.remaining(true)) {
      if (word.starts_with("-") && word.size() > 1) unknown.push_back(with_advice(innermost(app), word));
    }
    if (unknown.empty()) throw;
    throw CLI::ExtrasError(unknown);
  }
}

}  // namespace

void parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    parse_words(app, argc, argv);
  } catch (const CLI::ParseError& error) {
    const std::string shown = with_short_values(error.what(), argc, argv);
    if (shown == error.what()) throw;
    throw CLI::ParseError(shown, error.get_exit_code());
  }
}

int run_command(CLI::App& app, int argc, const char* const* argv, const std::function<int()>& work) {
  prepare_standard_streams();
  try {
    parse(app, argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsageOrConfig;
  }
  return work();
}

InterruptSignals::InterruptSignals() {
  // A shell starts background jobs with SIGINT ignored, and an ignored signal never reaches the descriptor.
  for (const int number : {SIGINT, SIGTERM}) std::signal(number, SIG_DFL);
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, number);
  pthread_sigmask(SIG_BLOCK, &signals, &previous_);
  fd_ = signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
}

InterruptSignals::~InterruptSignals() {
  take();
  close(fd_);
  pthread_sigmask(SIG_SETMASK, &previous_, nullptr);
}

int InterruptSignals::take() {
  int count = 0;
  signalfd_siginfo info{};
  while (read(fd_, &info, sizeof(info)) == static_cast<ssize_t>(sizeof(info))) ++count;
  return count;
}

std::string progress_line(const std::string& work, std::uint64_t done, std::uint64_t total, double elapsed_s) {
  const double part = total == 0 ? 1 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  const auto cells = static_cast<std::size_t>(part * kBarCells);
  const std::string left = part > 0 ? fmt::format(", {:.0f} s left", elapsed_s * (1 - part) / part) : "";
  return fmt::format("{} [{}{}] {:3.0f} %{}", work, std::string(cells, '#'), std::string(kBarCells - cells, '.'),
                     100 * part, left);
}

Progress::Progress(std::ostream& err, std::string work, std::uint64_t total)
    : err_(err),
      work_(std::move(work)),
      total_(total),
      interactive_(&err == &std::cerr && isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (interactive_ && shown_) io::rewrite_terminal_line("");
}

void Progress::reach(std::uint64_t done) {
  done_ = done;
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + (interactive_ ? kRewriteEvery : kRepeatEvery);
  const std::string line = progress_line(work_, done_, total_, std::chrono::duration<double>(now - started_).count());
  if (interactive_) {
    io::rewrite_terminal_line(line);
  } else {
    err_ << line << std::endl;
  }
  shown_ = true;
}

std::string bytes_text(std::uint64_t bytes) {
  if (bytes < 1000) return fmt::format("{} B", bytes);
  constexpr std::array kUnits = {"kB", "MB", "GB", "TB"};
  double value = static_cast<double>(bytes) / 1000;
  std::size_t unit = 0;
  for (; value >= 999.5 && unit + 1 < kUnits.size(); ++unit) value /= 1000;
  return fmt::format("{:.{}f} {}", value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0, kUnits[unit]);
}

std::string seconds_text(std::uint64_t duration_ns) {
  return fmt::format("{:.3f} s", static_cast<double>(duration_ns) * 1e-9);
}

std::string time_text(std::uint64_t time_ns) {
  constexpr std::uint64_t kNsPerSecond = 1'000'000'000, kYear2000S = 946'684'800, kYear2100S = 4'102'444'800;
  const std::uint64_t seconds = time_ns / kNsPerSecond;
  if (seconds < kYear2000S || seconds >= kYear2100S) return seconds_text(time_ns);
  const std::tm utc = fmt::gmtime(static_cast<std::time_t>(seconds));
  return fmt::format("{:%Y-%m-%d %H:%M:%S}.{:03} UTC", utc, time_ns % kNsPerSecond / 1'000'000);
}

}  // namespace rtd::service
