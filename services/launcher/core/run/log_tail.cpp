// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/log_tail.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace rtd::launcher {
namespace {

constexpr std::size_t kMaxLineBytes = 4096;

bool one_of(const std::string& word, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return word == w; });
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
  std::string word;
  for (const char c : line) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
    } else if (!word.empty()) {
      break;
    } else if (c != '[' && c != ' ') {
      return LogLevel::kInfo;
    }
  }
  if (one_of(word, {"warning", "warn", "w"})) return LogLevel::kWarning;
  if (one_of(word, {"error", "err", "critical", "fatal", "e"})) return LogLevel::kError;
  return LogLevel::kInfo;
}

std::vector<std::string> reason_lines(const std::vector<std::string>& tail) {
  for (auto line = tail.rbegin(); line != tail.rend(); ++line) {
    if (level_of(*line) == LogLevel::kError) return {*line};
  }
  return tail;
}

}  // namespace rtd::launcher
