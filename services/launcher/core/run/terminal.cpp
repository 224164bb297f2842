// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/terminal.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/io/printable.hpp"
#include "services/launcher/core/run/record_builder.hpp"

namespace rtd::launcher {
namespace {

constexpr std::chrono::milliseconds kRewriteEvery{100}, kRepeatEvery{2000};

constexpr std::size_t kLongestLine = 160;  // longer ones are continued below
constexpr const char* kContinued = "      ";

/// At the last blank that fits; a word that is longer stays whole.
std::string wrapped(const std::string& line) {
  std::string text = line, result;
  while (text.size() > kLongestLine) {
    const std::size_t indent = text.find_first_not_of(' ');
    std::size_t blank = text.rfind(' ', kLongestLine);
    if (blank == std::string::npos || blank <= indent) blank = text.find(' ', kLongestLine);
    if (blank == std::string::npos) break;
    result += text.substr(0, blank) + '\n';
    text = kContinued + text.substr(blank + 1);
  }
  return result + text;
}

/// "  12 s left", "  3 min left"; empty where that is not known.
std::string time_left(const LiveStatus& status) {
  if (status.frames >= status.total || status.frames_per_s < 0.1) return "";
  const double left_s = static_cast<double>(status.total - status.frames) / status.frames_per_s;
  return left_s < 100 ? fmt::format("  {:.0f} s left", std::ceil(left_s))
                      : fmt::format("  {:.0f} min left", left_s / 60);
}

}  // namespace

std::string format_live_status(const LiveStatus& status) {
  const std::string count = status.total > 0 ? fmt::format("frame {}/{}", status.frames, status.total)
                                             : fmt::format("frame {}", status.frames);
  if (!status.tracking) {
    return count + "  " +
           (status.camera_message.empty() ? "waiting for the first pose" : "camera " + status.camera_message);
  }
  return fmt::format("{}  {:.1f} fps  {}  inliers {}  dynamic {}  dropped {}  latency {:.0f} ms{}", count,
                     status.frames_per_s, to_string(status.state), status.inliers, status.dynamic_points,
                     status.dropped, status.latency_ms, time_left(status));
}

void Terminal::print(const std::string& line) {
  if (!options_.quiet) write(line, false);
}

void Terminal::warn(const std::string& line) {
  write(line, options_.color);
}

void Terminal::write(const std::string& line, bool colored) {
  if (!takes_line()) {
    ++left_out_;
    return;
  }
  clear_status();
  if (left_out_ > 0) out_ << "  (" << left_out_ << " messages left out, because the output was not read)\n";
  left_out_ = 0;
  out_ << (colored ? "\033[33m" : "") << wrapped(io::printable(line)) << (colored ? "\033[0m\n" : "\n") << std::flush;
}

bool Terminal::takes_line() {
  return !options_.has_room || options_.has_room();
}

void Terminal::status(const std::string& text, std::chrono::milliseconds now) {
  const std::string line = io::printable(text);
  if (options_.quiet || now < next_ || line == shown_ || !takes_line()) return;
  next_ = now + (options_.interactive ? kRewriteEvery : kRepeatEvery);
  shown_ = line;
  if (options_.interactive) {
    out_ << "\r\033[K" << line.substr(0, options_.columns - 1) << std::flush;
  } else {
    out_ << wrapped(line) << '\n' << std::flush;
  }
}

void Terminal::end_status() {
  if (options_.interactive && !shown_.empty()) out_ << '\n' << std::flush;
  shown_.clear();
}

void Terminal::clear_status() {
  if (options_.interactive && !shown_.empty()) out_ << "\r\033[K";
  shown_.clear();
  if (options_.interactive) next_ = {};
}

}  // namespace rtd::launcher
