// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <ostream>

#include "common/bus/topic_follower.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/json_text.hpp"
#include "services/topics/core/topic_report.hpp"
#include "services/topics/topics_session.hpp"

namespace rtd::topics {
namespace {

using namespace std::chrono_literals;

constexpr double kUsualDurationS = 5;

/// Subscribes to topics as their writers appear and measures each.
class Meters {
 public:
  Meters(TopicsSession& session, const std::vector<std::string>& wanted)
      : session_(session),
        wanted_(wanted),
        follower_(session.bus(), {.wants = [this](const bus::TopicWriter& writer) { return wants(writer.topic); },
                                  .handlers = [this](const bus::RawTopic& topic) { return handlers(meters_[topic]); },
                                  .run = bus::TopicFollower::under(mutex_),
                                  .reader = {.transient_local = true, .depth = kReaderDepth, .in_place = true}}) {}

  void stop() { follower_.stop(); }
  /// Every topic that was found, and each topic named by the user, has had `count` messages.
  bool all_reached(std::uint64_t count) {
    const std::lock_guard lock(mutex_);
    const bool complete = std::ranges::all_of(wanted_, [this](const std::string& name) {
      return std::ranges::any_of(meters_, [&](const auto& one) { return is_called(one.first, name); });
    });
    return complete && !meters_.empty() && std::ranges::all_of(meters_, [count](auto& one) {
             const std::lock_guard meter_lock(one.second.mutex);
             return one.second.rate.messages() >= count;
           });
  }
  std::vector<TopicRow> rows() {
    std::vector<bus::TopicWriter> writers = session_.writers();
    std::erase_if(writers, [this](const bus::TopicWriter& writer) { return !wants(writer.topic); });
    std::vector<TopicRow> rows = rows_of(writers);
    const std::lock_guard lock(mutex_);
    for (TopicRow& row : rows) {
      const auto meter = meters_.find(row.topic);
      if (meter != meters_.end()) row.rate = meter->second.rate.rate();
    }
    return rows;
  }

 private:
  struct ByName {
    bool operator()(const bus::RawTopic& a, const bus::RawTopic& b) const {
      return std::tie(a.name, a.type) < std::tie(b.name, b.type);
    }
  };
  struct Meter {
    std::mutex mutex;
    RateMeter rate;
  };

  bool wants(const bus::RawTopic& topic) const {
    return wanted_.empty() ||
           std::ranges::any_of(wanted_, [&](const std::string& name) { return is_called(topic, name); });
  }
  static bus::RawHandlers handlers(Meter& meter) {
    bus::RawHandlers handlers;
    handlers.on_sample = [&meter](const bus::RawSample& sample) {
      const std::lock_guard meter_lock(meter.mutex);
      meter.rate.add(sample.received_ns, sample.cdr().size());
    };
    handlers.on_lost = [&meter](const bus::RawLoss& loss) {
      const std::lock_guard meter_lock(meter.mutex);
      meter.rate.add_lost(loss.count);
    };
    return handlers;
  }

  TopicsSession& session_;
  const std::vector<std::string>& wanted_;
  std::mutex mutex_;
  std::map<bus::RawTopic, Meter, ByName> meters_;
  bus::TopicFollower follower_;  ///< the row of a second type on one name stays empty
};

}  // namespace

int measure_topics(const TopicsRequest& request, TopicsSession& session, std::ostream& out, std::ostream& err) {
  const double duration_s = request.duration_s > 0 ? request.duration_s : kUsualDurationS;
  err << fmt::format("measuring for {:g} s, Ctrl-C ends earlier\n", duration_s);
  Meters meters(session, request.topics);
  while (session.seconds() < duration_s && session.continues(50ms)) {
    if (request.count > 0 && meters.all_reached(request.count)) break;
  }
  const double seconds = session.seconds();
  std::vector<TopicRow> rows = meters.rows();
  meters.stop();
  if (request.json || !rows.empty())
    out << (request.json ? service::json_text(rate_json(rows, seconds)) + '\n' : rate_text(rows, seconds));
  int code = rows.empty() ? service::kRunFailed : service::kOk;
  if (rows.empty() && request.topics.empty()) {
    err << fmt::format("rtd topics: no topic within {:.1f} s in {}\n", seconds, session.empty_place());
  }
  for (const std::string& name : request.topics) {
    if (std::ranges::any_of(rows, [&](const auto& row) { return is_called(row.topic, name); })) continue;
    err << "rtd topics: " << session.no_publisher_of(name) << '\n';
    code = service::kRunFailed;
  }
  return code;
}

}  // namespace rtd::topics
