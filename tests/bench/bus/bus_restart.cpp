// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Kills a publisher of raw frames (1.5 MB at 30 Hz) by SIGKILL again and again and starts it again, as a supervisor
// would, while one subscriber lives on: how long is the gap between two frames, does each successor rejoin, does
// anything stay in shared memory? Exit code 0: all rejoined within --max-gap-ms and nothing is left.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/host/shm_leftovers.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "tests/support/frame_header.hpp"
#include "tests/support/test_domain.hpp"

extern char** environ;

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Options {
  std::string vendor = BusOptions{}.vendor;
  std::uint32_t domain = test_domain();
  int restarts = 50;
  int max_gap_ms = 1000;
  bool publisher = false;  ///< the process that is killed
};

std::shared_ptr<Bus> connect_bench(const Options& options) {
  BusOptions bus;
  bus.vendor = options.vendor;
  bus.domain = options.domain;
  bus.participant_name = "bus-restart";
  return connect(bus);
}

/// The process that is killed: cleans and joins as a service does.
int publish(const Options& options) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // not to publish into the next campaign
  const auto bus = connect_bench(options);
  std::thread([] { remove_shm_leftovers(); }).detach();
  auto frames = bus->writer(topics::kFrame);
  for (auto next = Clock::now();; next += 33'333us) {
    auto frame = frames.loan();
    test_support::fill_header(*frame, 640, 480);
    frame->source_id = static_cast<std::uint64_t>(getpid());
    frames.write(std::move(frame));
    std::this_thread::sleep_until(next);
  }
}

class Publisher {
 public:
  explicit Publisher(const Options& options) {
    std::string self = "/proc/self/exe", domain = std::to_string(options.domain), vendor = options.vendor;
    std::string words[] = {"bus_restart", "--publisher", "--dds", vendor, "--domain", domain};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (posix_spawn(&pid_, self.c_str(), nullptr, nullptr, argv.data(), environ) != 0) {
      throw std::runtime_error("cannot start a publisher");
    }
  }
  ~Publisher() { kill_now(); }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  pid_t pid() const { return pid_; }
  void kill_now() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }

 private:
  pid_t pid_ = 0;
};

/// The files of shared memory that a process maps.
std::set<std::string> shm_files_of(pid_t pid) {
  std::set<std::string> files;
  std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t at = line.find("/dev/shm/");
    if (at != std::string::npos) files.insert(line.substr(at));
  }
  return files;
}

struct Arrival {
  Clock::time_point time;
  pid_t publisher = 0;
};

/// What a living subscriber sees of publishers that are killed.
class Campaign {
 public:
  explicit Campaign(const Options& options) : options_(options), bus_(connect_bench(options)) {
    reader_ = bus_->reader(topics::kFrame, [this](std::shared_ptr<const msg::RgbdFrame> frame) {
      arrivals_.push({Clock::now(), static_cast<pid_t>(frame->source_id)});
    });
  }

  /// Frames of this publisher for about a second; the time of the last one. Throws when none comes.
  Clock::time_point receive(const Publisher& publisher, std::chrono::milliseconds duration) {
    Arrival arrival = first_of(publisher);
    const auto end = Clock::now() + duration;
    while (Clock::now() < end) {
      if (const auto next = arrivals_.pop_for(100ms)) arrival = *next;
    }
    return arrival.time;
  }

  Arrival first_of(const Publisher& publisher) {
    const auto end = Clock::now() + 10s;
    while (Clock::now() < end) {
      const auto arrival = arrivals_.pop_for(100ms);
      if (arrival && arrival->publisher == publisher.pid()) return *arrival;
    }
    throw std::runtime_error("no frame of publisher " + std::to_string(publisher.pid()) + " within 10 s");
  }

  std::vector<double> run() {
    std::vector<double> gaps_ms;
    std::mt19937 random(1);
    auto publisher = std::make_unique<Publisher>(options_);
    for (int i = 0; i < options_.restarts; ++i) {
      Clock::time_point last = receive(*publisher, std::chrono::milliseconds(500 + random() % 500));
      doomed_.merge(shm_files_of(publisher->pid()));
      // At any time between two frames: receive() ends just when one has come, its writer perhaps still about it.
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 33'333));
      publisher->kill_now();
      while (const auto late = arrivals_.pop_for(0ms)) last = late->time;  // was under way
      publisher = std::make_unique<Publisher>(options_);
      gaps_ms.push_back(std::chrono::duration<double, std::milli>(first_of(*publisher).time - last).count());
      std::printf("restart %2d  gap %6.1f ms\n", i + 1, gaps_ms.back());
      std::fflush(stdout);
    }
    return gaps_ms;
  }

  /// Files of killed publishers that are still there after a further start, or two: the first one leaves the cleaning
  /// to a process elsewhere that has begun with it at that moment.
  std::vector<std::string> leftovers() {
    std::this_thread::sleep_for(6s);  // until the subscriber has forgotten the dead, and no file is young
    return after_a_start().empty() ? std::vector<std::string>() : after_a_start();
  }

 private:
  std::vector<std::string> after_a_start() {
    Publisher publisher(options_);
    receive(publisher, 500ms);
    const auto needed = shm_files_of(publisher.pid()), own = shm_files_of(getpid());
    std::vector<std::string> left;
    for (const std::string& file : doomed_) {
      if (access(file.c_str(), F_OK) == 0 && needed.count(file) + own.count(file) == 0) left.push_back(file);
    }
    return left;
  }

  const Options options_;
  concurrency::BoundedQueue<Arrival> arrivals_{1000, concurrency::Overflow::kDropOldest};
  std::set<std::string> doomed_;
  std::shared_ptr<Bus> bus_;
  Reader<msg::RgbdFrame> reader_;
};

int run(const Options& options) {
  Campaign campaign(options);
  std::vector<double> gaps_ms = campaign.run();
  const std::vector<std::string> left = campaign.leftovers();
  std::sort(gaps_ms.begin(), gaps_ms.end());
  std::printf("%s: %zu/%d rejoined, gap p50 %.0f ms, max %.0f ms, %zu leftovers after the next start\n",
              options.vendor.c_str(), gaps_ms.size(), options.restarts, gaps_ms[gaps_ms.size() / 2], gaps_ms.back(),
              left.size());
  for (const std::string& file : left) std::printf("left: %s\n", file.c_str());
  return gaps_ms.back() <= options.max_gap_ms && left.empty() ? 0 : 1;
}

}  // namespace
}  // namespace rtd::bus

int main(int argc, char** argv) try {
  rtd::bus::Options options;
  CLI::App app{"Gap at a living subscriber while a publisher of 1.5 MB frames at 30 Hz is killed and restarted"};
  app.add_option("--dds", options.vendor, "DDS implementation")->capture_default_str();
  app.add_option("--domain", options.domain, "DDS domain, else one of this process's own");
  app.add_option("--restarts", options.restarts, "How often")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--max-gap-ms", options.max_gap_ms, "Longest gap that is no failure")->capture_default_str();
  app.add_flag("--publisher", options.publisher)->group("");
  CLI11_PARSE(app, argc, argv);
  return options.publisher ? rtd::bus::publish(options) : rtd::bus::run(options);
} catch (const std::exception& error) {
  std::fprintf(stderr, "bus_restart: %s\n", error.what());
  return 1;
}
