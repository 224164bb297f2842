// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// How long a seek takes: replay_seek FILE [SEEKS]. A file that is not there is written first: 2 GB of frames at 30 Hz
// and poses, uncompressed chunks of 1 MiB. Times are those until the first message of the new place is there.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <numeric>
#include <random>

#include "common/mcap/writer.hpp"
#include "common/service/command_line.hpp"
#include "services/replay/core/message_feed.hpp"

namespace {

using rtd::mcap::Timestamp;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kFileBytes = 2'000'000'000, kFrameBytes = 1'536'124, kPeriodNs = 33'333'333;

void write_file(const std::string& path) {
  rtd::io::FileSink sink(path);
  rtd::mcap::Writer writer(sink, {.profile = "ros2"});
  const auto frame_type = writer.add(rtd::mcap::Schema{0, "rtd_msgs::msg::dds_::RgbdFrame_", "", ""});
  const auto pose_type = writer.add(rtd::mcap::Schema{0, "geometry_msgs/msg/PoseStamped", "", ""});
  const auto frames = writer.add(rtd::mcap::Channel{0, frame_type, "rtd/frame", "cdr", {}});
  const auto poses = writer.add(rtd::mcap::Channel{0, pose_type, "/slam/pose", "cdr", {}});
  std::vector<std::byte> frame(kFrameBytes), pose(80);
  frame[1] = pose[1] = std::byte{1};  // CDR, little endian
  rtd::service::Progress progress(std::cerr, "writing " + path, kFileBytes);
  for (std::uint64_t i = 0; sink.position() < kFileBytes; ++i) {
    const Timestamp time = 1'700'000'000'000'000'000 + i * kPeriodNs;
    for (std::size_t k = 4; k < frame.size(); k += 64) frame[k] = static_cast<std::byte>(i * 7 + k);
    writer.write({frames, static_cast<std::uint32_t>(i), time, time, frame});
    writer.write({poses, static_cast<std::uint32_t>(i), time + 1'000'000, time, pose});
    progress.reach(sink.position());
  }
  writer.close();
}

double ms_since(Clock::time_point from) {
  return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "replay_seek FILE [SEEKS]\n";
    return 2;
  }
  const std::string path = argv[1];
  const int seeks = argc > 2 ? std::stoi(argv[2]) : 50;
  if (!std::filesystem::exists(path)) write_file(path);

  const Clock::time_point opening = Clock::now();
  const rtd::io::FileSource source(path);
  rtd::mcap::IndexedReader reader(source);
  const auto statistics = reader.summary().statistics.value();
  const auto first = static_cast<std::int64_t>(statistics.message_start_time);
  const auto last = static_cast<std::int64_t>(statistics.message_end_time);
  fmt::print("{}: {:.2f} GB, {} messages, opened in {:.1f} ms\n", path, static_cast<double>(source.size()) * 1e-9,
             statistics.message_count, ms_since(opening));

  rtd::replay::MessageFeed feed(reader, {.start_ns = first, .end_ns = last});
  std::mt19937_64 random(1);
  std::vector<double> times_ms;
  for (int i = 0; i < seeks; ++i) {
    const std::int64_t target = std::uniform_int_distribution(first, last)(random);
    const Clock::time_point asked = Clock::now();
    feed.seek(target);
    if (!feed.next()) return 1;
    times_ms.push_back(ms_since(asked));
  }
  std::ranges::sort(times_ms);
  fmt::print("{} seeks: median {:.2f} ms, longest {:.2f} ms\n", seeks, times_ms[times_ms.size() / 2], times_ms.back());
  return 0;
}
