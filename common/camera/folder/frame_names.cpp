// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/folder/frame_names.hpp"

#include <charconv>
#include <filesystem>
#include <optional>
#include <regex>

#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

std::optional<std::int64_t> integer(const std::string& digits) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error != std::errc()) return std::nullopt;
  return value;
}

/// Nanoseconds of a time since 1970 that is written in milliseconds, microseconds or nanoseconds, by its digits.
std::optional<std::int64_t> epoch_ns(const std::string& digits) {
  constexpr std::size_t kMilli = 13, kMicro = 16, kNano = 19;
  if (digits.empty() || digits.front() != '1') return std::nullopt;  // until 2033; others are numbers
  const std::int64_t unit_ns = digits.size() == kMilli ? 1'000'000 : digits.size() == kMicro ? 1'000 : 1;
  if (digits.size() != kMilli && digits.size() != kMicro && digits.size() != kNano) return std::nullopt;
  return *integer(digits) * unit_ns;
}

std::optional<std::int64_t> time_of(const std::string& stem) {
  static const std::regex seconds("(^|[^0-9.])([0-9]{6,11}\\.[0-9]+)($|[^0-9.])");
  static const std::regex number_and_micros("([0-9]+)-([0-9]{12})"), digits("(^|[^0-9])([0-9]{13,19})($|[^0-9])");
  std::smatch found;
  if (std::regex_search(stem, found, seconds)) return io::parse_stamp_ns(found[2]);
  if (std::regex_match(stem, found, number_and_micros)) return *integer(found[2]) * 1'000;
  if (std::regex_search(stem, found, digits)) return epoch_ns(found[2]);
  return std::nullopt;
}

/// The last of the longest runs of digits.
std::optional<std::int64_t> number_of(const std::string& stem) {
  constexpr std::int64_t kMost = 1'000'000'000;
  std::string longest, run;
  for (const char letter : stem + ' ') {
    if (letter >= '0' && letter <= '9') {
      run += letter;
    } else {
      if (run.size() >= longest.size() && !run.empty()) longest = run;
      run.clear();
    }
  }
  const std::optional<std::int64_t> number = integer(longest);
  if (!number || *number > kMost) return std::nullopt;
  return *number * kNumberNs;
}

template <class Read>
std::optional<NamedFrames> read_all(const std::vector<std::string>& files, FrameNames kind, const Read& read) {
  NamedFrames frames{kind, {}};
  for (const std::string& file : files) {
    const std::optional<std::int64_t> stamp_ns = read(std::filesystem::path(file).stem().string());
    if (!stamp_ns) return std::nullopt;
    frames.files.push_back({*stamp_ns, file});
  }
  return frames;
}

}  // namespace

NamedFrames read_frame_names(const std::vector<std::string>& files) {
  if (auto times = read_all(files, FrameNames::kTimes, time_of)) return *times;
  if (auto numbers = read_all(files, FrameNames::kNumbers, number_of)) return *numbers;
  return {};
}

}  // namespace rtd::camera
