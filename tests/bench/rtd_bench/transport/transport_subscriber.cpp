// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <csignal>

#include "tests/bench/rtd_bench/bench_clock.hpp"
#include "tests/bench/rtd_bench/transport/bench_messages.hpp"
#include "tests/bench/rtd_bench/transport/transport_worker.hpp"

namespace rtd::bench {
namespace {

/// Takes the messages of one case. Called by the reader's thread only.
class Inbox {
 public:
  explicit Inbox(bus::Bus& bus) : acks_(bus.writer(kAckTopic)) {}

  void receive(const Tag& tag, std::int64_t now_ns) {
    if (tag.phase != Phase::kLatency) {
      msg::TrackingResult ack{};
      ack.seq = tag.packed();
      acks_.write(ack);
      return;
    }
    if (result_.latency_us.empty()) cpu_.start();
    result_.latency_us.push_back(static_cast<double>(now_ns - tag.sent_ns) / 1000.0);
    result_.cpu_percent = cpu_.percent();
  }
  const SubscriberResult& result() const { return result_; }

 private:
  bus::Writer<msg::TrackingResult> acks_;
  CpuMeter cpu_;
  SubscriberResult result_;
};

}  // namespace

SubscriberResult subscribe(const TransportCase& what, const TransportOptions& options) {
  const auto bus = bus::connect(bus_options(what, options.domain, "bench-subscriber"));
  Inbox inbox(*bus);
  with_topic(what, [&]<class T>(const bus::Topic<T>& topic) {
    const auto reader = bus->reader<T>(
        topic, [&](const std::shared_ptr<const T>& message) { inbox.receive(tag_of(*message), monotonic_ns()); });
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGTERM);
    int signal = 0;
    sigwait(&signals, &signal);
  });
  return inbox.result();
}

}  // namespace rtd::bench
