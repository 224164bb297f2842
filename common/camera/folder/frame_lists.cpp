// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/folder/frame_lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "common/camera/folder/frame_names.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

std::vector<io::TextLine> read_lines(const fs::path& file, const ListRules& rules) {
  try {
    return io::split_lines(io::read_file(file, io::kFrameList, rules.outside ? fs::path() : file.parent_path()));
  } catch (const io::IoError& error) {
    throw SourceError(why_unread(error));
  }
}

/// "folder/rgb.txt:17": for messages.
std::string at_line(const fs::path& file, int line) {
  return file.string() + ":" + std::to_string(line);
}

/// Empty when the text is not a number. Throws SourceError for a number that cannot be a time, naming `where`.
std::optional<std::int64_t> stamp_of(const std::string& text, const std::string& where) {
  try {
    return io::parse_stamp_ns(text);
  } catch (const io::StampOutOfRange& error) {
    throw SourceError(where + ": " + error.what() + "; correct or remove the line");
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// Leaves a line out. Throws SourceError when it is one of so many that the file is no list.
void leave_out(std::vector<SkippedInput>& skipped, const fs::path& file, const io::TextLine& line,
               const std::string& expected) {
  constexpr std::size_t kMost = 10'000;
  skipped.push_back({SkipReason::kMalformedLine, at_line(file, line.number) + ": expected '" + expected + "'"});
  if (skipped.size() > kMost)
    throw SourceError(file.string() + ": more than " + std::to_string(kMost) + " lines are not '" + expected +
                      "': it is not a list of frames");
}

/// Throws SourceError for an image that does not lie below the folder of its list, as far as its name says so. Whether
/// such a file is there makes no difference.
void require_inside(const StampedFile& entry, const std::string& where) {
  const fs::path path = fs::path(entry.file).lexically_normal();
  if (path.is_relative() && *path.begin() != "..") return;
  throw SourceError(where + ": '" + entry.file + "' does not lie below the folder of the list; " + kOutsideAdvice);
}

std::string joined_words(std::span<const std::string> words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// Names of Windows: a backslash separates where there is no file of that name.
std::string file_name(const fs::path& list, std::span<const std::string> words) {
  std::string name = joined_words(words);
  std::error_code none;
  if (name.find('\\') != std::string::npos && !fs::exists(list.parent_path() / name, none))
    std::ranges::replace(name, '\\', '/');
  return name;
}

/// The columns of a list with commas between them, else the words of the line: names may have blanks.
std::vector<std::string> columns_of(const io::TextLine& line) {
  if (line.fields[0].find(',') == std::string::npos) return line.fields;
  std::vector<std::string> columns;
  for (const io::TextLine& split : io::split_lines(joined_words(line.fields), ",")) columns = split.fields;
  for (std::string& column : columns) column.erase(0, column.find_first_not_of(' '));
  return columns;
}

std::vector<StampedFile> read_list(const fs::path& file, const ListRules& rules, std::vector<SkippedInput>& skipped) {
  std::vector<StampedFile> entries;
  for (const io::TextLine& line : read_lines(file, rules)) {
    const std::vector<std::string> columns = columns_of(line);
    const auto stamp_ns = columns.empty() ? std::nullopt : stamp_of(columns[0], at_line(file, line.number));
    if (stamp_ns && columns.size() > 1) {
      entries.push_back({*stamp_ns, file_name(file, std::span(columns).subspan(1))});
      if (!rules.outside) require_inside(entries.back(), at_line(file, line.number));
    } else {
      leave_out(skipped, file, line, "stamp file");
    }
  }
  return entries;
}

/// TUM's tool writes the lists in the order they were given to it: both "rgb depth" and "depth rgb" are about.
FilePair colour_first(FilePair pair) {
  const auto is_depth = [](const StampedFile& entry) { return entry.file.starts_with("depth"); };
  if (is_depth(pair.color) && !is_depth(pair.depth)) std::swap(pair.color, pair.depth);
  return pair;
}

std::vector<FilePair> read_four_columns(const fs::path& file, const ListRules& rules,
                                        std::vector<SkippedInput>& skipped) {
  std::vector<FilePair> pairs;
  for (const io::TextLine& line : read_lines(file, rules)) {
    const std::string where = at_line(file, line.number);
    const std::vector<std::string> columns = columns_of(line);
    const std::span<const std::string> words(columns);
    std::size_t second = 2;  // the second stamp: the first name may have blanks
    while (second < words.size() && !io::parse_number(words[second])) ++second;
    const auto first_ns = words.empty() ? std::nullopt : stamp_of(words[0], where);
    const auto second_ns = second + 1 < words.size() ? stamp_of(words[second], where) : std::nullopt;
    if (first_ns && second_ns) {
      pairs.push_back(colour_first({{*first_ns, file_name(file, words.subspan(1, second - 1))},
                                    {*second_ns, file_name(file, words.subspan(second + 1))}}));
      for (const StampedFile& entry : {pairs.back().color, pairs.back().depth})
        if (!rules.outside) require_inside(entry, where);
    } else {
      leave_out(skipped, file, line, "stamp rgb_file stamp depth_file");
    }
  }
  return pairs;
}

const StampedFile& color_of(const StampedFile& entry) {
  return entry;
}
const StampedFile& color_of(const FilePair& pair) {
  return pair.color;
}

/// Keeps the entries whose colour stamp is newer than all before.
template <class Entry>
std::vector<Entry> increasing(const std::vector<Entry>& entries, std::vector<SkippedInput>& skipped) {
  std::vector<Entry> kept;
  for (const Entry& entry : entries) {
    const StampedFile& color = color_of(entry);
    if (kept.empty() || color.stamp_ns > color_of(kept.back()).stamp_ns) {
      kept.push_back(entry);
    } else if (color.stamp_ns == color_of(kept.back()).stamp_ns) {
      const bool same = color.file == color_of(kept.back()).file;
      skipped.push_back({same ? SkipReason::kRepeated : SkipReason::kStampDoubled,
                         color.file + (same ? " is listed twice" : " has the stamp of the frame before")});
    } else {
      skipped.push_back({SkipReason::kStampBackwards, color.file + " is older than the frame before"});
    }
  }
  return kept;
}

/// Depth images are looked up by stamp: sorted, each stamp once.
void sort_unique(std::vector<StampedFile>& entries) {
  const auto older = [](const StampedFile& a, const StampedFile& b) { return a.stamp_ns < b.stamp_ns; };
  const auto same = [](const StampedFile& a, const StampedFile& b) { return a.stamp_ns == b.stamp_ns; };
  std::ranges::stable_sort(entries, older);
  entries.erase(std::unique(entries.begin(), entries.end(), same), entries.end());
}

/// How often a stamp is smaller than the one before, when it is so often that they are no times; else 0.
std::size_t count_backward_stamps(const std::vector<std::int64_t>& stamps_ns) {
  constexpr std::size_t kFewest = 3, kOneOf = 8;
  std::size_t backwards = 0;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) backwards += stamps_ns[i] < stamps_ns[i - 1];
  return backwards < kFewest || backwards * kOneOf < stamps_ns.size() ? 0 : backwards;
}

std::vector<std::int64_t> color_stamps(const auto& entries) {
  std::vector<std::int64_t> stamps_ns;
  for (const auto& entry : entries) stamps_ns.push_back(color_of(entry).stamp_ns);
  return stamps_ns;
}

/// A script wrote how long each frame took, for example.
void check_times(const std::vector<std::int64_t>& stamps_ns, const fs::path& list) {
  const std::size_t backwards = count_backward_stamps(stamps_ns);
  if (backwards == 0) return;
  throw SourceError(
      fmt::format("{}: its stamps are not times: {} of {} are smaller than the one before, and those frames would be "
                  "left out. Give the rate at which the frames were taken, in the order of the list: ?fps=30",
                  list.string(), backwards, stamps_ns.size()));
}

/// Whole numbers, most of them one after the other: ICL-NUIM counts frames in place of a time.
bool are_numbers(const std::vector<FilePair>& pairs) {
  constexpr std::int64_t kMost = 10'000'000;  // above: seconds since 1970
  std::size_t next = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].color.stamp_ns < 0 || pairs[i].color.stamp_ns > kMost * kNumberNs) return false;
    if (pairs[i].color.stamp_ns % kNumberNs != 0 || pairs[i].depth.stamp_ns % kNumberNs != 0) return false;
    next += i > 0 && pairs[i].color.stamp_ns == pairs[i - 1].color.stamp_ns + kNumberNs;
  }
  return pairs.size() > 3 && next * 2 > pairs.size();
}

