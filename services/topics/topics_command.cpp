// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/topics_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <ostream>
#include <set>

#include "common/mcap/recording_file.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/json_text.hpp"
#include "services/topics/core/topic_report.hpp"
#include "services/topics/recording_echo.hpp"
#include "services/topics/topics_session.hpp"

namespace rtd::topics {
namespace {

using namespace std::chrono_literals;

constexpr double kMaxSeconds = 1e6;
const std::string kOneTopic =
    "echo prints one topic of a running system, or any of a recording, whose file comes first; no such file: ";

CLI::App* add_action(CLI::App& app, TopicsRequest& request, const char* name, const char* description) {
  CLI::App* action = app.add_subcommand(name, description);
  action->callback([&request, name] { request.action = name; });
  service::add_bus_options(*action, request.bus);
  action->add_flag("--json", request.json, "Print JSON instead of text");
  return action;
}

}  // namespace

void add_topics_commands(CLI::App& app, TopicsRequest& request) {
  app.require_subcommand(1);
  add_action(app, request, "list", "Topics, types and what their writers offer")
      ->add_option("--wait", request.wait_s,
                   "Search this long at most, s; ends when no new writer has appeared for 2 s")
      ->check(CLI::Range(0.1, kMaxSeconds))
      ->capture_default_str();
  CLI::App* hz = add_action(app, request, "hz", "Rate, jitter, size and losses of topics");
  hz->add_option("topics", request.topics, "Topics by ROS or DDS name (default: all)");
  hz->add_option("--duration", request.duration_s, "Measure this long, s (default: 5)")
      ->check(CLI::Range(0.1, kMaxSeconds));
  hz->add_option("--count", request.count, "End when each topic has had this many messages");
  CLI::App* echo = add_action(app, request, "echo", "Messages of a topic, field by field");
  echo->add_option("topic", request.topics,
                   "Topic by ROS or DDS name; or a recording (MCAP, .db3, .bag) and topics in it (default: all)")
      ->required();
  echo->add_flag("--verbose", request.verbose, "All digits, times as sec and nanosec, and arrays of one value in full");
  echo->add_flag("--once", request.once, "End after one message");
  echo->add_option("--count", request.count, "End after this many messages");
  echo->add_option("--duration", request.duration_s,
                   "End after this time, s (default: at Ctrl-C); of a recording: its first S seconds")
      ->check(CLI::Range(0.0, kMaxSeconds));
  echo->add_option("--max-array", request.max_array, "Values shown per array, 0 = all")->capture_default_str();
  CLI::App* mirror = app.add_subcommand("mirror", "Passes topics rtd/... on as /rtd/..., for ROS 2");
  mirror->callback([&request] { request.action = "mirror"; });
  mirror->add_option("topics", request.topics, "Topics rtd/... (default: those of RTD-SLAM, of all robots)");
  service::add_bus_options(*mirror, request.bus);
}

/// Waits until no new writer has appeared for a while: participants announce themselves twice a second, and each then
/// announces its writers one by one. Without any writer it waits as long as allowed.
void discover(double longest_s, TopicsSession& session) {
  constexpr double kSettledS = 2;
  std::set<bus::WriterId> known;
  double last_new_s = 0;
  while (session.seconds() < longest_s && session.continues(50ms)) {
    for (const bus::TopicWriter& writer : session.writers())
      if (known.insert(writer.id).second) last_new_s = session.seconds();
    if (!known.empty() && session.seconds() - last_new_s > kSettledS) return;
  }
}

int list_topics(const TopicsRequest& request, TopicsSession& session, std::ostream& out, std::ostream& err) {
  discover(request.wait_s, session);
  const std::vector<TopicRow> rows = rows_of(session.writers());
  if (request.json || !rows.empty())
    out << (request.json ? service::json_text(list_json(rows)) + '\n' : list_text(rows));
  if (!rows.empty()) return service::kOk;
  err << fmt::format("rtd topics: no topic within {:.1f} s in {}\n", session.seconds(), session.empty_place());
  return service::kRunFailed;
}

int run_topics(const TopicsRequest& request, std::ostream& out, std::ostream& err) {
  return service::report_errors<service::ConfigError, bus::BusError, mcap::RecordingFileError>("rtd topics", err, [&] {
    if (request.action == "echo") {
      if (is_recording(request.topics.front())) return echo_recording(request, out, err);
      if (request.topics.size() > 1) throw service::ConfigError(kOneTopic + request.topics.front());
    }
    TopicsSession session(request.bus);
    if (request.action == "mirror") return mirror_topics(request, session, out);
    if (request.action == "list") return list_topics(request, session, out, err);
    if (request.action == "hz") return measure_topics(request, session, out, err);
    return echo_topic(request, session, out, err);
  });
}

}  // namespace rtd::topics
