// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/stranger_watch.hpp"

#include <list>
#include <mutex>
#include <string_view>
#include <utility>

namespace rtd::bus::cyclonedds {
namespace {

/// Cyclone has one sink for the traces of all domains of a process, and does not tell it (0.10.2) which one speaks.
struct Watches {
  std::mutex mutex;
  std::list<StrangerWatch*> all;
};

Watches& watches() {
  static Watches watches;
  return watches;
}

}  // namespace

std::unique_ptr<StrangerWatch> StrangerWatch::start(const BusOptions& options) {
  if (!options.security.enabled() || !options.on_problem) return nullptr;
  return std::unique_ptr<StrangerWatch>(new StrangerWatch(options));
}

StrangerWatch::StrangerWatch(const BusOptions& options) : on_problem_(options.on_problem), strangers_(options.domain) {
  static std::once_flag once;
  std::call_once(once, [] { dds_set_trace_sink(dispatch, nullptr); });
  const std::lock_guard lock(watches().mutex);
  watches().all.push_back(this);
}

StrangerWatch::~StrangerWatch() {
  const std::lock_guard lock(watches().mutex);
  watches().all.remove(this);
}

void StrangerWatch::dispatch(void*, const dds_log_data_t* line) {
  const std::lock_guard lock(watches().mutex);
  for (StrangerWatch* watch : watches().all) watch->hear(*line);
}

void StrangerWatch::hear(const dds_log_data_t& line) {
  for (std::string& problem : strangers_.hear({line.message, line.size}, std::chrono::steady_clock::now()))
    thread_.post([this, problem = std::move(problem)] { on_problem_(problem); });
}

}  // namespace rtd::bus::cyclonedds
