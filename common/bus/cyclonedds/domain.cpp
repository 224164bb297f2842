// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/domain.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>

#include "common/bus/cyclonedds/domain_config.hpp"

namespace rtd::bus::cyclonedds {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kLinesAtOnce = 10;
constexpr std::chrono::seconds kPeriod{10};
constexpr std::size_t kLongestLine = 240;

std::string text_of(const dds_log_data_t& line) {
  std::string text(line.message, std::min<std::size_t>(line.size, kLongestLine));
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

/// Cyclone calls its sink from any thread, one call at a time or not.
struct Limit {
  std::mutex mutex;
  Clock::time_point begin;
  int lines = 0;
};

void print_some(void* self, const dds_log_data_t* line) {
  Limit& limit = *static_cast<Limit*>(self);
  const std::lock_guard lock(limit.mutex);
  const Clock::time_point now = Clock::now();
  if (now - limit.begin > kPeriod) {
    if (limit.lines > kLinesAtOnce) {
      std::fprintf(stderr, "Cyclone DDS: %d more lines like these\n", limit.lines - kLinesAtOnce);
    }
    limit.begin = now;
    limit.lines = 0;
  }
  if (++limit.lines <= kLinesAtOnce) std::fprintf(stderr, "Cyclone DDS: %s\n", text_of(*line).c_str());
}

std::mutex& domains_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::shared_ptr<Domain> create_domain(const BusOptions& options, const std::string& config) {
  if (options.iceoryx) require_roudi();
  const LogCapture log;
  const dds_entity_t handle = dds_create_domain(options.domain, config.c_str());
  if (handle < 0) {
    throw BusError("Cyclone DDS refused to join domain " + std::to_string(options.domain) + " (" +
                   dds_strretcode(handle) + ")" + log.reason() +
                   "; is the interface up (ip link set lo up) and are fewer than 60 participants in this domain?");
  }
  return {new Domain{config, Entity(handle)}, [](Domain* domain) {
            const std::lock_guard lock(domains_mutex());  // no connection joins while it ends
            delete domain;
          }};
}

}  // namespace

std::shared_ptr<Domain> join_domain(const BusOptions& options) {
  static std::map<std::uint32_t, std::weak_ptr<Domain>> domains;  // Cyclone's own table is per process, too
  const std::string config = domain_config(options, read_host_limits());
  const std::lock_guard lock(domains_mutex());
  if (const auto known = domains[options.domain].lock()) {
    if (known->config == config) return known;
    throw BusError("this process is in domain " + std::to_string(options.domain) +
                   " with other network settings; Cyclone DDS allows one set of them for a domain and process");
  }
  const auto domain = create_domain(options, config);
  domains[options.domain] = domain;
  return domain;
}

LogCapture::~LogCapture() {
  static Limit limit;
  dds_set_log_sink(print_some, &limit);
}

std::string LogCapture::reason() const {
  const std::lock_guard lock(mutex_);
  return text_.empty() ? "" : ": " + text_;
}

void LogCapture::note(void* self, const dds_log_data_t* line) {
  LogCapture& capture = *static_cast<LogCapture*>(self);
  const std::lock_guard lock(capture.mutex_);
  std::string& text = capture.text_;
  if (text.size() < 2000) text += (text.empty() ? "" : "; ") + text_of(*line);
}

}  // namespace rtd::bus::cyclonedds
