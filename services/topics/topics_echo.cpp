// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <ostream>

#include "common/bus/topic_follower.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/ros2/message_json.hpp"
#include "common/ros2/names.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/json_text.hpp"
#include "services/topics/core/topic_report.hpp"
#include "services/topics/topics_session.hpp"

namespace rtd::topics {
namespace {

using namespace std::chrono_literals;
using Queue = concurrency::BoundedQueue<bus::RawSample>;

constexpr std::size_t kQueue = 256;
constexpr double kHintS = 3;  // then report a missing writer

/// Prints samples of one topic.
class Printer {
 public:
  Printer(const TopicsRequest& request, std::ostream& out, std::ostream& err)
      : request_(request), out_(out), err_(err) {}

  void print(const bus::RawTopic& topic, const bus::RawSample& sample) {
    try {
      const auto bytes = reinterpret_cast<const std::uint8_t*>(sample.cdr().data());
      const auto message = ros2::message_json(topic.type, {bytes, sample.cdr().size()}, request_.max_array);
      if (request_.json) {
        const nlohmann::ordered_json line{{"topic", ros2::ros_topic(topic.name)}, {"type", ros2::ros_type(topic.type)},
                                          {"sequence", sample.sequence},          {"sent_ns", sample.source_ns},
                                          {"received_ns", sample.received_ns},    {"message", message}};
        out_ << service::json_line(line) << std::endl;
      } else {
        out_ << message_text(message, request_.verbose ? Detail::kAll : Detail::kReadable) << std::flush;
      }
      ++printed_;
    } catch (const ros::WireError& error) {
      ++unreadable_;
      err_ << fmt::format("rtd topics: message {} of {} is not a {}: {}\n", sample.sequence,
                          ros2::ros_topic(topic.name), ros2::ros_type(topic.type), error.what());
    }
  }
  std::uint64_t printed() const { return printed_; }
  std::uint64_t unreadable() const { return unreadable_; }

 private:
  const TopicsRequest& request_;
  std::ostream &out_, &err_;
  std::uint64_t printed_ = 0, unreadable_ = 0;
};

std::optional<bus::TopicWriter> writer_called(const TopicsSession& session, const std::string& name) {
  for (const bus::TopicWriter& writer : session.writers()) {
    if (is_called(writer.topic, name)) return writer;
  }
  return std::nullopt;
}

bool in_time(const TopicsRequest& request, const TopicsSession& session) {
  return request.duration_s <= 0 || session.seconds() < request.duration_s;
}

/// The topic's first writer; empty when none appeared in time.
std::optional<bus::TopicWriter> wait_for_writer(const TopicsRequest& request, TopicsSession& session,
                                                std::ostream& err) {
  bool hinted = false;
  while (in_time(request, session) && session.continues(20ms)) {
    if (auto writer = writer_called(session, request.topics.front())) return writer;
    if (!hinted && session.seconds() > kHintS) {
      hinted = true;
      err << "rtd topics: " << session.no_publisher_of(request.topics.front()) << "; waiting\n";
    }
  }
  if (!hinted) err << "rtd topics: " << session.no_publisher_of(request.topics.front()) << '\n';
  return std::nullopt;
}

void print_until_end(const TopicsRequest& request, TopicsSession& session, const bus::RawTopic& topic, Queue& queue,
                     Printer& printer) {
  const std::uint64_t most = request.once ? 1 : request.count;
  while (in_time(request, session) && session.continues(0ms)) {
    if (most > 0 && printer.printed() >= most) return;
    if (const auto sample = queue.pop_for(50ms)) printer.print(topic, *sample);
  }
}

}  // namespace

int echo_topic(const TopicsRequest& request, TopicsSession& session, std::ostream& out, std::ostream& err) {
  const std::optional<bus::TopicWriter> first = wait_for_writer(request, session, err);
  if (!first) return service::kRunFailed;
  const bus::RawTopic topic = first->topic;
  if (!ros2::can_read(topic.type)) {
    err << fmt::format(
        "rtd topics: {} has the type {}, whose fields are not known here; `rtd topics hz` and `rtd record` accept any "
        "type\n",
        request.topics.front(), ros2::ros_type(topic.type));
    return service::kUsageOrConfig;
  }
  Queue queue(kQueue, concurrency::Overflow::kDropOldest);
  bus::RawHandlers handlers;
  handlers.on_sample = [&queue](bus::RawSample sample) { queue.push(std::move(sample)); };
  std::string refused;  // of the follower's thread until stop()
  bus::TopicFollower follower(session.bus(),
                              {.wants = [&](const bus::TopicWriter& writer) { return writer.topic == topic; },
                               .handlers = [&](const bus::RawTopic&) { return handlers; },
                               .on_refused = [&](const auto&, const bus::BusError& error) { refused = error.what(); },
                               .reader = {.transient_local = true, .depth = kReaderDepth, .in_place = true}});
  Printer printer(request, out, err);
  print_until_end(request, session, topic, queue, printer);
  follower.stop();
  if (queue.dropped() > 0) {
    err << fmt::format("rtd topics: {} messages left out because they arrived faster than they could be printed\n",
                       queue.dropped());
  }
  if (!refused.empty()) err << "rtd topics: " << refused << '\n';
  if (printer.unreadable() > 0) return service::kPartialLoss;
  if (printer.printed() > 0) return service::kOk;
  err << fmt::format("rtd topics: {} has a publisher, but no message arrived within {:.1f} s\n", request.topics.front(),
                     session.seconds());
  return service::kRunFailed;
}

}  // namespace rtd::topics
