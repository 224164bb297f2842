// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <mutex>
#include <span>
#include <string>

namespace rtd::service {

/// A stage of a piece of work, as services measure it.
struct TraceStage {
  const char* name;
  float ms;
};

/// Names the folder into which services write what they do when: `rtd run --trace` sets it for its own.
inline constexpr char kTraceVariable[] = "RTD_TRACE_DIR";

/// What each thread of a process does when, in the Trace Event Format: a line for each span, in a file of the process's
/// own. Times are those of the monotonic clock, ns. Thread-safe; without a folder nothing is measured or written.
class Trace {
 public:
  /// Appends to FOLDER/SERVICE.PID.jsonl. A file that cannot be written is reported once in the log.
  Trace(const std::string& folder, const std::string& service);
  Trace() = default;
  /// One that is off.
  static Trace& none();

  bool on() const { return file_.is_open(); }
  /// Work of the calling thread on a frame.
  void span(const char* name, std::int64_t begin_ns, std::int64_t end_ns, std::uint64_t frame);
  /// Consecutive stages of a span that began at `begin_ns`; those without time are left out.
  void stages(std::int64_t begin_ns, std::span<const TraceStage> stages, std::uint64_t frame);
  /// What overlaps with others of its kind, such as the way of a frame through all services.
  void async_span(const char* name, std::int64_t begin_ns, std::int64_t end_ns, std::uint64_t frame);

 private:
  void write(const std::string& lines);

  std::mutex mutex_;
  std::ofstream file_;
  std::int64_t flushed_ns_ = 0;
};

/// The span from its construction to its destruction.
class TraceSpan {
 public:
  TraceSpan(Trace& trace, const char* name, std::uint64_t frame);
  ~TraceSpan();
  TraceSpan(const TraceSpan&) = delete;
  TraceSpan& operator=(const TraceSpan&) = delete;

 private:
  Trace& trace_;
  const char* const name_;
  const std::uint64_t frame_;
  const std::int64_t begin_ns_;
};

}  // namespace rtd::service
