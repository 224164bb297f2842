// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed .oni files for the check before OpenNI2's library: no exception but OniFileError, and what passes has its
/// records within the file.
#include <filesystem>
#include <sstream>

#include "services/camera/openni2/oni_file.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/support/oni_writer.hpp"

namespace rtd::camera {
namespace {

io::Bytes sample(int frames) {
  const fuzz::FuzzFile file(".oni");
  {
    test::OniWriter writer(file.path().string(), {8, 6}, 30);
    for (int i = 0; i < frames; ++i) {
      writer.color(static_cast<std::uint64_t>(i) * 33'333, cv::Mat::zeros(6, 8, CV_8UC3));
      writer.depth(static_cast<std::uint64_t>(i) * 33'333, cv::Mat::zeros(6, 8, CV_16UC1));
    }
  }
  return fuzz::bytes_of(rtd::test::read_text(file.path()));
}

std::string try_input(const io::Bytes& input, std::uint64_t& passed) {
  std::istringstream file(fuzz::text_of(input));
  try {
    const OniCheck check = check_oni(file, "x.oni");
    ++passed;
    constexpr std::size_t kHeader = 24, kRecord = 28;
    if (kHeader + check.records * kRecord > input.size() || check.frames > check.records)
      return "it has no such records";
  } catch (const OniFileError&) {
  }
  return "";
}

}  // namespace
}  // namespace rtd::camera

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> files = {camera::sample(0), camera::sample(1), camera::sample(5)};
  std::uint64_t passed = 0;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_oni_failed.oni",
       .make = [&](fuzz::Random& random) { return fuzz::mutate_one(files, random); },
       .test = [&](const io::Bytes& input, fuzz::Random&) { return camera::try_input(input, passed); },
       .counted = [&] { return "passed on to the library " + std::to_string(passed); },
       .max_allocated = 256 << 10});  // the file itself, of a few KiB, and a message
}
