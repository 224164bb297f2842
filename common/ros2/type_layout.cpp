// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/type_layout.hpp"

#include <cctype>
#include <map>
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

/// Where the body of each struct begins, behind "struct NAME {".
std::map<std::string, std::size_t> bodies_in(const std::vector<std::string>& words) {
  std::map<std::string, std::size_t> bodies;
  for (std::size_t i = 0; i + 3 < words.size(); ++i)
    if (words[i] == "struct" && words[i + 2] == "{") bodies.try_emplace(words[i + 1], i + 3);
  return bodies;
}

}  // namespace

std::string layout_in(const std::string& idl, const std::string& struct_name) {
  const std::vector<std::string> words = words_of(idl);
  std::map<std::string, std::size_t> bodies = bodies_in(words);  // that are not written yet
  std::string layout;
  std::vector<std::string> structs{struct_name};
  for (std::size_t next = 0; next < structs.size(); ++next) {
    const auto body = bodies.extract(structs[next]);
    if (!body || words[body.mapped()] == "}") continue;
    layout += structs[next] + ": ";
    for (std::size_t i = body.mapped(); i < words.size() && words[i] != "}"; ++i) {
      layout += words[i] + ' ';
      if (bodies.contains(words[i])) structs.push_back(words[i]);
    }
  }
  return layout;
}

}  // namespace rtd::ros2
