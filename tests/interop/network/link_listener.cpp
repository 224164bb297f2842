// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// link_listener DOMAIN VENDOR FILE [PROFILE]: listens on the first host until SIGINT, then writes what came into FILE,
// a line each: `detection STAMP_NS MONOTONIC_NS`, `pose SEQ MONOTONIC_NS LATENCY_NS`, `frame SEQ MONOTONIC_NS`. Says on
// stdout when it listens and when the first detections came. PROFILE `remote`: as on another host, raw frames and
// features only. PROFILE `robot=NAME`: topics of that robot, in a domain that is limited to its host.
#include <signal.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <string_view>

#include "common/bus/bus_factory.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/run_service.hpp"

namespace rtd::bus {
namespace {

constexpr int kDetectionsBeforeWord = 3;
constexpr std::int64_t kLongSilenceNs = 3'000'000'000;

struct Book {
  std::mutex mutex;
  std::ostringstream lines;
  int detections = 0;
  std::int64_t last_detection_ns = 0;
};

BusOptions network_options(char** argv) {
  BusOptions options;
  options.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  options.vendor = argv[2];
  options.participant_name = "link-listener";
  options.network.loopback_only = false;
  options.network.multicast = false;
  options.network.max_datagram_bytes = 1400;
  return options;
}

/// Waits for the end, which a blocked bus does not hold up once `path` is written.
struct End {
  sigset_t signals{};
  std::string path;
  service::BoundedEnd bounded{"link_listener"};

  void await() const {
    int number = 0;
    sigwait(&signals, &number);
  }
  void write(Book& book) {
    const std::lock_guard lock(book.mutex);
    std::ofstream(path) << book.lines.str();
    bounded.begin(0, std::chrono::seconds(10));
  }
};

void listen_on_first_host(Bus& bus, Book& book, End& end) {
  const auto detections = bus.reader<msg::Detection2DArray>(topics::kDetections, [&](auto message) {
    const std::lock_guard lock(book.mutex);
    const std::int64_t now_ns = service::monotonic_ns();
    book.lines << "detection " << msg::to_ns(message->header.stamp) << ' ' << now_ns << '\n';
    if (++book.detections == kDetectionsBeforeWord) std::puts("detections come");
    if (book.detections > 1 && now_ns - book.last_detection_ns > kLongSilenceNs) std::puts("detections are back");
    book.last_detection_ns = now_ns;
    std::fflush(stdout);
  });
  const auto poses = bus.reader<msg::TrackingResult>(topics::kTracking, [&](auto result) {
    const std::lock_guard lock(book.mutex);
    book.lines << "pose " << result->seq << ' ' << service::monotonic_ns() << ' '
               << result->finished_ns - result->published_ns << '\n';
  });
  std::puts("listening");
  std::fflush(stdout);
  end.await();
  end.write(book);
}

void note_matched(Book& book, std::size_t writers) {
  const std::lock_guard lock(book.mutex);
  book.lines << "matched " << writers << '\n';
}

void listen_elsewhere(Bus& bus, Book& book, End& end) {
  const auto note = [&](std::uint64_t seq) {
    const std::lock_guard lock(book.mutex);
    book.lines << "frame " << seq << ' ' << service::monotonic_ns() << '\n';
  };
  const auto frames = bus.reader<msg::RgbdFrame>(topics::kFrame, [&](auto frame) { note(frame->seq); });
  const auto features = bus.reader<msg::FeatureFrame>(topics::kFeatures, [&](auto frame) { note(frame->seq); });
  std::puts("listening");
  std::fflush(stdout);
  end.await();
  note_matched(book, frames.matched() + features.matched());
  end.write(book);
}

}  // namespace
}  // namespace rtd::bus

int main(int argc, char** argv) try {
  if (argc < 4) return 2;
  rtd::bus::Book book;
  rtd::bus::End end;
  end.path = argv[3];
  sigemptyset(&end.signals);
  sigaddset(&end.signals, SIGINT);
  sigaddset(&end.signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &end.signals, nullptr);  // before any thread exists
  const bool elsewhere = argc > 4 && std::string(argv[4]) == "remote";
  rtd::bus::BusOptions options = rtd::bus::network_options(argv);
  if (elsewhere) options.network.peers = {"10.99.0.1"};
  constexpr std::string_view kRobot = "robot=";
  if (argc > 4 && std::string_view(argv[4]).starts_with(kRobot)) {
    options.robot = argv[4] + kRobot.size();
    options.network = {};
  }
  const auto bus = rtd::bus::connect(options);
  elsewhere ? rtd::bus::listen_elsewhere(*bus, book, end) : rtd::bus::listen_on_first_host(*bus, book, end);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "link_listener: %s\n", error.what());
  return 2;
}
