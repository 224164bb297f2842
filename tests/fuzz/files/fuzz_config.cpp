// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed configurations and camera calibrations: no exception but ConfigError and SourceError; what is read is read
/// again from what is printed of it.

#include <fmt/format.h>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"
#include "common/service/config.hpp"
#include "services/filter/config.hpp"
#include "tests/fuzz/fuzz_loop.hpp"

namespace rtd {
namespace {

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
  const std::string text = fuzz::text_of(input);
  std::string failure = read_configuration(text, counted);
  return failure.empty() ? read_calibration(text, counted) : failure;
}

}  // namespace
}  // namespace rtd

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<std::string> texts = seeds(), all_words = words();
  Counted counted;
  return fuzz::run_fuzz(argc, argv,
                        {.failed_path = "fuzz_config_failed.yaml",
                         .make = [&](fuzz::Random& random) { return fuzz::mutate_text(texts, all_words, random); },
                         .test = [&](const io::Bytes& input, fuzz::Random&) { return try_input(input, counted); },
                         .counted =
                             [&] {
                               return fmt::format("{} configurations, {} calibrations", counted.configurations,
                                                  counted.calibrations);
                             },
                         .max_cpu_s = 5});
}
