// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/settings/settings_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

namespace rtd::launcher {
namespace {

struct CommonSetting {
  const char* service;  ///< whose --print-config has it
  const char* key;
};

constexpr std::array kCommon = {
    CommonSetting{"filter", "bus.vendor"},
    CommonSetting{"filter", "bus.domain"},
    CommonSetting{"filter", "bus.robot"},
    CommonSetting{"filter", "bus.network.loopback_only"},
    CommonSetting{"filter", "bus.network.peers"},
    CommonSetting{"filter", "bus.security.enabled"},
    CommonSetting{"camera", "camera.start_timeout_s"},
    CommonSetting{"detector", "detector.model"},
    CommonSetting{"detector", "detector.engine"},
    CommonSetting{"detector", "detector.threads"},
    CommonSetting{"filter", "filter.mode"},
    CommonSetting{"filter", "filter.orb.feature_count"},
    CommonSetting{"filter", "filter.fusion.remove_below"},
    CommonSetting{"slam", "slam.base.camera"},
    CommonSetting{"slam", "slam.base.gravity"},
    CommonSetting{"slam", "slam.imu.topic"},
    CommonSetting{"slam", "slam.wheel.topic"},
    CommonSetting{"slam", "slam.map.load"},
    CommonSetting{"slam", "slam.map.save"},
    CommonSetting{"dense", "dense.fusion.voxel_m"},
    CommonSetting{"dense", "dense.fusion.max_depth_m"},
    CommonSetting{"viewer", "viewer.port"},
};

constexpr std::size_t kIndent = 2, kLongestSetting = 110;

std::string line_of(const PrintedSetting& setting) {
  std::string line = fmt::format("{:<28} {:<12} {}", setting.key, setting.value, setting.help);
  if (line.size() <= kLongestSetting) return line + '\n';
  const std::size_t option = setting.help.rfind(" (--");  // how to change it stays
  const std::string end = "..." + (option == std::string::npos ? std::string() : setting.help.substr(option));
  line.resize(kLongestSetting - std::min(kLongestSetting, end.size()));
  return line.substr(0, line.rfind(' ')) + ' ' + end + '\n';
}

}  // namespace

std::vector<PrintedSetting> parse_printed(const std::string& text) {
  std::vector<PrintedSetting> settings;
  std::vector<std::string> sections;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(' '), colon = line.find(':');
    if (first == std::string::npos || colon == std::string::npos || line[first] == '#') continue;
    sections.resize(std::min(sections.size(), first / kIndent));
    const std::string name = line.substr(first, colon - first);
    if (colon + 1 == line.size()) {
      sections.push_back(name);
      continue;
    }
    std::string key;
    for (const std::string& section : sections) key += section + '.';
    const std::string rest = line.substr(std::min(line.size(), colon + 2));
    const std::size_t help = rest.find("  # ");
    settings.push_back({key + name, rest.substr(0, help), help == std::string::npos ? "" : rest.substr(help + 4)});
  }
  return settings;
}

std::string settings_text(const std::function<std::string(const std::string& service)>& print_config) {
  std::map<std::string, std::vector<PrintedSetting>> printed;
  std::string text;
  for (const auto& [service, key] : kCommon) {
    const auto [found, is_new] = printed.try_emplace(service);
    if (is_new) found->second = parse_printed(print_config(service));
    const auto setting = std::ranges::find(found->second, key, &PrintedSetting::key);
    if (setting != found->second.end()) text += line_of(*setting);
  }
  return text +
         "\nChange one with its option, with --set KEY=VALUE, or in a file: --config FILE.yaml (config/rtd.yaml).\n"
         "All settings of a service: rtd SERVICE --print-config\n";
}

}  // namespace rtd::launcher
