// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

#include "common/bus/command_codec.hpp"
#include "common/bus/commands.hpp"
#include "common/bus/robot.hpp"
#include "common/concurrency/bounded_queue.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxWaiting = 16;
/// A client that has just appeared may not receive replies yet: its two endpoints are found one after the other.
constexpr auto kClientPatience = 500ms;

CallTopics topics_of(const Bus& bus, const std::string& name, CommandKind kind) {
  CallTopics topics = call_topics(name, kind);
  topics.request = topic_of_robot(topics.request, bus.robot());
  topics.reply = topic_of_robot(topics.reply, bus.robot());
  return topics;
}

}  // namespace

class CommandServer::State {
 public:
  State(Bus& bus, const std::string& name, CommandKind kind, Handler handler)
      : kind_(kind),
        handler_(std::move(handler)),
        calls_(bus.calls(topics_of(bus, name, kind), CallRole::kServer,
                         [this](const CallId& id, std::span<const std::byte> cdr) { enqueue(id, cdr); })),
        thread_([this] { serve(); }) {}
  ~State() {
    waiting_.close();
    thread_.join();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

 private:
  struct Call {
    CallId id;
    std::vector<std::byte> cdr;
    bool too_long = false;
  };

  void enqueue(const CallId& id, std::span<const std::byte> cdr) {
    const bool too_long = cdr.size() > kMaxRequestBytes;
    const std::size_t kept = too_long ? 0 : cdr.size();
    waiting_.push({id, std::vector<std::byte>(cdr.begin(), cdr.begin() + static_cast<std::ptrdiff_t>(kept)), too_long});
  }
  void serve() {
    while (const auto call = waiting_.pop()) {
      if (waiting_.closed()) return;
      const CommandAnswer answer = handle(*call);
      wait_for_client();
      calls_->reply(call->id, encode_answer(answer));
    }
  }
  CommandAnswer handle(const Call& call) const {
    if (call.too_long) return {false, "a request has at most " + std::to_string(kMaxRequestBytes) + " bytes"};
    try {
      return handler_(decode_request(kind_, call.cdr));
    } catch (const std::exception& error) {
      return {false, error.what()};
    }
  }
  void wait_for_client() const {
    const auto end = std::chrono::steady_clock::now() + kClientPatience;
    while (calls_->matched_readers() < calls_->matched_writers() && !waiting_.closed() &&
           std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(2ms);
    }
  }

  const CommandKind kind_;
  const Handler handler_;
  concurrency::BoundedQueue<Call> waiting_{kMaxWaiting, concurrency::Overflow::kDropOldest};
  std::unique_ptr<CallEndpoint> calls_;
  std::thread thread_;
};

CommandServer::CommandServer(Bus& bus, const std::string& name, CommandKind kind, Handler handler)
    : state_(std::make_unique<State>(bus, name, kind, std::move(handler))) {}
CommandServer::~CommandServer() = default;

void CommandDesk::offer(const std::string& name, CommandKind kind, CommandServer::Handler handler) {
  offer_beside(name, kind, [this, handler = std::move(handler)](const CommandRequest& request) {
    return run([&] { return handler(request); });
  });
}

void CommandDesk::offer_beside(const std::string& name, CommandKind kind, CommandServer::Handler handler) {
  servers_.emplace_back(bus_, name, kind, std::move(handler));
}

void CommandDesk::serve() {
  while (true) {
    std::packaged_task<CommandAnswer()> task;
    {
      const std::lock_guard lock(mutex_);
      if (tasks_.empty()) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    task();
  }
}

void CommandDesk::close() {
  std::deque<std::packaged_task<CommandAnswer()>> dropped;  // their futures get an error
  const std::lock_guard lock(mutex_);
  closed_ = true;
  dropped.swap(tasks_);
}

CommandAnswer CommandDesk::run(std::function<CommandAnswer()> work) {
  std::packaged_task<CommandAnswer()> task(std::move(work));
  std::future<CommandAnswer> answer = task.get_future();
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return {false, "the service is ending"};
    tasks_.push_back(std::move(task));
  }
  if (wake_) wake_();
  try {
    return answer.get();
  } catch (const std::future_error&) {
    return {false, "the service is ending"};
  }
}

}  // namespace rtd::bus
