// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/command_desk.hpp"

#include <utility>

namespace rtd::bus {

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
