// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

#include "common/bus/backend.hpp"
#include "common/bus/command_codec.hpp"
#include "common/bus/commands.hpp"
#include "common/bus/robot.hpp"
#include "common/concurrency/bounded_queue.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

constexpr char kEnding[] = "the service is ending";
constexpr std::size_t kMaxWaiting = 16;
/// A client that has just appeared may not receive replies yet: its two endpoints are found one after the other.
constexpr auto kClientPatience = 500ms;

CallTopics topics_of(const Bus& bus, const std::string& name, CommandKind kind) {
  CallTopics topics = call_topics(name, kind);
  topics.request = topic_of_robot(topics.request, bus.robot());
  topics.reply = topic_of_robot(topics.reply, bus.robot());
  return topics;
}

/// A command in the registry while it lives.
class Listed {
 public:
  Listed(std::shared_ptr<CommandRegistry> commands, std::string name, CommandHandler handler)
      : commands_(std::move(commands)), name_(std::move(name)) {
    commands_->add(name_, std::move(handler));
  }
  ~Listed() { commands_->remove(name_); }
  Listed(const Listed&) = delete;
  Listed& operator=(const Listed&) = delete;

  CommandAnswer handle(CommandKind kind, std::span<const std::byte> cdr) const {
    if (cdr.size() > kMaxRequestBytes)
      return {false, "a request has at most " + std::to_string(kMaxRequestBytes) + " bytes"};
    try {
      return commands_->call(name_, decode_request(kind, cdr)).value_or(CommandAnswer{false, kEnding});
    } catch (const std::exception& error) {
      return {false, error.what()};
    }
  }

 private:
  const std::shared_ptr<CommandRegistry> commands_;
  const std::string name_;
};

}  // namespace

/// The requests of some services, answered one after the other on its thread.
class CommandServer::Listener {
 public:
  Listener(Bus& bus, std::vector<Service> services) : services_(std::move(services)) {
    for (std::size_t service = 0; service < services_.size(); ++service) {
      calls_.push_back(bus.calls(services_[service].topics, CallRole::kServer,
                                 [this, service](const CallId& id, std::span<const std::byte> cdr) {
                                   const auto kept = cdr.first(std::min(cdr.size(), kMaxRequestBytes + 1));
                                   waiting_.push({service, id, {kept.begin(), kept.end()}});
                                 }));
    }
    thread_ = std::thread([this] { serve(); });
  }
  ~Listener() {
    waiting_.close();
    thread_.join();
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

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

CommandServer::CommandServer(Bus& bus) : bus_(bus) {}

CommandServer::CommandServer(Bus& bus, const std::string& name, CommandKind kind, Handler handler) : bus_(bus) {
  offer_concurrent(name, kind, std::move(handler));
}

CommandServer::~CommandServer() {
  close();
}

void CommandRegistry::add(const std::string& name, CommandHandler handler) {
  auto entry = std::make_shared<Entry>();
  entry->handler = std::move(handler);
  const std::lock_guard lock(mutex_);
  entries_[name] = std::move(entry);
}

void CommandRegistry::remove(const std::string& name) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    const auto node = entries_.extract(name);
    if (node.empty()) return;
    entry = node.mapped();
  }
  const std::lock_guard running(entry->mutex);
  entry->handler = nullptr;
}

std::optional<CommandAnswer> CommandRegistry::call(const std::string& name, const CommandRequest& request) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(name);
    if (found == entries_.end()) return std::nullopt;
    entry = found->second;
  }
  const std::lock_guard running(entry->mutex);
  if (!entry->handler) return std::nullopt;
  try {
    return entry->handler(request);
  } catch (const std::exception& error) {
    return CommandAnswer{false, error.what()};
  }
}

void CommandServer::offer(const std::string& name, CommandKind kind, Handler handler) {
  offer_concurrent(name, kind, [this, handler = std::move(handler)](const CommandRequest& request) {
    return run([&] { return handler(request); });
  });
}

void CommandServer::offer_concurrent(const std::string& name, CommandKind kind, Handler handler) {
  const auto listed = std::make_shared<const Listed>(bus_.commands(), name, std::move(handler));
  offer_services({{topics_of(bus_, name, kind), [listed, kind](std::span<const std::byte> cdr) {
                     return encode_answer(listed->handle(kind, cdr));
                   }}});
}

void CommandServer::offer_services(std::vector<Service> services) {
  listeners_.push_back(std::make_unique<Listener>(bus_, std::move(services)));
}

void CommandServer::serve() {
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

void CommandServer::close() {
  std::deque<std::packaged_task<CommandAnswer()>> dropped;  // their futures get an error
  const std::lock_guard lock(mutex_);
  closed_ = true;
  dropped.swap(tasks_);
}

CommandAnswer CommandServer::run(std::function<CommandAnswer()> work) {
  std::packaged_task<CommandAnswer()> task(std::move(work));
  std::future<CommandAnswer> answer = task.get_future();
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return {false, kEnding};
    tasks_.push_back(std::move(task));
  }
  try {
    return answer.get();
  } catch (const std::future_error&) {
    return {false, kEnding};
  }
}

}  // namespace rtd::bus
