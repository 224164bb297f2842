// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// A participant of the security tests, honest or not: secure_peer VENDOR DOMAIN KEYSTORE|- ENCLAVE TAG TOPIC...
// It goes past our own checks of keystore and permissions, straight to the vendor. On each topic it writes "TAG N"
// fifty times a second, followed by "marker-TAG", and prints, five times a second, "sent N" and for each tag that it
// reads "got TAG N".
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/backend.hpp"
#include "tests/component/security/vendor_bus.hpp"

namespace rtd::bus {
namespace {

volatile sig_atomic_t g_stop = 0;

/// std_msgs/String as CDR.
std::vector<std::byte> to_cdr(const std::string& text) {
  std::vector<std::byte> cdr(8 + text.size() + 1);
  cdr[1] = std::byte{1};
  const auto size = static_cast<std::uint32_t>(text.size() + 1);
  std::memcpy(&cdr[4], &size, sizeof size);
  std::memcpy(&cdr[8], text.data(), text.size());
  return cdr;
}

std::string tag_in(std::span<const std::byte> cdr) {
  const std::string text = cdr.size() < 9 ? std::string() : std::string(reinterpret_cast<const char*>(&cdr[8]));
  return text.substr(0, text.find(' '));
}

class Peer {
 public:
  Peer(const BusOptions& options, std::string tag, const std::vector<std::string>& topics)
      : tag_(std::move(tag)), bus_(connect_unchecked(options)) {
    for (const std::string& topic : topics) open({topic, "std_msgs::msg::dds_::String_"});
  }

  void run() {
    for (int n = 0; g_stop == 0; ++n) {
      for (const auto& writer : writers_) writer->write(to_cdr(tag_ + " " + std::to_string(n) + " marker-" + tag_));
      if (n % 10 == 0) report(writers_.empty() ? 0 : n + 1);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

 private:
  void open(const RawTopic& topic) {
    try {
      writers_.push_back(bus_->writer(topic, {.qos = {.depth = 10}}));
    } catch (const BusError&) {
      std::printf("no writer of %s\n", topic.name.c_str());
    }
    try {
      readers_.push_back(bus_->reader(topic, {}, {.on_sample = [this](const RawSample& sample) {
                                        const std::lock_guard lock(mutex_);
                                        ++got_[tag_in(sample.cdr())];
                                      }}));
    } catch (const BusError&) {
      std::printf("no reader of %s\n", topic.name.c_str());
    }
  }
  void report(int sent) {
    const std::lock_guard lock(mutex_);
    if (writers_.empty()) std::printf("refused every topic\n");  // again, as the vendor's log may break into a line
    std::printf("sent %d\n", sent);
    for (const auto& [tag, count] : got_) std::printf("got %s %d\n", tag.c_str(), count);
    std::fflush(stdout);
  }

  const std::string tag_;
  std::mutex mutex_;
  std::map<std::string, int> got_;
  std::shared_ptr<RawBus> bus_;
  std::vector<std::unique_ptr<RawWriter>> writers_;
  std::vector<std::unique_ptr<RawReader>> readers_;
};

}  // namespace
}  // namespace rtd::bus

int main(int argc, char** argv) try {
  if (argc < 7) return 2;
  signal(SIGTERM, [](int) { rtd::bus::g_stop = 1; });
  rtd::bus::BusOptions options;
  options.vendor = argv[1];
  options.domain = static_cast<std::uint32_t>(std::stoi(argv[2]));
  options.participant_name = argv[5];
  if (std::strcmp(argv[3], "-") != 0) options.security = {argv[3], argv[4]};
  options.shared_memory = std::getenv("SECURE_PEER_UDP") == nullptr;  // set: everything goes over the wire
  options.on_problem = [](const std::string& problem) { std::printf("problem %s\n", problem.c_str()); };
  rtd::bus::Peer(options, argv[5], {argv + 6, argv + argc}).run();
  return 0;
} catch (const std::exception& error) {
  std::printf("refused %s\n", error.what());
  return 2;
}
