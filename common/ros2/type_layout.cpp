// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/type_layout.hpp"

#include <cctype>
#include <set>
#include <sstream>
#include <vector>

namespace rtd::ros2 {
namespace {

/// Names, numbers and signs, without comments.
std::vector<std::string> words_of(const std::string& idl) {
  std::vector<std::string> words;
  std::istringstream lines(idl);
  for (std::string line; std::getline(lines, line);) {
    bool in_name = false;
    for (const char c : line.substr(0, line.find("//"))) {
      const bool names = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
      const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
      if (names && in_name) {
        words.back() += c;
      } else if (!blank) {
        words.emplace_back(1, c);
      }
      in_name = names;
    }
  }
  return words;
}

class LayoutReader {
 public:
  explicit LayoutReader(const std::string& idl) : words_(words_of(idl)) {}

  std::string layout_of(const std::string& struct_name) {
    if (!begun_.insert(struct_name).second) return {};
    std::string own, others;
    for (std::size_t i = body_of(struct_name); i < words_.size() && words_[i] != "}"; ++i) {
      own += words_[i] + ' ';
      others += layout_of(words_[i]);
    }
    return own.empty() ? own : struct_name + ": " + own + others;
  }

 private:
  /// Behind "struct NAME {"; the end when there is none.
  std::size_t body_of(const std::string& struct_name) const {
    for (std::size_t i = 0; i + 2 < words_.size(); ++i) {
      if (words_[i] == "struct" && words_[i + 1] == struct_name && words_[i + 2] == "{") return i + 3;
    }
    return words_.size();
  }

  const std::vector<std::string> words_;
  std::set<std::string> begun_;  ///< a damaged text may define a type by itself
};

}  // namespace

std::string layout_in(const std::string& idl, const std::string& struct_name) {
  return LayoutReader(idl).layout_of(struct_name);
}

}  // namespace rtd::ros2