void number_in_order(std::vector<FilePair>& pairs) {
  std::int64_t number = 0;
  for (FilePair& pair : pairs) pair.color.stamp_ns = pair.depth.stamp_ns = kNumberNs * number++;
}

/// Each colour image with the depth image that is nearest in time.
void pair_by_time(PairList& list, const std::vector<StampedFile>& color, std::vector<StampedFile> depth,
                  std::int64_t tolerance_ns) {
  sort_unique(depth);
  const std::vector<geometry::StampPair> found =
      geometry::associate(geometry::stamps_of(color), geometry::stamps_of(depth), tolerance_ns);
  list.depth_alone = depth.size() - found.size();
  auto pair = found.begin();
  for (std::size_t i = 0; i < color.size(); ++i) {
    if (pair != found.end() && pair->first == i) {
      list.pairs.push_back({color[i], depth[(pair++)->second]});
    } else {
      list.skipped.push_back(
          {SkipReason::kNoDepthPartner, fmt::format("{} has no depth image within {:g} s", color[i].file,
                                                    static_cast<double>(tolerance_ns) * 1e-9)});
    }
  }
}

/// Each colour image with the depth image of its number.
void pair_by_number(PairList& list, const std::vector<StampedFile>& color, std::vector<StampedFile> depth) {
  sort_unique(depth);
  list.depth_alone = depth.size();
  for (const StampedFile& file : color) {
    const auto partner = std::ranges::lower_bound(depth, file.stamp_ns, {}, &StampedFile::stamp_ns);
    if (partner != depth.end() && partner->stamp_ns == file.stamp_ns) {
      list.pairs.push_back({file, *partner});
      --list.depth_alone;
    } else {
      list.skipped.push_back({SkipReason::kNoDepthPartner, file.file + " has no depth image of its number"});
    }
  }
}

