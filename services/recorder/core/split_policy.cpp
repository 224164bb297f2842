// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/split_policy.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>

namespace rtd::recorder {
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

bool SplitPolicy::has_room(std::uint64_t file_bytes, std::uint64_t message_bytes, std::uint64_t first_ns,
                           std::uint64_t now_ns) const {
  const bool too_large = bytes > 0 && file_bytes + message_bytes > bytes;
  const bool too_long = duration_ns > 0 && now_ns > first_ns && now_ns - first_ns >= duration_ns;
  return !too_large && !too_long;
}

std::optional<SplitPolicy> parse_split(const std::string& text) {
  static const std::map<std::string, std::uint64_t> kSizes = {{"kb", 1000},         {"mb", 1000'000},
                                                              {"gb", 1000'000'000}, {"kib", 1ULL << 10},
                                                              {"mib", 1ULL << 20},  {"gib", 1ULL << 30}};
  static const std::map<std::string, std::uint64_t> kTimes = {
      {"s", kSecond}, {"min", 60 * kSecond}, {"h", 3600 * kSecond}};
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !(number > 0) || number > 1e6) return std::nullopt;
  const std::string unit = lower(std::string(end, text.data() + text.size()));
  if (const auto size = kSizes.find(unit); size != kSizes.end()) {
    return SplitPolicy{static_cast<std::uint64_t>(number * static_cast<double>(size->second)), 0};
  }
  if (const auto time = kTimes.find(unit); time != kTimes.end()) {
    return SplitPolicy{0, static_cast<std::uint64_t>(number * static_cast<double>(time->second))};
  }
  return std::nullopt;
}

}  // namespace rtd::recorder
