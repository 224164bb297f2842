// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/trace.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "common/io/byte_sink.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::service {
namespace {

constexpr std::int64_t kFlushPeriodNs = 1'000'000'000;  // what a killed process loses at most
constexpr double kNsPerUs = 1e3, kNsOfMs = 1e6;

double us(std::int64_t ns) {
  return static_cast<double>(ns) / kNsPerUs;
}

std::string span_line(const char* name, std::int64_t begin_ns, double duration_ns, std::uint64_t frame) {
  return fmt::format(R"({{"name":"{}","ph":"X","ts":{:.3f},"dur":{:.3f},"pid":{},"tid":{},"args":{{"frame":{}}}}})"
                     "\n",
                     name, us(begin_ns), duration_ns / kNsPerUs, getpid(), gettid(), frame);
}

}  // namespace

Trace::Trace(const std::string& folder, const std::string& service) {
  if (folder.empty()) return;
  const std::string path = fmt::format("{}/{}.{}.jsonl", folder, service, getpid());
  try {
    const io::FileSink made(path);  // a new file, not what another user has put there
  } catch (const io::IoError& error) {
    SPDLOG_WARN("event=no_trace cause=\"{}\"", error.what());
    return;
  }
  file_.open(path, std::ios::app);
  write(fmt::format(R"({{"name":"process_name","ph":"M","pid":{},"tid":0,"args":{{"name":"rtd-{}"}}}})"
                    "\n",
                    getpid(), service));
}

Trace& Trace::none() {
  static Trace none;
  return none;
}

void Trace::span(const char* name, std::int64_t begin_ns, std::int64_t end_ns, std::uint64_t frame) {
  if (on()) write(span_line(name, begin_ns, static_cast<double>(end_ns - begin_ns), frame));
}

void Trace::stages(std::int64_t begin_ns, std::span<const TraceStage> stages, std::uint64_t frame) {
  if (!on()) return;
  std::string lines;
  double after_ns = 0;
  for (const TraceStage& stage : stages) {
    const double duration_ns = static_cast<double>(stage.ms) * kNsOfMs;
    if (duration_ns <= 0) continue;
    lines += span_line(stage.name, begin_ns + static_cast<std::int64_t>(after_ns), duration_ns, frame);
    after_ns += duration_ns;
  }
  write(lines);
}

void Trace::async_span(const char* name, std::int64_t begin_ns, std::int64_t end_ns, std::uint64_t frame) {
  if (!on()) return;
  const auto line = [&](char phase, std::int64_t at_ns) {
    return fmt::format(
        R"({{"name":"{}","cat":"frame","ph":"{}","id":{},"ts":{:.3f},"pid":{},"tid":0,"args":{{"frame":{}}}}})"
        "\n",
        name, phase, frame, us(at_ns), getpid(), frame);
  };
  write(line('b', begin_ns) + line('e', end_ns));
}

void Trace::write(const std::string& lines) {
  const std::lock_guard lock(mutex_);
  file_ << lines;
  const std::int64_t now_ns = monotonic_ns();
  if (now_ns - flushed_ns_ < kFlushPeriodNs) return;
  file_.flush();
  flushed_ns_ = now_ns;
}

TraceSpan::TraceSpan(Trace& trace, const char* name, std::uint64_t frame)
    : trace_(trace), name_(name), frame_(frame), begin_ns_(trace.on() ? monotonic_ns() : 0) {}

TraceSpan::~TraceSpan() {
  if (trace_.on()) trace_.span(name_, begin_ns_, monotonic_ns(), frame_);
}

}  // namespace rtd::service