PairList pair_in_order(const std::vector<std::string>& color, const std::vector<std::string>& depth) {
  PairList list{{}, {}, 0, true, "in the order of their names"};
  for (std::size_t i = 0; i < std::min(color.size(), depth.size()); ++i)
    list.pairs.push_back({{0, color[i]}, {0, depth[i]}});
  list.depth_alone = depth.size() - list.pairs.size();
  number_in_order(list.pairs);
  return list;
}

std::vector<std::string> files_of(const std::vector<StampedFile>& entries) {
  std::vector<std::string> files;
  for (const StampedFile& entry : entries) files.push_back(entry.file);
  return files;
}

/// Both without a gap and as long, but one begins with 0 and the other with 1, for example.
bool counts_from_another_number(const NamedFrames& color, const NamedFrames& depth) {
  const auto range = [](const NamedFrames& frames) {
    const auto [first, last] = std::ranges::minmax(geometry::stamps_of(frames.files));
    return std::pair(first / kNumberNs, last / kNumberNs - first / kNumberNs + 1);
  };
  const auto [color_first, color_span] = range(color);
  const auto [depth_first, depth_span] = range(depth);
  const auto count = static_cast<std::int64_t>(color.files.size());
  return color_first != depth_first && color_span == count && depth_span == count;
}

}  // namespace

