// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/link/one_way.hpp"

#include <algorithm>

#include "common/service/log.hpp"

namespace rtd::link {
namespace {

constexpr int kReadDepth = 16;
constexpr int kLatchedDepth = 1, kUsualDepth = 10;  // DDS does not announce the depth of a writer

/// As the writer offers it, but without what this process cannot promise for another.
bus::RawQos qos_of(const bus::TopicWriter& source) {
  bus::RawQos qos = source.qos;
  const bool latched = qos.durability != bus::RawQos::Durability::kVolatile;
  if (latched) qos.durability = bus::RawQos::Durability::kTransientLocal;
  if (qos.depth <= 0) qos.depth = latched ? kLatchedDepth : kUsualDepth;
  if (qos.liveliness != bus::RawQos::Liveliness::kAutomatic) qos.liveliness_lease_ns = bus::kUnlimitedNs;
  qos.liveliness = bus::RawQos::Liveliness::kAutomatic;
  return qos;
}

const char* to_string(Direction direction) {
  return direction == Direction::kToFleet ? "to_fleet" : "to_robot";
}

}  // namespace

OneWay::OneWay(bus::RawBus& from, bus::RawBus& to, const LinkRules& rules, Direction direction)
    : from_(from),
      to_(to),
      rules_(rules),
      direction_(direction),
      follower_(from,
                {.wants = [this](const auto& writer) { return rules_.allows(direction_, writer.topic.name); },
                 .handlers = [this](const bus::RawTopic& topic) { return handlers(*routes_.at(topic.name)); },
                 .on_writer = [this](const bus::TopicWriter& writer) { add(writer); },
                 .on_gone = [this](const bus::RawTopic& topic) { remove(topic.name); },
                 .on_refused = [this](const auto& writer, const auto& error) { refuse(writer.topic.name, error); },
                 .run = bus::TopicFollower::under(mutex_),
                 .on_demand = true,
                 .reader = {.transient_local = true, .depth = kReadDepth}}) {}

/// Under the lock.
void OneWay::add(const bus::TopicWriter& source) {
  std::unique_ptr<Route>& route = routes_[source.topic.name];
  if (!route) {
    route = std::make_unique<Route>();
    route->topic = source.topic.name;
  }
  if (!route->writer) {
    route->writer = to_.writer(source.topic, {.qos = qos_of(source)});
    SPDLOG_INFO("event=topic_found topic={} direction={} type={}", source.topic.name, to_string(direction_),
                source.topic.type);
  }
  if (always_read(*route)) follower_.read(route->topic, true);
}

/// Under the lock. The other side sees that the last writer has gone. Counters stay.
void OneWay::remove(const std::string& topic) {
  follower_.read(topic, false);
  routes_.at(topic)->writer.reset();
  SPDLOG_INFO("event=topic_gone topic={} direction={}", topic, to_string(direction_));
}

/// Under the lock.
void OneWay::refuse(const std::string& topic, const bus::BusError& error) {
  if (!refused_.insert(topic).second) return;
  SPDLOG_WARN("event=topic_not_passed topic={} direction={} cause=\"{}\"", topic, to_string(direction_), error.what());
}

bool OneWay::always_read(const Route& route) const {
  if (rules_.is_heartbeat(route.topic)) return true;
  return std::ranges::any_of(follower_.writers(route.topic), [](const auto& source) {
    return source.second.qos.durability != bus::RawQos::Durability::kVolatile;
  });
}

bus::RawHandlers OneWay::handlers(Route& route) {
  bus::RawHandlers handlers;
  handlers.on_sample = [this, &route](const bus::RawSample& sample) { pass(route, sample); };
  handlers.on_lost = [&route](const bus::RawLoss& loss) { route.lost += loss.count; };
  return handlers;
}

/// On the thread of the route's reader.
void OneWay::pass(Route& route, const bus::RawSample& sample) {
  if (!written_by_others(route, sample.writer) || !rules_.passes(direction_, route.topic, sample.cdr())) return;
  if (!route.writer->write(sample.cdr(), sample.source_ns)) {
    ++route.lost;
    return;
  }
  ++route.messages;
  route.bytes += sample.cdr().size();
}

/// A writer is known before its first sample; what is not known is not passed, or a topic that goes both ways would
/// come back for ever.
bool OneWay::written_by_others(Route& route, const bus::WriterId& writer) const {
  if (const auto known = route.by_others.find(writer); known != route.by_others.end()) return known->second;
  const std::vector<bus::TopicWriter> writers = from_.writers();
  const auto found = std::ranges::find(writers, writer, &bus::TopicWriter::id);
  if (found == writers.end()) return false;
  return route.by_others[writer] = !found->own;
}

void OneWay::tick() {
  const std::lock_guard lock(mutex_);
  for (auto& [topic, route] : routes_) {
    if (!route->writer || always_read(*route)) continue;
    follower_.read(topic, route->writer->matched() > 0);
  }
}

std::vector<Passed> OneWay::passed() const {
  const std::lock_guard lock(mutex_);
  std::vector<Passed> passed;
  for (const auto& [topic, route] : routes_) {
    passed.push_back({topic, route->messages, route->bytes, route->lost, follower_.reads(topic)});
  }
  return passed;
}

}  // namespace rtd::link
