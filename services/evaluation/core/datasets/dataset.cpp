// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/datasets/dataset.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>

#include "common/io/byte_sink.hpp"
#include "common/io/fd_writing.hpp"
#include "common/io/folder_walk.hpp"
#include "common/io/input_file.hpp"
#include "common/io/text.hpp"
#include "common/service/config.hpp"

namespace rtd::eval {

const NamedDataset& named(Dataset dataset) {
  return *std::ranges::find(kDatasets, dataset, &NamedDataset::dataset);
}

const NamedDataset* find_dataset(std::string_view name) {
  const auto found = std::ranges::find(kDatasets, name, &NamedDataset::name);
  return found == kDatasets.end() ? nullptr : &*found;
}

std::string sequence_name(Dataset dataset, const std::string& folder_name) {
  static const std::regex kTum("rgbd_dataset_freiburg([123])_([A-Za-z0-9_]+)");
  static const std::regex kBonn("rgbd_bonn_([A-Za-z0-9_]+)");
  static const std::regex kOpenloris("(?:office|corridor|home|cafe|market)[0-9]+-[0-9]+");
  std::smatch parts;
  switch (dataset) {
    case Dataset::kTum:
      return std::regex_match(folder_name, parts, kTum) ? "fr" + parts[1].str() + "_" + parts[2].str() : "";
    case Dataset::kBonn:
      return std::regex_match(folder_name, parts, kBonn) ? parts[1].str() : "";
    case Dataset::kOpenloris:
      return std::regex_match(folder_name, kOpenloris) ? folder_name : "";
  }
  return "";
}

std::span<const char* const> mean_sequences(Dataset dataset) {
  static constexpr std::array kBonnMean{"balloon",
                                        "balloon2",
                                        "crowd",
                                        "crowd2",
                                        "person_tracking",
                                        "person_tracking2",
                                        "moving_nonobstructing_box",
                                        "moving_nonobstructing_box2"};
  if (dataset == Dataset::kBonn) return kBonnMean;
  return {};
}

namespace fs = std::filesystem;
namespace {

/// Which files a sequence consists of.
struct Layout {
  const char* color_list;
  const char* depth_list;
  std::vector<const char*> beside;  ///< without these it cannot be read
};

Layout layout_of(Dataset dataset) {
  if (dataset == Dataset::kOpenloris) return {"color.txt", "aligned_depth.txt", {"sensors.yaml", "trans_matrix.yaml"}};
  return {"rgb.txt", "depth.txt", {}};
}

bool holds_lists(const fs::path& folder, const Layout& layout) {
  std::error_code ignored;
  return fs::exists(folder / layout.color_list, ignored) && fs::exists(folder / layout.depth_list, ignored);
}

/// The images that a list "stamp file" names.
std::vector<std::string> listed_images(const fs::path& list) {
  std::vector<std::string> images;
  std::string text;
  try {
    text = io::read_file(list, io::kFrameList, list.parent_path());
  } catch (const io::IoError&) {  // names no image
  }
  for (const io::TextLine& line : io::split_lines(text)) {
    if (line.fields.size() >= 2) images.push_back(line.fields[1]);
  }
  return images;
}

/// Why the images of a list are not all there; empty when they are.
std::string missing_images(const fs::path& folder, const char* list) {
  const std::vector<std::string> images = listed_images(folder / list);
  if (images.empty()) return fmt::format("{} names no image: the download is incomplete, unpack it again", list);
  const auto is_missing = [&](const std::string& image) {
    return io::Descriptor(io::open_below(folder / image, folder, O_PATH | O_CLOEXEC)).get() < 0;
  };
  const auto first = std::ranges::find_if(images, is_missing);
  if (first == images.end()) return "";
  return fmt::format("{} of {} images of {} are missing (the first is {}): the download is incomplete, unpack it again",
                     std::ranges::count_if(images, is_missing), images.size(), list, *first);
}

/// Why a folder with lists cannot be run; empty when it can.
std::string defect(const fs::path& folder, const Layout& layout) {
  std::error_code ignored;
  for (const char* file : layout.beside) {
    if (!fs::exists(folder / file, ignored))
      return fmt::format("it has no {}: the download is incomplete, unpack it again", file);
  }
  for (const char* list : {layout.color_list, layout.depth_list}) {
    if (std::string missing = missing_images(folder, list); !missing.empty()) return missing;
  }
  if (!fs::exists(folder / "groundtruth.txt", ignored))
    return "it has no groundtruth.txt, so there is no error to measure: take it from the dataset's page";
  return "";
}

/// Of a folder with lists whose name is not one of the dataset.
std::string unknown_name(Dataset dataset, const std::string& name) {
  for (const NamedDataset& other : kDatasets) {
    if (!sequence_name(other.dataset, name).empty())
      return fmt::format("it is a sequence of {}: use 'rtd benchmark {}'", other.title, other.name);
  }
  return fmt::format("its name is not one of {} ({}): rename it, or run it alone with 'rtd run'", named(dataset).title,
                     named(dataset).folder_form);
}

/// "rgbd_bonn_balloon" of rgbd_bonn_balloon.zip; empty for other files.
std::string packed_name(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const std::string end : {".tgz", ".tar.gz", ".tar", ".zip", ".7z"}) {
    if (name.ends_with(end)) return name.substr(0, name.size() - end.size());
  }
  return "";
}

/// The last name of a path that may end with a slash or be ".".
fs::path clean(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

class Search {
 public:
  explicit Search(Dataset dataset) : dataset_(dataset), layout_(layout_of(dataset)) {}

  /// Each folder once, also where links lead to it again.
  void visit(const fs::path& folder, int depth = 0) {
    constexpr int kDeepest = 5;
    if (!walk_.enter(folder)) return;
    if (holds_any_lists(folder)) return judge(folder);
    const std::size_t before = found_.sequences.size() + found_.left_out.size();
    if (depth < kDeepest) visit_below(folder, depth);
    const bool is_empty = found_.sequences.size() + found_.left_out.size() == before;
    if (is_empty && !sequence_name(dataset_, folder.filename().string()).empty())
      leave_out(folder, fmt::format("it has no {} and {}: the download is incomplete, unpack it again",
                                    layout_.color_list, layout_.depth_list));
  }

  FoundSequences result() {
    for (const auto& [name, file] : packed_) {
      if (!seen_.contains(sequence_name(dataset_, name)))
        leave_out(file, "it is still packed: unpack it next to the archive");
    }
    std::ranges::sort(found_.sequences, {}, &Sequence::name);
    return std::move(found_);
  }

 private:
  static bool holds_any_lists(const fs::path& folder) {
    return std::ranges::any_of(kDatasets,
                               [&](const NamedDataset& d) { return holds_lists(folder, layout_of(d.dataset)); });
  }

  void visit_below(const fs::path& folder, int depth) {
    for (const io::FolderEntry& entry : walk_.entries(folder)) {
      if (const std::string packed = packed_name(entry.name); !sequence_name(dataset_, packed).empty())
        packed_.emplace_back(packed, folder / entry.name);
      if (entry.is_folder && !entry.name.starts_with('.')) visit(folder / entry.name, depth + 1);
    }
  }

  void judge(const fs::path& folder) {
    const std::string folder_name = folder.filename().string(), name = sequence_name(dataset_, folder_name);
    if (name.empty()) return leave_out(folder, unknown_name(dataset_, folder_name));
    if (!holds_lists(folder, layout_))
      return leave_out(folder, fmt::format("it is not in the layout of {}: it needs {} and {}", named(dataset_).title,
                                           layout_.color_list, layout_.depth_list));
    seen_.insert(name);
    if (const std::string reason = defect(folder, layout_); !reason.empty()) return leave_out(folder, reason);
    const auto same = std::ranges::find(found_.sequences, name, &Sequence::name);
    if (same != found_.sequences.end())
      return leave_out(folder, fmt::format("it is there twice: {} is used", same->folder.string()));
    found_.sequences.push_back({name, folder, listed_images(folder / layout_.color_list).size()});
  }

  void leave_out(const fs::path& folder, const std::string& reason) {
    found_.left_out.push_back({folder.string(), reason});
  }

  const Dataset dataset_;
  const Layout layout_;
  io::FolderWalk walk_;
  FoundSequences found_;
  std::set<std::string> seen_;
  std::vector<std::pair<std::string, fs::path>> packed_;
};

}  // namespace

FoundSequences find_sequences(Dataset dataset, const std::vector<std::string>& folders) {
  Search search(dataset);
  for (const std::string& folder : folders) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) throw service::ConfigError(folder + " is not a folder");
    search.visit(clean(folder));
  }
  return search.result();
}

}  // namespace rtd::eval