PairList read_associations(const fs::path& folder, const std::string& name, const ListRules& rules) {
  PairList list{{}, {}, 0, false, "by " + name};
  std::vector<FilePair> pairs = read_four_columns(folder / name, rules, list.skipped);
  list.numbered = rules.count_frames || are_numbers(pairs);
  if (rules.count_frames) number_in_order(pairs);
  if (!list.numbered) check_times(color_stamps(pairs), folder / name);
  list.pairs = increasing(pairs, list.skipped);
  return list;
}

PairList read_two_lists(const fs::path& folder, const std::string& color, const std::string& depth,
                        const ListRules& rules) {
  PairList list{{}, {}, 0, false, "by the stamps of " + color + " and " + depth};
  const std::vector<StampedFile> colors = read_list(folder / color, rules, list.skipped);
  const std::vector<StampedFile> depths = read_list(folder / depth, rules, list.skipped);
  if (rules.count_frames && count_backward_stamps(color_stamps(colors)) > 0 && colors.size() == depths.size())
    return pair_in_order(files_of(colors), files_of(depths));
  check_times(color_stamps(colors), folder / color);
  pair_by_time(list, increasing(colors, list.skipped), depths, rules.tolerance_ns);
  list.numbered = rules.count_frames || are_numbers(list.pairs);
  if (rules.count_frames) number_in_order(list.pairs);
  return list;
}

PairList pair_by_names(const std::vector<std::string>& color, const std::vector<std::string>& depth,
                       std::int64_t tolerance_ns) {
  const NamedFrames colors = read_frame_names(color), depths = read_frame_names(depth);
  if (colors.kind != depths.kind || colors.kind == FrameNames::kNeither) return pair_in_order(color, depth);
  PairList list;
  std::vector<StampedFile> sorted = colors.files;
  sort_unique(sorted);
  if (colors.kind == FrameNames::kTimes) {
    list.how = "by the times in their names";
    pair_by_time(list, sorted, depths.files, tolerance_ns);
    return list;
  }
  list.how = "by the numbers in their names";
  list.numbered = true;
  pair_by_number(list, sorted, depths.files);
  const bool fit = list.pairs.size() * 2 >= color.size() && !counts_from_another_number(colors, depths);
  if (fit || color.size() != depth.size()) return list;
  std::vector<StampedFile> depth_sorted = depths.files;
  sort_unique(depth_sorted);
  return pair_in_order(files_of(sorted), files_of(depth_sorted));
}

void apply_table(PairList& list, const fs::path& table, const ListRules& rules) {
  std::map<std::int64_t, std::int64_t> times_ns;
  for (const io::TextLine& line : read_lines(table, rules)) {
    const std::vector<std::string> columns = columns_of(line);
    if (columns.size() < 2) continue;
    const auto time_ns = stamp_of(columns[0], at_line(table, line.number));
    const auto number = stamp_of(columns[1], at_line(table, line.number));
    if (time_ns && number) times_ns[*number] = *time_ns;
  }
  std::vector<FilePair> timed = list.pairs;
  for (FilePair& pair : timed) {
    const auto time = times_ns.find(pair.color.stamp_ns);
    if (time == times_ns.end()) return;
    pair.color.stamp_ns = pair.depth.stamp_ns = time->second;
  }
  list.pairs = increasing(timed, list.skipped);
  list.numbered = false;
  list.how += ", at the times of " + table.filename().string();
}

void apply_rate(PairList& list, double fps) {
  if (list.pairs.empty()) return;
  const std::int64_t first_ns = list.pairs.front().color.stamp_ns;
  for (FilePair& pair : list.pairs) {
    const auto frames = static_cast<double>(pair.color.stamp_ns - first_ns) / static_cast<double>(kNumberNs);
    pair.color.stamp_ns = pair.depth.stamp_ns = std::llround(frames * 1e9 / fps);
  }
}

}  // namespace rtd::camera
