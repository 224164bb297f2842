// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/topic_source.hpp"

#include <mutex>
#include <utility>

#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::service {
namespace {

using Event = bus::SourceGate::Event;

const char* cause_of(Event event) {
  switch (event) {
    case Event::kTaken:
      return "the one before has ended";
    case Event::kSilent:
      return "the one before fell silent";
    case Event::kBack:
      return "it was there before and sends again";
    case Event::kFirst:
    case Event::kRefused:
      break;
  }
  return "";
}

/// Several readers may share a gate.
class SourceLog {
 public:
  explicit SourceLog(std::string service) : service_(std::move(service)) {}
  void report(Event event, const bus::ParticipantId& source, const bus::ParticipantId& other) {
    if (event == Event::kFirst) return;
    const std::lock_guard lock(mutex_);
    if (!(event == Event::kRefused ? refusals_ : changes_).pass()) return;
    if (event == Event::kRefused) {
      SPDLOG_ERROR("event=second_source of={} source={} followed={} fix=\"stop one, or give it another --domain\"",
                   service_, bus::to_string(other), bus::to_string(source));
    } else {
      SPDLOG_WARN("event=source_changed of={} source={} before={} cause=\"{}\"", service_, bus::to_string(source),
                  bus::to_string(other), cause_of(event));
    }
  }

 private:
  const std::string service_;
  std::mutex mutex_;
  RateLimit refusals_{std::chrono::seconds(5)}, changes_{std::chrono::seconds(1)};
};

}  // namespace

std::shared_ptr<bus::SourceGate> follow_source(const std::string& service, ProcessGone gone, std::int64_t silence_ns) {
  bus::SourceGate::Options options;
  options.silence_ns = silence_ns;
  options.clock = monotonic_ns;
  options.gone = std::move(gone);
  options.report = [log = std::make_shared<SourceLog>(service)](Event event, const bus::ParticipantId& source,
                                                                const bus::ParticipantId& other) {
    log->report(event, source, other);
  };
  return std::make_shared<bus::SourceGate>(std::move(options));
}

std::shared_ptr<bus::SourceGate> follow_source(const std::string& service, Runtime& runtime, std::int64_t silence_ns) {
  auto gate = follow_source(service, runtime.heartbeat.process_gone(), silence_ns);
  if (runtime.bus_options.security.enabled()) runtime.heartbeat.accept_only_from(service, gate);
  return gate;
}

}  // namespace rtd::service
