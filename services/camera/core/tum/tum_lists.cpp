// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/tum/tum_lists.hpp"

#include <algorithm>

#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

void check_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) throw SourceError("folder " + folder.string() + " does not exist");
  if (!fs::is_directory(folder, error)) throw SourceError(folder.string() + " is not a folder");
  const bool listed = fs::exists(folder / "rgb.txt", error) && fs::exists(folder / "depth.txt", error);
  if (!listed && !fs::exists(folder / "associations.txt", error)) {
    throw SourceError("folder " + folder.string() +
                      " is not a TUM sequence: it needs rgb.txt and depth.txt, or associations.txt");
  }
}

std::vector<io::TextLine> read_lines(const fs::path& file) {
  const std::optional<std::string> text = io::read_text(file);
  if (!text) throw SourceError("cannot read " + file.string());
  return io::split_lines(*text);
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

SkippedInput malformed(const fs::path& file, const io::TextLine& line, const std::string& expected) {
  return {SkipReason::kMalformedLine, at_line(file, line.number) + ": expected '" + expected + "'"};
}

std::vector<StampedFile> read_list(const fs::path& file, std::vector<SkippedInput>& skipped) {
  std::vector<StampedFile> entries;
  for (const io::TextLine& line : read_lines(file)) {
    const auto stamp_ns = stamp_of(line.fields[0], at_line(file, line.number));
    if (stamp_ns && line.fields.size() == 2) {
      entries.push_back({*stamp_ns, line.fields[1]});
    } else {
      skipped.push_back(malformed(file, line, "stamp file"));
    }
  }
  return entries;
}

/// TUM's tool writes the lists in the order they were given to it: both "rgb depth" and "depth rgb" are about.
FilePair colour_first(FilePair pair) {
  const auto is_depth = [](const StampedFile& entry) { return entry.file.rfind("depth", 0) == 0; };
  if (is_depth(pair.color) && !is_depth(pair.depth)) std::swap(pair.color, pair.depth);
  return pair;
}

std::vector<FilePair> read_associations(const fs::path& file, std::vector<SkippedInput>& skipped) {
  std::vector<FilePair> pairs;
  for (const io::TextLine& line : read_lines(file)) {
    const std::string where = at_line(file, line.number);
    const auto first_ns = stamp_of(line.fields[0], where);
    const auto second_ns = line.fields.size() == 4 ? stamp_of(line.fields[2], where) : std::nullopt;
    if (first_ns && second_ns) {
      pairs.push_back(colour_first({{*first_ns, line.fields[1]}, {*second_ns, line.fields[3]}}));
    } else {
      skipped.push_back(malformed(file, line, "stamp rgb_file stamp depth_file"));
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
      skipped.push_back({SkipReason::kStampDoubled, color.file + " has the stamp of the frame before"});
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
  std::stable_sort(entries.begin(), entries.end(), older);
  entries.erase(std::unique(entries.begin(), entries.end(), same), entries.end());
}

}  // namespace

PairList read_pairs(const fs::path& folder) {
  check_folder(folder);
  PairList list;
  if (const fs::path file = folder / "associations.txt"; fs::exists(file)) {
    list.pairs = increasing(read_associations(file, list.skipped), list.skipped);
    return list;
  }
  const std::vector<StampedFile> color = increasing(read_list(folder / "rgb.txt", list.skipped), list.skipped);
  std::vector<StampedFile> depth = read_list(folder / "depth.txt", list.skipped);
  sort_unique(depth);
  const std::vector<geometry::StampPair> found =
      geometry::associate(geometry::stamps_of(color), geometry::stamps_of(depth), kPairingToleranceNs);
  auto pair = found.begin();
  for (std::size_t i = 0; i < color.size(); ++i) {
    if (pair != found.end() && pair->first == i) {
      list.pairs.push_back({color[i], depth[(pair++)->second]});
    } else {
      list.skipped.push_back({SkipReason::kNoDepthPartner, color[i].file + " has no depth image within 0.02 s"});
    }
  }
  return list;
}

}  // namespace rtd::camera
