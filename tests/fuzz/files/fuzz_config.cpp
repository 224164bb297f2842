// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Feeds changed configurations and camera calibrations to their readers: fuzz_config [inputs] [seed]. What must hold
/// for every input: no crash, no sanitizer report, bounded memory and time, no exception but ConfigError and
/// SourceError; what is read is read again from what is printed of it. Exit code 1 and the input in
/// fuzz_config_failed.yaml otherwise. The preset asan-ubsan gives it its teeth.
#include <ctime>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"
#include "common/service/config.hpp"
#include "services/filter/config.hpp"
#include "tests/fuzz/files/text_mutation.hpp"
#include "tests/fuzz/fuzz_loop.hpp"

namespace rtd {
namespace {

constexpr std::size_t kMaxAllocated = 64 << 20;
constexpr double kMost_s = 5;

struct Counted {
  std::uint64_t configurations = 0, calibrations = 0;
};

std::string printed_default() {
  filter::ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("filter", config);
  return binder.print();
}

std::vector<std::string> seeds() {
  return {printed_default(), "filter:\n  mode: rtd\n  orb: {feature_count: 900}\nslam:\n  place: {vocabulary: x}\n",
          "filter:\n  motion_levels: {person: high, chair: medium}\n",
          "width: 640\nheight: 480\nfx: 525\nfy: 525.5\ncx: 319.5\ncy: 239.5\nk1: 0.1\ndepth_factor: 5000\nfps: 30\n",
          "%YAML:1.0\n---\nwidth: 848\nheight: 480\nfx: 400\nfy: 400\ncx: 1\ncy: 2\nfisheye: 1\nk4: -0.01\n"};
}

std::vector<std::string> words() {
  return {"&a ",
          "*a",
          "? ",
          "- ",
          "[",
          "{",
          "}",
          "]",
          ": ",
          "<<: *a\n",
          "!!binary ",
          "!!map ",
          "|\n",
          ">-\n",
          "...\n",
          "---\n",
          "\"",
          "'",
          "#",
          "\t",
          "\n",
          "  ",
          "filter:",
          "filter: &a\n  x: *a\n",
          "? [a, b]\n: c\n",
          "null",
          "~",
          ".inf",
          ".nan",
          "1e999",
          "0x7fffffff",
          "-0",
          "99999999999999999999",
          "width: ",
          "nan",
          "k1: 1\n",
          std::string("\0", 1),
          "\xff",
          "\xef\xbb\xbf"};
}

std::string read_configuration(const std::string& text, Counted& counted) {
  filter::ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("filter", config);
  try {
    binder.load_text(text, "input", {"slam"});
    config.core_config();
    ++counted.configurations;
    const std::string printed = binder.print();
    binder.load_text(printed, "printed", {});
    if (binder.print() != printed) return "printed and read again it is another configuration";
  } catch (const service::ConfigError&) {
  }
  return "";
}

std::string read_calibration(const std::string& text, Counted& counted) {
  try {
    const camera::Calibration calibration = camera::parse_calibration(text, "input");
    ++counted.calibrations;
    const camera::Calibration again = camera::parse_calibration(camera::to_yaml(calibration), "printed");
    const auto &a = calibration.camera.parameters(), &b = again.camera.parameters();
    if (a.width != b.width || a.height != b.height || a.lens != b.lens) return "printed it is another camera";
  } catch (const camera::SourceError&) {
  }
  return "";
}

std::string try_input(const io::Bytes& input, Counted& counted) {
  const std::string text = rtd::testing::text_of(input);
  const std::clock_t begin = std::clock();
  std::string failure = read_configuration(text, counted);
  if (failure.empty()) failure = read_calibration(text, counted);
  if (!failure.empty()) return failure;
  if (static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC > kMost_s) return "it takes too long";
  if (const std::size_t peak = rtd::testing::peak_allocation(); peak > kMaxAllocated)
    return "it made the reader hold " + std::to_string(peak) + " bytes";
  return "";
}

}  // namespace
}  // namespace rtd

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<std::string> texts = seeds(), all_words = words();
  Counted counted;
  return rtd::testing::run_fuzz(
      argc, argv, "fuzz_config_failed.yaml",
      [&](std::mt19937_64& random) { return rtd::testing::mutate_text(texts, all_words, random); },
      [&](const io::Bytes& input, std::mt19937_64&) { return try_input(input, counted); },
      [&] {
        return std::to_string(counted.configurations) + " configurations, " + std::to_string(counted.calibrations) +
               " calibrations";
      });
}
