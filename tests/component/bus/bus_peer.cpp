// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The other process of the bus tests: bus_peer VENDOR ROLE DOMAIN [COUNT]. Roles below; runs until SIGTERM.
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "tests/component/bus/patterns.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  return set;
}

/// True once SIGTERM has come (it is blocked in all threads and taken here).
bool stop_asked(std::chrono::milliseconds wait = 0ms) {
  static bool asked = false;
  const sigset_t set = stop_signals();
  const timespec timeout{wait.count() / 1000, static_cast<long>(wait.count() % 1000) * 1'000'000};
  asked = asked || sigtimedwait(&set, nullptr, &timeout) == SIGTERM;
  return asked;
}

template <class T>
void wait_for_reader(const Writer<T>& writer) {
  while (writer.matched() == 0 && !stop_asked()) std::this_thread::sleep_for(1ms);
}

void stay() {
  while (!stop_asked(1000ms)) {
  }
}

/// COUNT frames as loans once a TrackingResult has come, the next when the last is acknowledged.
void send_frames(Bus& bus, int count) {
  auto writer = bus.writer(topics::kFrame);
  std::atomic<bool> go{false};  // either side may match first, and what is sent before both did may be missed
  const auto reader = bus.reader(topics::kTracking, [&](auto) { go = true; });
  while (!go && !stop_asked()) std::this_thread::sleep_for(1ms);
  wait_for_reader(writer);
  for (int seq = 0; seq < count && !stop_asked(); ++seq) {
    { const auto unwritten = writer.loan(); }  // must be given back, or there would be none left
    auto frame = writer.loan();
    fill_frame(*frame, static_cast<std::uint64_t>(seq));
    writer.write(std::move(frame));
    writer.wait_acknowledged(1000);
    std::this_thread::sleep_for(5ms);
  }
  stay();
}

/// Frames without end as fast as possible: a reader cannot keep up.
void flood_frames(Bus& bus, int) {
  auto writer = bus.writer(topics::kFrame);
  for (std::uint64_t seq = 0; !stop_asked(); ++seq) {
    auto frame = writer.loan();
    fill_frame(*frame, seq);
    writer.write(std::move(frame));
  }
}

/// Writers of frames that come and go while they write as fast as possible.
void churn_frames(Bus& bus, int) {
  while (!stop_asked()) {
    auto writer = bus.writer(topics::kFrame);
    const auto end = std::chrono::steady_clock::now() + 250ms;
    for (std::uint64_t seq = 0; std::chrono::steady_clock::now() < end; ++seq) {
      auto frame = writer.loan();
      if (seq < 8) fill_frame(*frame, seq);  // all slots
      frame->seq = seq;
      writer.write(std::move(frame));
    }
  }
}

/// Answers each message of the topic with a TrackingResult of its seq; inliers shows whether every byte was right,
/// landmarks which peer this is. The writer of the answers appears when the messages can be received: who sees it may
/// send.
template <class T>
void answer(Bus& bus, const Topic<T>& topic, int number) {
  concurrency::BoundedQueue<msg::TrackingResult> answers(64, concurrency::Overflow::kBlock);
  const auto reader = bus.reader(topic, [&](std::shared_ptr<const T> message) {
    msg::TrackingResult result{};
    result.seq = message->seq;
    result.landmarks = static_cast<std::uint32_t>(number);
    result.inliers = equals_pattern(*message) ? 1 : 0;
    answers.push(result);
  });
  while (reader.matched() == 0 && !stop_asked(1ms)) {
  }
  auto results = bus.writer(topics::kTracking);
  wait_for_reader(results);
  while (!stop_asked()) {
    if (const auto result = answers.pop_for(20ms)) results.write(*result);
  }
  answers.close();
}

void answer_features(Bus& bus, int number) {
  answer(bus, topics::kFeatures, number);
}
void answer_frames(Bus& bus, int number) {
  answer(bus, topics::kFrame, number);
}

/// COUNT keyframe events and one camera info for readers yet to come.
void leave_history(Bus& bus, int count) {
  auto keyframes = bus.writer(topics::kKeyframes);
  auto info = bus.writer(topics::kCameraInfo);
  for (int i = 0; i < count; ++i) {
    keyframes.write({.event_index = static_cast<std::uint64_t>(i), .kind = msg::KeyframeEventKind::kRemoved});
  }
  info.write(msg::CameraInfo{.header = {{12, 34}, "camera"}, .height = 480, .width = 640});
  stay();
}

/// A heartbeat every 50 ms.
void send_heartbeats(Bus& bus, int) {
  auto writer = bus.writer(topics::kStatus);
  while (!stop_asked(50ms)) writer.write(msg::ServiceStatus{.service = "peer", .pid = getpid()});
}

/// Two samples of so many MB on each of three topics, the second one as a request; then a TrackingResult.
void send_large_samples(const BusOptions& options, int megabytes) {
  const auto bus = connect(options);
  const auto raw = connect_raw(options);
  RawWriterOptions offered;
  offered.qos.depth = 1;
  offered.qos.deadline_ns = offered.qos.liveliness_lease_ns = 1'000'000'000;
  std::vector<std::byte> sample(static_cast<std::size_t>(megabytes) * 1'000'000);
  sample[1] = std::byte{1};
  for (const RawTopic& topic : {RawTopic{topics::kStatus.name, "rtd_msgs::msg::dds_::ServiceStatus_"},
                                RawTopic{"rq/test/largeRequest", "rtd_msgs::srv::dds_::Command_Request_"},
                                RawTopic{topics::kFeatures.name, "rtd_msgs::msg::dds_::FeatureFrame_"}}) {
    const auto writer = raw->writer(topic, offered);
    while (writer->matched() == 0 && !stop_asked()) std::this_thread::sleep_for(1ms);
    for (int i = 0; i < 2; ++i) {
      writer->write(sample);
      writer->wait_acknowledged(3000);
    }
  }
  auto done = bus->writer(topics::kTracking);
  wait_for_reader(done);
  while (!stop_asked(20ms)) done.write({});
}

int run(const std::string& vendor, const std::string& role, std::uint32_t domain, int count) {
  static const std::map<std::string, std::function<void(Bus&, int)>> kRoles = {
      {"send_frames", send_frames},     {"flood_frames", flood_frames},   {"answer_features", answer_features},
      {"answer_frames", answer_frames}, {"leave_history", leave_history}, {"send_heartbeats", send_heartbeats},
      {"churn_frames", churn_frames}};
  const auto entry = kRoles.find(role);
  BusOptions options;
  options.vendor = vendor;
  options.domain = domain;
  options.participant_name = "bus-peer";
  if (role == "send_large") return send_large_samples(options, count), 0;
  if (entry == kRoles.end()) return 2;
  entry->second(*connect(options), count);
  return 0;
}

}  // namespace
}  // namespace rtd::bus

int main(int argc, char** argv) try {
  if (argc < 4) return 2;
  const sigset_t set = rtd::bus::stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);  // before any thread exists
  const auto domain = static_cast<std::uint32_t>(std::atoi(argv[3]));
  return rtd::bus::run(argv[1], argv[2], domain, argc > 4 ? std::atoi(argv[4]) : 0);
} catch (const std::exception& error) {
  std::fprintf(stderr, "bus_peer: %s\n", error.what());
  return 2;
}
