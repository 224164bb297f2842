// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/output_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <regex>
#include <sstream>

#include "common/io/input_file.hpp"
#include "common/io/recording_forms.hpp"

namespace rtd::recorder {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

OutputFiles::OutputFiles(const std::string& output, bool split) {
  const fs::path path = output.ends_with('/') ? fs::path(output).parent_path() : fs::path(output);
  const bool is_file = path.extension() == io::kMcapExtension;
  folder_ = is_file ? path.parent_path() : path;
  if (folder_.empty()) folder_ = ".";
  stem_ = is_file ? path.stem() : path.filename();
  numbered_ = split || !is_file;
}

OutputFiles OutputFiles::free_beside(const std::string& output, bool split) {
  OutputFiles files(output, split);
  const std::string tail = fs::path(output).extension() == io::kMcapExtension ? io::kMcapExtension : "";
  const fs::path folder = tail.empty() ? files.folder_.parent_path() : files.folder_;
  const std::string base = folder / files.stem_;
  for (int i = 1; !files.existing().empty(); ++i) files = OutputFiles(fmt::format("{}.{}{}", base, i, tail), split);
  return files;
}

fs::path OutputFiles::file(std::size_t number) const {
  return folder_ / (numbered_ ? fmt::format("{}_{}{}", stem_, number, io::kMcapExtension) : stem_ + io::kMcapExtension);
}

bool OutputFiles::is_ours(const std::string& file_name) const {
  if (!numbered_) return file_name == stem_ + io::kMcapExtension;
  const std::string head = stem_ + '_', tail = io::kMcapExtension;
  if (file_name.size() <= head.size() + tail.size() || !file_name.starts_with(head) || !file_name.ends_with(tail)) {
    return false;
  }
  return file_name.find_first_not_of("0123456789", head.size()) == file_name.size() - tail.size();
}

std::vector<fs::path> OutputFiles::existing() const {
  std::vector<fs::path> files;
  std::error_code ignored;  // a folder that cannot be read cannot be written either, which is reported then
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    if (is_ours(entry.path().filename())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool OutputFiles::owns_metadata() const {
  static const std::regex kFile(R"(^ *- ([^ ]+\.mcap)$)");
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(metadata(), ignored);
  if (!fs::exists(status)) return true;
  if (!fs::is_regular_file(status)) return false;
  std::istringstream file(io::try_read_file(metadata(), io::kSettings).value_or(""));
  std::string line;
  if (!std::getline(file, line) || line != "rosbag2_bagfile_information:") return false;
  bool any = false;
  while (std::getline(file, line)) {
    std::smatch match;
    if (!std::regex_match(line, match, kFile)) continue;
    if (!is_ours(match[1])) return false;
    any = true;
  }
  return any;
}

bool SplitPolicy::has_room(std::uint64_t file_bytes, std::uint64_t message_bytes, std::uint64_t first_ns,
                           std::uint64_t now_ns) const {
  const bool too_large = bytes > 0 && file_bytes + message_bytes > bytes;
  const bool too_long = duration_ns > 0 && now_ns > first_ns && now_ns - first_ns >= duration_ns;
  return !too_large && !too_long;
}

std::optional<SplitPolicy> parse_split(const std::string& text) {
  static const std::map<std::string, SplitPolicy> kUnits = {
      {"kb", {1000, 0}},        {"mb", {1000'000, 0}},      {"gb", {1000'000'000, 0}},
      {"kib", {1ULL << 10, 0}}, {"mib", {1ULL << 20, 0}},   {"gib", {1ULL << 30, 0}},
      {"s", {0, kSecond}},      {"min", {0, 60 * kSecond}}, {"h", {0, 3600 * kSecond}}};
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !(number > 0) || number > 1e6) return std::nullopt;
  const auto unit = kUnits.find(lower(std::string(end, text.data() + text.size())));
  if (unit == kUnits.end()) return std::nullopt;
  const auto times = [number](std::uint64_t of_one) {
    return static_cast<std::uint64_t>(number * static_cast<double>(of_one));
  };
  return SplitPolicy{times(unit->second.bytes), times(unit->second.duration_ns)};
}

}  // namespace rtd::recorder
