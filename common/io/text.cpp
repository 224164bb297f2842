// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>

#include "common/io/printable.hpp"

namespace rtd::io {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr double kMaxStampS = 9.2e9;  // int64 nanoseconds end at 9.22e9 s

std::vector<std::string> split_fields(std::string_view line, std::string_view separators) {
  std::vector<std::string> fields;
  std::size_t begin = line.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const std::size_t end = line.find_first_of(separators, begin);
    fields.emplace_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
  return fields;
}

/// "12.034" -> 12034000000; empty when there is anything but digits and one point. A double would lose the last digits
/// of a Unix time.
std::optional<std::int64_t> parse_plain_decimal_ns(std::string_view text) {
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  const std::string_view fraction = point == std::string_view::npos ? std::string_view{} : text.substr(point + 1);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (!std::ranges::all_of(whole, is_digit) || !std::ranges::all_of(fraction, is_digit)) return std::nullopt;
  std::int64_t seconds = 0;
  std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  std::int64_t fraction_ns = 0, unit_ns = kNsPerSecond;
  for (const char digit : fraction) {
    unit_ns /= 10;
    fraction_ns += (digit - '0') * unit_ns;
  }
  return seconds * kNsPerSecond + fraction_ns;
}

int edit_distance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

}  // namespace

std::vector<TextLine> split_lines(std::string_view text, std::string_view separators) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<TextLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    TextLine split{number, split_fields(line.substr(0, line.find('#')), separators)};
    if (!split.fields.empty()) lines.push_back(std::move(split));
  }
  return lines;
}

bool get_line(std::istream& in, std::string& line) {
  constexpr std::size_t kLongest = 1U << 16;
  line.clear();
  for (char c = 0; in.get(c);) {
    if (c == '\n') return true;
    if (line.size() == kLongest) return false;
    line += c;
  }
  return !line.empty();
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string without_numbers(std::string_view text) {
  const auto in_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '/'; };
  const auto in_number = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.'; };
  std::string kind;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins = std::isdigit(static_cast<unsigned char>(text[i])) != 0 && (i == 0 || !in_word(text[i - 1]));
    kind += begins ? '#' : text[i];
    while (begins && i + 1 < text.size() && in_number(text[i + 1])) ++i;
  }
  return kind;
}

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  std::string best;
  int best_distance = static_cast<int>(std::max<std::size_t>(2, name.size() / 3)) + 1;
  for (const std::string& candidate : candidates) {
    const auto [shorter, longer] = std::minmax({name.size(), candidate.size()});
    if (longer - shorter >= static_cast<std::size_t>(best_distance)) continue;  // so many are to be added
    const int distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::int64_t parse_stamp_ns(const std::string& text) {
  const std::optional<double> seconds = parse_number(text);
  if (!seconds) throw std::invalid_argument("'" + io::abridged(text) + "' is not a number");
  if (!std::isfinite(*seconds)) throw StampOutOfRange("stamp '" + io::abridged(text) + "' is not a finite number");
  if (std::abs(*seconds) > kMaxStampS) {
    throw StampOutOfRange("stamp '" + io::abridged(text) + "' is out of range; stamps are in seconds, not nanoseconds");
  }
  const std::optional<std::int64_t> exact = parse_plain_decimal_ns(text);
  return exact ? *exact : std::llround(*seconds * static_cast<double>(kNsPerSecond));
}

}  // namespace rtd::io
