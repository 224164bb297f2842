// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/tum/tum_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "common/camera/calibration.hpp"
#include "common/camera/image_files.hpp"
#include "common/geometry/pose_list.hpp"
#include "common/io/text.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/vision/image_codecs.hpp"

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

std::string joined(std::span<const std::string> words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// The columns of a list with commas between them, else the words of the line: names may have blanks.
std::vector<std::string> columns_of(const io::TextLine& line) {
  if (line.fields[0].find(',') == std::string::npos) return line.fields;
  std::vector<std::string> columns;
  for (const io::TextLine& split : io::split_lines(joined(line.fields), ",")) columns = split.fields;
  for (std::string& column : columns) column.erase(0, column.find_first_not_of(' '));
  return columns;
}

std::vector<StampedFile> read_list(const fs::path& file, std::vector<SkippedInput>& skipped) {
  std::vector<StampedFile> entries;
  for (const io::TextLine& line : read_lines(file)) {
    const std::vector<std::string> columns = columns_of(line);
    const auto stamp_ns = stamp_of(columns[0], at_line(file, line.number));
    if (stamp_ns && columns.size() > 1) {
      entries.push_back({*stamp_ns, joined(std::span(columns).subspan(1))});
    } else {
      skipped.push_back(malformed(file, line, "stamp file"));
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

std::vector<FilePair> read_associations(const fs::path& file, std::vector<SkippedInput>& skipped) {
  std::vector<FilePair> pairs;
  for (const io::TextLine& line : read_lines(file)) {
    const std::string where = at_line(file, line.number);
    const std::vector<std::string> columns = columns_of(line);
    const std::span<const std::string> words(columns);
    std::size_t second = 2;  // the second stamp: the first name may have blanks
    while (second < words.size() && !io::parse_number(words[second])) ++second;
    const auto first_ns = stamp_of(words[0], where);
    const auto second_ns = second + 1 < words.size() ? stamp_of(words[second], where) : std::nullopt;
    if (first_ns && second_ns) {
      pairs.push_back(colour_first(
          {{*first_ns, joined(words.subspan(1, second - 1))}, {*second_ns, joined(words.subspan(second + 1))}}));
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
  std::ranges::stable_sort(entries, older);
  entries.erase(std::unique(entries.begin(), entries.end(), same), entries.end());
}

/// SLAM needs no ground truth: what cannot be used of it becomes a note.
geometry::Trajectory read_groundtruth(const std::filesystem::path& folder, const std::vector<FilePair>& pairs,
                                      std::vector<std::string>& notes) {
  const std::filesystem::path file = folder / "groundtruth.txt";
  if (!std::filesystem::exists(file) || pairs.empty()) return {};
  try {
    geometry::PoseList list = geometry::read_pose_list(file);
    for (auto* lines : {&list.notes, &list.damages}) std::ranges::move(*lines, std::back_inserter(notes));
    geometry::Trajectory of_span =
        poses_of_span(std::move(list.poses), pairs.front().color.stamp_ns, pairs.back().color.stamp_ns);
    if (of_span.empty()) notes.push_back(file.string() + ": not used, it has no pose at the time of the frames");
    return of_span;
  } catch (const geometry::TrajectoryError& error) {
    notes.push_back(std::string("ground truth not used: ") + error.what());
    return {};
  }
}

}  // namespace

PairList read_pairs(const fs::path& folder, std::int64_t tolerance_ns) {
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
  return list;
}

TumSource::TumSource(std::string uri, std::filesystem::path folder, Options options)
    : folder_(std::move(folder)), options_(options) {
  PairList list = read_pairs(folder_, options_.tolerance_ns);
  const Calibration calibration = load_calibration(folder_);
  pairs_ = std::move(list.pairs);
  for (SkippedInput& input : list.skipped) skips_.add(std::move(input));
  skips_.counters().depth_alone = list.depth_alone;
  groundtruth_ = read_groundtruth(folder_, pairs_, info_.notes);
  info_.uri = std::move(uri);
  info_.fps = calibration.fps;
  info_.frames = pairs_.size();
  apply(calibration, info_);
  if (pairs_.empty()) throw SourceError("no usable frame in " + folder_.string() + ": its lists are empty");
  read_first(folder_.string());
}

std::optional<std::int64_t> TumSource::advance() {
  if (next_pair_ == pairs_.size()) return std::nullopt;
  return pairs_[next_pair_++].color.stamp_ns;
}

std::optional<SourceFrame> TumSource::decode() {
  const FilePair& pair = pairs_[next_pair_ - 1];
  ImageRead color = read_color(folder_ / pair.color.file);
  if (color.problem) {
    skips_.add(*color.problem);
    return std::nullopt;
  }
  ImageRead depth = read_depth(folder_ / pair.depth.file);
  if (depth.problem) {
    skips_.add(*depth.problem);
    return std::nullopt;
  }
  if (const auto problem = check_sizes(pair, color.image, depth.image)) {
    skips_.add(*problem);
    return std::nullopt;
  }
  SourceFrame frame = to_frame(pair.color.stamp_ns, std::move(color.image), std::move(depth.image), info_);
  set_depth_stamp(frame, pair.depth.stamp_ns, info_);
  if (options_.masks) frame.dynamic_mask = read_mask(pair);
  return frame;
}

std::optional<SkippedInput> TumSource::check_sizes(const FilePair& pair, const cv::Mat& color,
                                                   const cv::Mat& depth) const {
  check_frame_size(color.cols, color.rows, (folder_ / pair.color.file).string());
  return size_mismatch(pair.color.file, color, depth, info_.camera);
}

cv::Mat TumSource::read_mask(const FilePair& pair) const {
  const std::filesystem::path name = std::filesystem::path(pair.color.file).filename().replace_extension(".png");
  const std::filesystem::path file = folder_ / "mask" / name;
  if (!std::filesystem::exists(file)) return {};
  const cv::Mat mask = vision::read_image(file, {.pixels = vision::PixelsAs::kGrey}).pixels;
  if (mask.empty()) return {};
  return mask > 0;
}

}  // namespace rtd::camera
