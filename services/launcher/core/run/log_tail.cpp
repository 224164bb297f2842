// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/log_tail.hpp"

#include <algorithm>

namespace rtd::launcher {
namespace {

constexpr std::size_t kMaxLineBytes = 4096;

std::string_view second_token(std::string_view line) {
  const std::size_t space = line.find(' ');
  if (space == std::string_view::npos) return {};
  const std::string_view rest = line.substr(space + 1);
  return rest.substr(0, rest.find(' '));
}

/// The text without ANSI colour sequences around it.
std::string_view strip_color(std::string_view text) {
  while (!text.empty() && text.front() == '\033') text.remove_prefix(std::min(text.find('m'), text.size() - 1) + 1);
  return text.substr(0, text.find('\033'));
}

}  // namespace

void LineSplitter::feed(std::string_view bytes, const std::function<void(const std::string&)>& on_line) {
  for (const char c : bytes) {
    if (c == '\n' || rest_.size() >= kMaxLineBytes) {
      on_line(rest_);
      rest_.clear();
    }
    if (c != '\n' && c != '\r') rest_.push_back(c);
  }
}

void LineSplitter::finish(const std::function<void(const std::string&)>& on_line) {
  if (!rest_.empty()) on_line(rest_);
  rest_.clear();
}

void LogTail::add(const std::string& line) {
  lines_.push_back(line);
  if (lines_.size() > max_lines_) lines_.pop_front();
}

LogLevel level_of(std::string_view line) {
  if (line.rfind("rtd-", 0) == 0 || line.rfind("terminate called", 0) == 0) return LogLevel::kError;
  const std::string_view text = strip_color(second_token(line));
  if (text == "warning") return LogLevel::kWarning;
  if (text == "error" || text == "critical") return LogLevel::kError;
  return LogLevel::kInfo;
}

std::vector<std::string> reason_lines(const std::vector<std::string>& tail) {
  for (auto line = tail.rbegin(); line != tail.rend(); ++line) {
    if (level_of(*line) == LogLevel::kError) return {*line};
  }
  return tail;
}

}  // namespace rtd::launcher
