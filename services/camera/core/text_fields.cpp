// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/text_fields.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr double kMaxStampS = 9e9;  // int64 ns end at 9.22e9 s

/// "12.034" -> 12034000000; empty when there is an exponent or anything but digits and one point.
std::optional<std::int64_t> parse_plain_decimal_ns(std::string_view text) {
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  if (error != std::errc() || end != whole.data() + whole.size() || whole.front() == '-') return std::nullopt;
  std::int64_t fraction_ns = 0, unit_ns = kNsPerSecond;
  const std::string_view fraction = point == std::string_view::npos ? std::string_view{} : text.substr(point + 1);
  for (const char c : fraction) {
    if (c < '0' || c > '9') return std::nullopt;
    unit_ns /= 10;
    fraction_ns += (c - '0') * unit_ns;
  }
  return seconds * kNsPerSecond + fraction_ns;
}

}  // namespace

std::vector<TextLine> split_lines(const std::string& text) {
  std::vector<TextLine> lines;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    TextLine result{number, {}};
    for (std::string word; words >> word;) result.fields.push_back(word);
    if (!result.fields.empty()) lines.push_back(std::move(result));
  }
  return lines;
}

std::vector<TextLine> read_lines(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw SourceError("cannot read " + file.string());
  std::ostringstream text;
  text << stream.rdbuf();
  return split_lines(text.str());
}

std::optional<double> parse_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_stamp_ns(const std::string& text, const std::string& where) {
  const std::optional<double> seconds = parse_number(text);
  if (!seconds) return std::nullopt;
  if (!std::isfinite(*seconds) || std::abs(*seconds) > kMaxStampS) {
    throw SourceError(where + ": stamp '" + text + "' is not a finite time in seconds; correct or remove the line");
  }
  const std::optional<std::int64_t> exact = parse_plain_decimal_ns(text);
  return exact ? *exact : static_cast<std::int64_t>(std::llround(*seconds * static_cast<double>(kNsPerSecond)));
}

std::string at_line(const std::filesystem::path& file, int line) {
  return file.string() + ":" + std::to_string(line);
}

}  // namespace rtd::camera
