// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Feeds changed .oni files to the check before OpenNI2's library: fuzz_oni [inputs] [seed]. What must hold for every
/// input: no crash, no sanitizer report, bounded memory, no exception but OniFileError, and what passes has its records
/// within the file. Exit code 1 and the input in fuzz_oni_failed.oni otherwise.
#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "services/camera/openni2/oni_file.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/fuzz/mcap/mutation.hpp"
#include "tests/support/oni_writer.hpp"

namespace rtd::camera {
namespace {

constexpr std::size_t kMaxAllocated = 256 << 10;  // the file itself, of a few KiB, and a message

std::string sample(int frames) {
  const auto path = std::filesystem::temp_directory_path() / ("rtd_fuzz_" + std::to_string(getpid()) + ".oni");
  {
    test::OniWriter writer(path.string(), {8, 6}, 30);
    for (int i = 0; i < frames; ++i) {
      writer.color(static_cast<std::uint64_t>(i) * 33'333, cv::Mat::zeros(6, 8, CV_8UC3));
      writer.depth(static_cast<std::uint64_t>(i) * 33'333, cv::Mat::zeros(6, 8, CV_16UC1));
    }
  }
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(path);
  return text;
}

std::string try_input(const io::Bytes& input, std::uint64_t& passed) {
  std::istringstream file(std::string(reinterpret_cast<const char*>(input.data()), input.size()));
  try {
    const OniCheck check = check_oni(file, "x.oni");
    ++passed;
    constexpr std::size_t kHeader = 24, kRecord = 28;
    if (kHeader + check.records * kRecord > input.size() || check.frames > check.records)
      return "it has no such records";
  } catch (const OniFileError&) {
  }
  if (const std::size_t peak = rtd::testing::peak_allocation(); peak > kMaxAllocated)
    return "it made the check hold " + std::to_string(peak) + " bytes";
  return "";
}

}  // namespace
}  // namespace rtd::camera

int main(int argc, char** argv) {
  using namespace rtd;
  std::vector<io::Bytes> files;
  for (const int frames : {0, 1, 5}) {
    const std::string text = camera::sample(frames);
    const auto bytes = io::bytes_of(text);
    files.emplace_back(bytes.begin(), bytes.end());
  }
  std::uint64_t passed = 0;
  return rtd::testing::run_fuzz(
      argc, argv, "fuzz_oni_failed.oni",
      [&](std::mt19937_64& random) {
        return mcap::mutate(files[random() % files.size()], files[random() % files.size()], random);
      },
      [&](const io::Bytes& input, std::mt19937_64&) { return camera::try_input(input, passed); },
      [&] { return "passed on to the library " + std::to_string(passed); });
}
