// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// How long a message takes from write() in one process until another process holds a copy that it may keep, beside a
// plain memcpy of the same size in the same run. Usage: bus_latency [MESSAGES]. Prints a table.
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/frame_topics.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "tests/support/frame_header.hpp"
#include "tests/support/test_domain.hpp"

extern char** environ;

namespace rtd::bus {
namespace {

using Results = concurrency::BoundedQueue<msg::TrackingResult>;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::shared_ptr<Bus> connect_bench(std::uint32_t domain) {
  BusOptions options;
  options.domain = domain;
  options.participant_name = "bus-latency";
  return connect(options);
}

/// The receiving process: reports for each message when it was there.
int answer(std::uint32_t domain) {
  const auto bus = connect_bench(domain);
  auto results = bus->writer(topics::kTracking);
  const auto reply = [&](std::uint64_t seq) {
    msg::TrackingResult result{};
    result.finished_ns = now_ns();
    result.seq = seq;
    results.write(result);
  };
  const FrameReader frames(*bus, [&](const auto& frame) { reply(frame->seq); });
  const auto features = bus->reader(topics::kFeatures, [&](auto message) { reply(message->seq); });
  while (true) pause();
}

struct Percentiles {
  double p50_us = 0, p99_us = 0, min_us = 0;
};

Percentiles percentiles(std::vector<double> samples_us) {
  if (samples_us.empty()) return {};
  std::sort(samples_us.begin(), samples_us.end());
  const auto at = [&](double q) {
    return samples_us[static_cast<std::size_t>(q * static_cast<double>(samples_us.size() - 1))];
  };
  return {at(0.5), at(0.99), samples_us.front()};
}

/// `send` writes message seq and returns the time at which it called write().
Percentiles measure(int messages, Results& results, const std::function<std::int64_t(std::uint64_t)>& send) {
  std::vector<double> samples_us;
  for (int i = 0; i < messages; ++i) {
    const auto seq = static_cast<std::uint64_t>(i);
    const std::int64_t sent_ns = send(seq);
    const auto result = results.pop_for(std::chrono::seconds(2));
    if (result && result->seq == seq) samples_us.push_back(static_cast<double>(result->finished_ns - sent_ns) / 1000.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (samples_us.size() < static_cast<std::size_t>(messages))
    std::printf("%zu of %d arrived\n", samples_us.size(), messages);
  return percentiles(samples_us);
}

template <class T>
Percentiles measure_memcpy(int messages) {
  const auto from = std::make_unique<T>(), to = std::make_unique<T>();
  std::vector<double> samples_us;
  for (int i = 0; i < messages; ++i) {
    std::memset(static_cast<void*>(from.get()), i, sizeof(T));  // as warm as a message that was just written
    const std::int64_t start_ns = now_ns();
    std::memcpy(static_cast<void*>(to.get()), from.get(), sizeof(T));
    samples_us.push_back(static_cast<double>(now_ns() - start_ns) / 1000.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return percentiles(samples_us);
}

template <std::uint32_t kWidth, std::uint32_t kHeight>
void make_plausible(msg::SizedFrame<kWidth, kHeight>& frame) {
  test_support::fill_header(frame, kWidth, kHeight);
}
void make_plausible(msg::FeatureFrame& features) {
  test_support::fill_camera(features, 640, 480);
  features.count = msg::kMaxFeatures;
}

template <class T>
Percentiles measure_loan(int messages, Results& results, Writer<T>& writer) {
  return measure(messages, results, [&](std::uint64_t seq) {
    auto message = writer.loan();
    std::memset(static_cast<void*>(&*message), 0, sizeof(T));
    make_plausible(*message);
    message->seq = seq;
    const std::int64_t sent_ns = now_ns();
    writer.write(std::move(message));
    return sent_ns;
  });
}

void print(const char* what, std::size_t bytes, const Percentiles& latency) {
  std::printf("%-34s %10zu %9.0f %9.0f %9.0f\n", what, bytes, latency.min_us, latency.p50_us, latency.p99_us);
}

/// The message against a memcpy of as many bytes.
template <class T>
void compare(const std::string& name, const Topic<T>& topic, Bus& bus, int messages, Results& results) {
  Writer<T> writer = bus.writer(topic);
  while (writer.matched() == 0) usleep(1000);
  const Percentiles copy = measure_memcpy<T>(messages), sent = measure_loan(messages, results, writer);
  print(("memcpy of " + name).c_str(), sizeof(T), copy);
  print((name + ": write -> copy elsewhere").c_str(), sizeof(T), sent);
  std::printf("%-34s %10s %9s %9.2f\n", "  ratio", "", "", sent.p50_us / copy.p50_us);
}

void run(int messages, std::uint32_t domain) {
  const auto bus = connect_bench(domain);
  Results results(64, concurrency::Overflow::kDropOldest);
  const auto reader = bus->reader(topics::kTracking, [&](auto result) { results.push(*result); });
  while (reader.matched() == 0) usleep(1000);

  std::printf("%-34s %10s %9s %9s %9s\n", "", "bytes", "min us", "p50 us", "p99 us");
  std::apply([&](const auto&... topic) { (compare(topic.name, topic, *bus, messages, results), ...); },
             topics::kFrames);
  compare("features", topics::kFeatures, *bus, messages, results);
}

}  // namespace
}  // namespace rtd::bus

int main(int argc, char** argv) {
  const auto domain = rtd::test_domain();
  if (argc == 3 && std::string(argv[1]) == "--answer")
    return rtd::bus::answer(static_cast<std::uint32_t>(std::atoi(argv[2])));
  std::string self = "/proc/self/exe", role = "--answer", domain_text = std::to_string(domain);
  char* child_argv[] = {self.data(), role.data(), domain_text.data(), nullptr};
  pid_t child = 0;
  if (posix_spawn(&child, self.c_str(), nullptr, nullptr, child_argv, environ) != 0) return 1;
  rtd::bus::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 200, domain);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  return 0;
}
