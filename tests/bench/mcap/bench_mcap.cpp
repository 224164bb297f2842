// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What recording and replaying cost: RGB-D frames of 1.5 MB and a pose each, into and out of a file.
///   bench_mcap --benchmark_filter=Seek    with RTD_BENCH_MCAP_MB=2048 for a file of 2 GB in the temporary folder
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "common/io/bytes.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/stream_reader.hpp"
#include "common/mcap/writer.hpp"

namespace {

using namespace rtd::mcap;
namespace io = rtd::io;

constexpr std::size_t kFrame = 1536000;
constexpr Timestamp kPeriod = 33'333'333;

/// Half noise, half flat: compresses about as a depth and a colour image do.
Bytes frame() {
  Bytes bytes(kFrame);
  std::mt19937 random(1);
  for (std::size_t i = 0; i < bytes.size() / 2; ++i) bytes[i] = static_cast<std::byte>(random());
  return bytes;
}

struct TemporaryFile {
  ~TemporaryFile() { std::filesystem::remove(path); }
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("bench_mcap" + std::to_string(getpid()) + ".mcap");
};

void write_frames(io::ByteSink& sink, const WriterOptions& options, std::uint64_t count) {
  Writer writer(sink, options);
  const ChannelId frames = writer.add(Channel{0, 0, "/frame", "cdr", {}});
  const ChannelId poses = writer.add(Channel{0, 0, "/pose", "cdr", {}});
  const Bytes data = frame();
  for (std::uint64_t i = 0; i < count; ++i) {
    writer.write(Message{frames, static_cast<std::uint32_t>(i), i * kPeriod, i * kPeriod, data});
    writer.write(
        Message{poses, static_cast<std::uint32_t>(i), i * kPeriod + 1, i * kPeriod, ByteView(data).first(100)});
  }
  writer.close();
}

void Crc32(benchmark::State& state) {
  const Bytes data = frame();
  for (auto _ : state) benchmark::DoNotOptimize(io::crc32(data));
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * data.size()));
}
BENCHMARK(Crc32);

void Write(benchmark::State& state) {
  WriterOptions options;
  options.compression = static_cast<Compression>(state.range(0));
  options.chunk_size = 4 << 20;
  const std::uint64_t count = 60;
  TemporaryFile file;
  for (auto _ : state) {
    io::FileSink sink(file.path, io::IfExists::kReplace);
    write_frames(sink, options, count);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * count * kFrame));
  state.SetLabel(name_of(options.compression));
}
BENCHMARK(Write)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void Stream(benchmark::State& state) {
  const std::uint64_t count = 60;
  TemporaryFile file;
  {
    io::FileSink sink(file.path);
    write_frames(sink, {}, count);
  }
  for (auto _ : state) {
    const io::FileSource source(file.path);
    StreamReader reader(source);
    while (reader.next() != nullptr) continue;
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * count * kFrame));
}
BENCHMARK(Stream)->Unit(benchmark::kMillisecond);

/// Opens the file and reads the first message from a random time on: a seek of a program that has just started.
void OpenAndSeek(benchmark::State& state) {
  const char* const megabytes = std::getenv("RTD_BENCH_MCAP_MB");
  const std::uint64_t count = (megabytes != nullptr ? std::strtoull(megabytes, nullptr, 10) : 256) * 1000000 / kFrame;
  TemporaryFile file;
  {
    WriterOptions options;
    options.compression = static_cast<Compression>(state.range(0));
    io::FileSink sink(file.path);
    write_frames(sink, options, count);
  }
  std::mt19937_64 random(1);
  for (auto _ : state) {
    const io::FileSource source(file.path);
    IndexedReader reader(source);
    MessageCursor cursor = reader.messages({random() % (count * kPeriod)});
    benchmark::DoNotOptimize(cursor.next());
  }
  state.counters["file_MB"] = static_cast<double>(std::filesystem::file_size(file.path)) / 1e6;
}
BENCHMARK(OpenAndSeek)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
