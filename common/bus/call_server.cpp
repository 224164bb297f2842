// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/call_server.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "common/bus/backend.hpp"
#include "common/concurrency/bounded_queue.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxWaiting = 16;
/// A client that has just appeared may not receive replies yet: its two endpoints are found one after the other.
constexpr auto kClientPatience = 500ms;

}  // namespace

class CallServer::State {
 public:
  State(Bus& bus, std::vector<Service> services) : services_(std::move(services)) {
    for (std::size_t service = 0; service < services_.size(); ++service) {
      calls_.push_back(bus.calls(services_[service].topics, CallRole::kServer,
                                 [this, service](const CallId& id, std::span<const std::byte> cdr) {
                                   const auto kept = cdr.first(std::min(cdr.size(), kMaxRequestBytes + 1));
                                   waiting_.push({service, id, {kept.begin(), kept.end()}});
                                 }));
    }
    thread_ = std::thread([this] { serve(); });
  }
  ~State() {
    waiting_.close();
    thread_.join();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

 private:
  struct Call {
    std::size_t service = 0;
    CallId id;
    std::vector<std::byte> cdr;
  };

  void serve() {
    while (const auto call = waiting_.pop()) {
      if (waiting_.closed()) return;
      const std::vector<std::byte> reply = services_[call->service].handler(call->cdr);
      wait_for_client(*calls_[call->service], call->id);
      calls_[call->service]->reply(call->id, reply);
    }
  }
  void wait_for_client(const CallEndpoint& calls, const CallId& id) const {
    const auto end = std::chrono::steady_clock::now() + kClientPatience;
    while (!calls.reaches(id) && !waiting_.closed() && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(2ms);
    }
  }

  const std::vector<Service> services_;
  concurrency::BoundedQueue<Call> waiting_{kMaxWaiting, concurrency::Overflow::kDropOldest};
  std::vector<std::unique_ptr<CallEndpoint>> calls_;
  std::thread thread_;
};

CallServer::CallServer(Bus& bus, std::vector<Service> services)
    : state_(std::make_unique<State>(bus, std::move(services))) {}
CallServer::~CallServer() = default;

}  // namespace rtd::bus
