// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The writing process of the interop matrix: interop_peer VENDOR DOMAIN live|late. Takes commands as lines on stdin
// (a number: the round to send; wait: for all to be acknowledged; end of file: the end), answers by lines on stdout.
#include <chrono>
#include <functional>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "tests/interop/bus/all_topics.hpp"

namespace rtd::bus::interop {
namespace {

using namespace std::chrono_literals;

/// Writers of all topics, by what they can be asked.
struct Writers {
  std::vector<std::function<int()>> matched;
  std::vector<std::function<void(int round)>> send;
  std::vector<std::function<bool()>> acknowledged;  // waits
};

Writers writers_of_all(Bus& bus) {
  Writers all;
  for_each_topic([&]<class T>(const Topic<T>& topic) {
    auto writer = std::make_shared<Writer<T>>(bus.writer(topic));
    all.matched.emplace_back([writer] { return writer->matched(); });
    all.acknowledged.emplace_back([writer] { return writer->wait_acknowledged(10'000); });
    all.send.emplace_back([writer, topic](int round) {
      const int count = burst(topic.profile);
      for (int i = 0; i < count; ++i) writer->write(*message_of(topic, round * count + i));
    });
  });
  return all;
}

bool all_matched(const Writers& writers) {
  for (int i = 0; i < 20'000; ++i) {
    bool all = true;
    for (const auto& matched : writers.matched) all = all && matched() > 0;
    if (all) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

void send_rounds(Bus& bus) {
  const Writers writers = writers_of_all(bus);
  std::cout << (all_matched(writers) ? "ready" : "not matched") << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    if (line == "wait") {
      bool all = true;
      for (const auto& acknowledged : writers.acknowledged) all = acknowledged() && all;
      std::cout << (all ? "acknowledged" : "not acknowledged") << std::endl;
    } else {
      for (const auto& send : writers.send) send(std::stoi(line));
    }
  }
}

/// Leaves on each transient-local topic more than its history holds, for readers yet to come.
void leave_history(Bus& bus) {
  std::vector<std::shared_ptr<void>> writers;
  for_each_topic([&]<class T>(const Topic<T>& topic) {
    if (!qos_settings(topic.profile).transient_local) return;
    auto writer = std::make_shared<Writer<T>>(bus.writer(topic));
    for (int i = 0; i < kForgotten + kept(topic.profile); ++i) writer->write(*message_of(topic, i));
    writers.push_back(writer);
  });
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
  }
}

}  // namespace
}  // namespace rtd::bus::interop

int main(int argc, char** argv) try {
  if (argc != 4) return 2;
  rtd::bus::BusOptions options;
  options.vendor = argv[1];
  options.domain = static_cast<std::uint32_t>(std::stoi(argv[2]));
  options.participant_name = "interop-peer";
  const auto bus = rtd::bus::connect(options);
  const bool late = std::string(argv[3]) == "late";
  late ? rtd::bus::interop::leave_history(*bus) : rtd::bus::interop::send_rounds(*bus);
  return 0;
} catch (const std::exception& error) {
  std::cerr << "interop_peer: " << error.what() << '\n';
  return 2;
}
