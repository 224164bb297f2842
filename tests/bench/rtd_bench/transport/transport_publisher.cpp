// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

#include "common/concurrency/bounded_queue.hpp"
#include "tests/bench/rtd_bench/bench_clock.hpp"
#include "tests/bench/rtd_bench/transport/bench_messages.hpp"
#include "tests/bench/rtd_bench/transport/transport_worker.hpp"

namespace rtd::bench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Acks = concurrency::BoundedQueue<Tag>;

constexpr int kWarmUp = 30;
constexpr std::uint64_t kInFlight = 3;  // as the camera has them at pace asap

/// A plain copy as a measure: into four buffers in turn, as many as a frame writer's history has.
class MemcpyReference {
 public:
  explicit MemcpyReference(std::size_t bytes) : from_(bytes) {
    for (auto& to : to_) to.resize(bytes);
  }
  double measure_us() {
    std::memset(from_.data(), static_cast<int>(++turn_), from_.size());  // as warm as a message just filled
    auto& to = to_[turn_ % to_.size()];
    const std::int64_t start_ns = monotonic_ns();
    std::memcpy(to.data(), from_.data(), from_.size());
    const double us = static_cast<double>(monotonic_ns() - start_ns) / 1000.0;
    sum_ = sum_ + to[to.size() / 2];  // the copy is used
    return us;
  }

 private:
  std::vector<unsigned char> from_;
  std::array<std::vector<unsigned char>, 4> to_;
  std::size_t turn_ = 0;
  volatile unsigned sum_ = 0;
};

template <class T>
class Sender {
 public:
  Sender(bus::Bus& bus, const bus::Topic<T>& topic) : writer_(bus.writer(topic)) { fill(*message_, 0); }

  bool ready() const { return writer_.matched() > 0; }
  std::size_t bytes() const { return payload_bytes(*message_); }
  /// `fresh`: with new content, which is not part of the latency.
  void send(Phase phase, std::uint64_t number, bool fresh) {
    Tag tag{phase, number, 0};
    if constexpr (bus::MessageTraits<T>::kPlain) {
      auto loan = writer_.loan();
      if (fresh || number < kInFlight) fill(*loan, number);
      tag.sent_ns = monotonic_ns();
      put(tag, *loan);
      writer_.write(std::move(loan));
    } else {
      if (fresh) fill(*message_, number);
      tag.sent_ns = monotonic_ns();
      put(tag, *message_);
      writer_.write(*message_);
    }
  }

 private:
  bus::Writer<T> writer_;
  std::unique_ptr<T> message_ = std::make_unique<T>();  // up to 11.5 MB
};

/// Until messages are answered: then both directions stand.
template <class T>
void warm_up(Sender<T>& sender, Acks& acks) {
  const auto end = Clock::now() + 10s;
  int answered = 0;
  for (std::uint64_t i = 0; answered < kWarmUp; ++i) {
    if (Clock::now() > end) throw std::runtime_error("the subscriber did not answer within 10 s");
    if (sender.ready()) sender.send(Phase::kWarmUp, i, true);
    if (acks.pop_for(10ms)) ++answered;
  }
  while (acks.pop_for(50ms)) {
  }
}

template <class T>
void measure_latency(Sender<T>& sender, const TransportOptions& options, PublisherResult& result) {
  const auto period = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / options.rate_hz));
  MemcpyReference reference(result.bytes);
  CpuMeter cpu;
  std::int64_t reference_ns = 0;
  cpu.start();
  auto next = Clock::now();
  for (int i = 0; i < options.messages; ++i) {
    sender.send(Phase::kLatency, static_cast<std::uint64_t>(i), true);
    std::this_thread::sleep_until(next + period / 2);
    const std::int64_t begin_ns = read_clock_ns(CLOCK_THREAD_CPUTIME_ID);
    result.memcpy_us.push_back(reference.measure_us());
    reference_ns += read_clock_ns(CLOCK_THREAD_CPUTIME_ID) - begin_ns;
    std::this_thread::sleep_until(next += period);
  }
  result.cpu_percent = cpu.percent(reference_ns);
}

template <class T>
void measure_rate(Sender<T>& sender, Acks& acks, double seconds, PublisherResult& result) {
  std::uint64_t sent = 0, answered = 0;
  const auto begin = Clock::now(), end = begin + std::chrono::nanoseconds(static_cast<std::int64_t>(seconds * 1e9));
  while (Clock::now() < end) {
    while (sent < answered + kInFlight) sender.send(Phase::kFlood, sent++, false);
    if (const auto ack = acks.pop_for(500ms)) {
      result.repeated += ack->number > answered ? ack->number - answered : 0;  // those before it were lost
      answered = std::max(answered, ack->number + 1);
    } else {
      result.repeated += sent - answered;
      answered = sent;
    }
  }
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin).count();
  result.rate_hz = static_cast<double>(answered - result.repeated) / elapsed_s;
}

}  // namespace

PublisherResult publish(const TransportCase& what, const TransportOptions& options) {
  const auto bus = bus::connect(bus_options(what, options.domain, "bench-publisher"));
  Acks acks(1000, concurrency::Overflow::kDropOldest);
  const auto answers =
      bus->reader<msg::TrackingResult>(kAckTopic, [&](const auto& answer) { acks.push(Tag::unpack(answer->seq, 0)); });
  return with_topic(what, [&](const auto& topic) {
    PublisherResult result;
    Sender sender(*bus, topic);
    result.bytes = sender.bytes();
    warm_up(sender, acks);
    measure_latency(sender, options, result);
    measure_rate(sender, acks, options.flood_s, result);
    return result;
  });
}

}  // namespace rtd::bench
