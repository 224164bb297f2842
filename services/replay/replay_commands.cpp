// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/replay_commands.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <utility>

#include "common/io/text.hpp"
#include "common/msg/replay_rates.hpp"

namespace rtd::replay {
namespace {

using Action = Request::Action;

constexpr std::chrono::seconds kPatience{5};  // a step at pace lockstep waits for the answers of slam

double to_s(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

/// What the player has done.
struct Outcome {
  PlayState state;
  std::string problem;
};

}  // namespace

ReplayCommands::ReplayCommands(bus::Bus& bus, const RecordedSpan& span, std::function<void(Request)> post)
    : span_(span), post_(std::move(post)), server_(bus) {
  using bus::CommandKind;
  using bus::CommandRequest;
  server_.offer_concurrent("replay/pause", CommandKind::kSetBool, [this](const CommandRequest& asked) {
    return asked.argument == "true" ? ask({Action::kPause}, "paused") : ask({Action::kResume}, "playing");
  });
  server_.offer_concurrent("replay/step", CommandKind::kTrigger, [this](const CommandRequest&) {
    return ask({Action::kStepFrame}, "one frame further, paused");
  });
  server_.offer_concurrent("replay/seek", CommandKind::kText,
                           [this](const CommandRequest& asked) { return seek(asked.argument); });
  server_.offer_concurrent("replay/speed", CommandKind::kText,
                           [this](const CommandRequest& asked) { return set_rate(asked.argument); });
}

bus::CommandAnswer ReplayCommands::ask(Request request, const char* what) const {
  const auto promise = std::make_shared<std::promise<Outcome>>();
  std::future<Outcome> future = promise->get_future();
  request.done = [promise](const PlayState& state, const std::string& problem) {
    promise->set_value({state, problem});
  };
  post_(std::move(request));
  if (future.wait_for(kPatience) != std::future_status::ready)
    return {false, "not done yet: the replay waits for other services; it will do it when they answer"};
  try {
    const Outcome outcome = future.get();
    if (!outcome.problem.empty()) return {false, outcome.problem};
    const std::string speed = outcome.state.rate > 0 ? fmt::format(", speed {:g}", outcome.state.rate) : "";
    return {true, fmt::format("{} at {:.1f} s of {:.1f} s{}", what, to_s(outcome.state.recorded_ns - span_.first_ns),
                              to_s(span_.end_ns - span_.first_ns), speed)};
  } catch (const std::future_error&) {
    return {false, "the replay has ended"};
  }
}

bus::CommandAnswer ReplayCommands::seek(const std::string& argument) const {
  const double least = to_s(span_.start_ns - span_.first_ns), most = to_s(span_.end_ns - span_.first_ns);
  const auto position_s = io::parse_number(argument);
  if (!position_s || !std::isfinite(*position_s) || *position_s < least - 1e-3 || *position_s > most + 0.05)
    return {false, fmt::format("'{}' is no position: give seconds from the beginning, {:.3f} to {:.3f}", argument,
                               least, most)};
  const auto offset_ns = static_cast<std::int64_t>(*position_s * 1e9);
  return ask({Action::kSeek, span_.first_ns + offset_ns}, "continues");
}

bus::CommandAnswer ReplayCommands::set_rate(const std::string& argument) const {
  const auto rate = io::parse_number(argument);
  if (!rate || !std::isfinite(*rate) || *rate < msg::kLowestReplayRate || *rate > msg::kHighestReplayRate)
    return {false, fmt::format("'{}' is no speed: give a number from {:g} to {:g}, 1 = as recorded", argument,
                               msg::kLowestReplayRate, msg::kHighestReplayRate)};
  return ask({Action::kSetRate, 0, *rate}, "continues");
}

}  // namespace rtd::replay
