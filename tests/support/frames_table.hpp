// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace rtd::test_support {

/// Frames, with their children where there are any, of a topic: "map", "map -> odom".
using Links = std::set<std::string>;

inline std::string link(const std::string& frame, const std::string& child) {
  return child.empty() ? frame : frame + " -> " + child;
}

/// The rows of docs/frames.md, "One map at a time", by topic. The camera and its base are the camera's frame.
inline std::map<std::string, Links> table_of_frames() {
  const std::string camera = "camera_color_optical_frame";
  std::ifstream file(RTD_FRAMES_PAGE);
  const std::regex row(R"(^\| (`rt/[^|]*) \| `?([a-z]+)`? \| ?([^|]*?) ?\|.*)"), name("`([a-z_]+)`|(camera) or base"),
      topic("`(rt/[a-z0-9_/]+)`");
  std::map<std::string, Links> table;
  for (std::string line; std::getline(file, line);) {
    std::smatch cells;
    if (!std::regex_match(line, cells, row)) continue;
    const std::string topics = cells[1], children = cells[3], frame = cells[2] == "camera" ? camera : cells[2].str();
    Links links;
    for (std::sregex_iterator child(children.begin(), children.end(), name), end; child != end; ++child)
      links.insert(link(frame, (*child)[1].matched ? (*child)[1].str() : camera));
    if (links.empty()) links.insert(frame);
    for (std::sregex_iterator each(topics.begin(), topics.end(), topic), end; each != end; ++each)
      table[(*each)[1]].insert(links.begin(), links.end());
  }
  return table;
}

}  // namespace rtd::test_support
