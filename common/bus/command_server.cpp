// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <utility>

#include "common/bus/command_codec.hpp"
#include "common/bus/commands.hpp"
#include "common/bus/robot.hpp"

namespace rtd::bus {
namespace {

constexpr char kEnding[] = "the service is ending";

CallTopics topics_of(const Bus& bus, const std::string& name, CommandKind kind) {
  CallTopics topics = call_topics(name, kind);
  topics.request = topic_of_robot(topics.request, bus.robot());
  topics.reply = topic_of_robot(topics.reply, bus.robot());
  return topics;
}

}  // namespace

CommandServer::Listed::Listed(std::shared_ptr<CommandRegistry> commands, std::string name, Handler handler)
    : commands_(std::move(commands)), name_(std::move(name)) {
  commands_->add(name_, std::move(handler));
}

CommandServer::Listed::~Listed() {
  commands_->remove(name_);
}

CommandAnswer CommandServer::Listed::handle(CommandKind kind, std::span<const std::byte> cdr) const {
  if (cdr.size() > kMaxRequestBytes)
    return {false, "a request has at most " + std::to_string(kMaxRequestBytes) + " bytes"};
  try {
    return commands_->call(name_, decode_request(kind, cdr)).value_or(CommandAnswer{false, kEnding});
  } catch (const std::exception& error) {
    return {false, error.what()};
  }
}

CommandServer::CommandServer(Bus& bus, const std::string& name, CommandKind kind, Handler handler)
    : listed_(bus.commands(), name, std::move(handler)),
      calls_(bus, {{topics_of(bus, name, kind), [this, kind](std::span<const std::byte> cdr) {
                      return encode_answer(listed_.handle(kind, cdr));
                    }}}) {}

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
    if (closed_) return {false, kEnding};
    tasks_.push_back(std::move(task));
  }
  if (wake_) wake_();
  try {
    return answer.get();
  } catch (const std::future_error&) {
    return {false, kEnding};
  }
}

}  // namespace rtd::bus
