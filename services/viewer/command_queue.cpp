// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/command_queue.hpp"

#include <utility>

#include "common/service/log.hpp"

namespace rtd::viewer {
namespace {

constexpr int kTimeoutMs = 5'000, kMapTimeoutMs = 30'000;  // a large map takes its time

int timeout_of(const std::string& name) {
  return name.ends_with("_map") ? kMapTimeoutMs : kTimeoutMs;
}

bus::BusOptions named(bus::BusOptions options) {
  options.participant_name = "rtd-viewer-commands";
  options.robot.clear();  // full names
  return options;
}

}  // namespace

CommandQueue::CommandQueue(const bus::BusOptions& options, Dispatcher dispatcher)
    : dispatcher_(std::move(dispatcher)), client_(named(options)), thread_([this] { work(); }) {}

CommandQueue::~CommandQueue() {
  calls_.close();
  thread_.join();
}

void CommandQueue::call(const std::string& name, const std::string& argument, Answer answer) {
  if (calls_.size() >= kMaxWaiting) return answer({false, "too many calls are waiting; try again"});
  calls_.push({name, argument, std::move(answer)});
}

void CommandQueue::work() {
  while (auto call = calls_.pop()) {
    const CommandResult result = carry_out(*call);
    SPDLOG_INFO("event=command name={} argument=\"{}\" success={} answer=\"{}\"", call->name, call->argument,
                result.success, result.message);
    dispatcher_.order([answer = std::move(call->answer), result] { answer(result); });
  }
}

CommandResult CommandQueue::carry_out(const Call& call) {
  try {
    return client_.call(call.name, call.argument, timeout_of(call.name));
  } catch (const bus::BusError& error) {
    return {false, error.what()};
  }
}

}  // namespace rtd::viewer
