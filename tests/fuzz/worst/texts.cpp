// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/bus/offered_qos.hpp"
#include "common/camera/calibration.hpp"
#include "common/camera/folder/frame_lists.hpp"
#include "common/camera/folder/ground_truth.hpp"
#include "common/geometry/pose_list.hpp"
#include "common/geometry/trajectory.hpp"
#include "common/recordings/parts.hpp"
#include "common/ros2/type_description.hpp"
#include "common/ros_codec/message_definition.hpp"
#include "services/filter/config.hpp"
#include "tests/fuzz/worst/worst_case.hpp"

namespace rtd::worst {
namespace {

namespace fs = std::filesystem;

struct Text {
  std::string name, content;
};

/// Lines of a number that counts.
std::string counted(std::size_t bytes, const std::function<std::string(std::size_t)>& line) {
  std::string text;
  for (std::size_t i = 0; text.size() < bytes; ++i) text += line(i);
  return text;
}

std::string deeper_and_deeper(std::size_t bytes) {
  std::string text;
  for (std::size_t depth = 0; text.size() < bytes; ++depth) text += std::string(depth, ' ') + "a:\n";
  return text;
}

std::vector<Text> settings(std::size_t bytes) {
  const std::string long_word(bytes / 2, 'k');
  return {{"one long key", long_word + long_word + ": 1\n"},
          {"a long key above many", long_word + ":\n" + repeated(" a: 1\n", bytes / 2)},
          {"a long key above many, flow", "{" + long_word + ": {" + repeated("a: 1, ", bytes / 2)},
          {"many keys", counted(bytes, [](std::size_t i) { return "k" + std::to_string(i) + ": 1\n"; })},
          {"one key many times", repeated("fx: 1\n", bytes)},
          {"an open bracket and empty lines", "a: [" + repeated("\n", bytes)},
          {"an open bracket and lines", "a: [" + repeated("1,\n", bytes)},
          {"open brackets", "a: " + repeated("[", bytes)},
          {"open braces", repeated("{a: ", bytes)},
          {"brackets that close", repeated("a: []\n", bytes)},
          {"an open quote", "a: \"" + repeated("b\n", bytes)},
          {"dashes", repeated("- ", bytes)},
          {"colons", repeated("a: ", bytes)},
          {"questions", repeated("? ", bytes)},
          {"deeper and deeper", deeper_and_deeper(bytes)},
          {"a list of one line", "a: [" + repeated("1, ", bytes) + "]"},
          {"anchors", repeated("- &a a\n", bytes)},
          {"aliases", "- &a a\n" + repeated("- *a\n", bytes)},
          {"tags", repeated("- !t a\n", bytes)},
          {"one tag", repeated("!", bytes)},
          {"comments", repeated("# \n", bytes)},
          {"documents", repeated("---\n", bytes)},
          {"a block of text", "a: |\n" + repeated(" b\n", bytes)},
          {"blanks", "a:" + repeated(" ", bytes) + "1"}};
}

std::vector<Text> tables(std::size_t bytes) {
  const std::string pose = " 0 0 0 0 0 0 1\n";
  return {{"stamps close together",
           counted(bytes, [](std::size_t i) { return "0." + std::to_string(1'000'000 + i) + " a\n"; })},
          {"poses at one time", repeated("1" + pose, bytes)},
          {"poses backwards", counted(bytes, [&](std::size_t i) { return std::to_string(9'999'999 - i) + pose; })},
          {"one letter a line", repeated("a\n", bytes)},
          {"numbers", repeated("1\n", bytes)},
          {"a line of numbers", repeated("1 ", bytes)},
          {"a line of commas", "1" + repeated(",", bytes)},
          {"digits", repeated("1", bytes)},
          {"digits and endings", repeated("1", bytes / 2) + repeated(".a", bytes / 2)},
          {"slashes", repeated("/a", bytes) + " 1"},
          {"rows of a matrix", repeated("1 0 0 0\n", bytes)},
          {"comments", repeated("#\n", bytes)}};
}

std::vector<Text> types(std::size_t bytes) {
  const std::string package(bytes / 2, 'p');
  return {{"fields", repeated("int32 a\n", bytes)},
          {"a long package", "A a\n===\nMSG: " + package + "/A\n" + repeated("B b\n", bytes / 2)},
          {"types", counted(bytes, [](std::size_t i) { return "===\nMSG: a/T" + std::to_string(i) + "\nint8 a\n"; })},
          {"structs in structs", counted(bytes,
                                         [](std::size_t i) {
                                           return "struct s" + std::to_string(i) + " { s" + std::to_string(i + 1) +
                                                  " a; }\n";
                                         })},
          {"words", "struct s0 {" + counted(bytes, [](std::size_t i) { return "w" + std::to_string(i) + " "; })},
          {"signs", repeated("{", bytes)}};
}

using Read = std::function<void(const std::string& text)>;

void add(std::vector<Case>& cases, const std::string& reader, const std::vector<Text>& inputs, const Read& read) {
  for (const Text& input : inputs) {
    const auto content = std::make_shared<const std::string>(input.content);
    cases.push_back({reader + ": " + input.name, [content, read] { read(*content); }});
  }
}

void read_config(const std::string& text) {
  filter::ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("filter", config);
  binder.load_text(text, "input", {"slam"});
}

void read_truth(const fs::path& file) {
  const camera::Layout layout{};
  camera::FolderContents contents;
  contents.folder = file.parent_path();
  contents.layout = &layout;
  contents.poses = {file.filename().string()};
  camera::read_ground_truth(contents, {}, false);
}

/// Of a folder whose lists are all this text.
void read_lists(const fs::path& folder, const std::string& text) {
  for (const char* const name : {"rgb.txt", "depth.txt"}) std::ofstream(folder / name) << text;
  camera::read_two_lists(folder, "rgb.txt", "depth.txt");
}

}  // namespace

std::vector<Case> texts(std::size_t bytes, const fs::path& folder) {
  std::vector<Case> cases;
  const auto name = [folder](const char* own) {
    return [folder, own](const std::string& t) { return file_of(folder, own, t); };
  };
  add(cases, "calibration", settings(bytes), [](const std::string& text) { camera::parse_calibration(text, "input"); });
  add(cases, "configuration", settings(bytes), read_config);
  add(cases, "QoS of a recording", settings(bytes), [](const std::string& text) { bus::parse_offered_qos(text); });
  add(cases, "metadata.yaml", settings(bytes), [file = name("metadata.yaml")](const std::string& text) {
    recordings::parts_of(file("rosbag2_bagfile_information:\n  relative_file_paths:\n" + text).parent_path());
  });
  add(cases, "metadata.yaml",
      {{"many files", "rosbag2_bagfile_information:\n  relative_file_paths:\n" + repeated("  - a\n", bytes)},
       {"one file many times", "rosbag2_bagfile_information:\n  relative_file_paths:\n" + repeated("  - .\n", bytes)}},
      [file = name("metadata.yaml")](const std::string& text) { recordings::parts_of(file(text).parent_path()); });
  add(cases, "JSON", settings(bytes), [](const std::string& text) {
    static_cast<void>(nlohmann::json(nlohmann::json::parse(text, nullptr, false)).size());
  });
  add(cases, "JSON",
      {{"lists", repeated("[", bytes)}, {"pairs of lists", repeated("[", bytes / 2) + repeated("]", bytes / 2)}},
      [](const std::string& text) {
        static_cast<void>(nlohmann::json(nlohmann::json::parse(text, nullptr, false)).size());
      });
  add(cases, "lists", tables(bytes),
      [file = name("x")](const std::string& text) { read_lists(file("").parent_path(), text); });
  add(cases, "associations", tables(bytes), [file = name("associations.txt")](const std::string& text) {
    camera::read_associations(file(text).parent_path(), "associations.txt");
  });
  add(cases, "poses", tables(bytes), [](const std::string& text) { geometry::read_pose_list(text, "input"); });
  add(cases, "truth", tables(bytes), [file = name("truth.csv")](const std::string& text) { read_truth(file(text)); });
  add(cases, "frames", tables(bytes),
      [file = name("rgb.txt")](const std::string& text) { geometry::read_frame_stamps(file(text)); });
  add(cases, "definition", types(bytes), [](const std::string& text) { ros::parse_definition("a/A", text); });
  add(cases, "IDL", types(bytes), [](const std::string& text) { ros2::layout_in(text, "s0"); });
  return cases;
}

}  // namespace rtd::worst
