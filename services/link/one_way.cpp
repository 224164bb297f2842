// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/link/one_way.hpp"

#include <algorithm>
#include <utility>

#include "common/bus/backend.hpp"
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
    : from_(from), to_(to), rules_(rules), direction_(direction) {
  from_.watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { on_writer(writer, change); });
}

OneWay::~OneWay() {
  from_.watch(nullptr);
  const std::lock_guard lock(mutex_);
  for (auto& [topic, route] : routes_) route->listener.reset();  // before what its callbacks use
}

void OneWay::on_writer(const bus::TopicWriter& writer, bus::WriterChange change) {
  if (writer.own || !rules_.allows(direction_, writer.topic.name)) return;
  const std::lock_guard lock(mutex_);
  if (change == bus::WriterChange::kGone) return remove(writer);
  try {
    add(writer);
  } catch (const bus::BusError& error) {
    if (refused_.insert(writer.topic.name).second) {
      SPDLOG_WARN("event=topic_not_passed topic={} direction={} cause=\"{}\"", writer.topic.name, to_string(direction_),
                  error.what());
    }
  }
}

/// Under the lock.
void OneWay::add(const bus::TopicWriter& source) {
  std::unique_ptr<Route>& route = routes_[source.topic.name];
  if (!route) {
    route = std::make_unique<Route>();
    route->topic = source.topic.name;
  }
  route->sources[source.id] = source;
  if (!route->writer) {
    route->writer = to_.writer(source.topic, {.qos = qos_of(source)});
    SPDLOG_INFO("event=topic_found topic={} direction={} type={}", source.topic.name, to_string(direction_),
                source.topic.type);
  }
  if (route->listener) {
    route->listener->add(source);
  } else if (always_read(*route)) {
    open(*route);
  }
}

/// Under the lock. The other side sees that the last writer has gone. Counters stay.
void OneWay::remove(const bus::TopicWriter& source) {
  const auto found = routes_.find(source.topic.name);
  if (found == routes_.end() || found->second->sources.erase(source.id) == 0 || !found->second->sources.empty()) return;
  found->second->listener.reset();
  found->second->writer.reset();
  SPDLOG_INFO("event=topic_gone topic={} direction={}", source.topic.name, to_string(direction_));
}

bool OneWay::always_read(const Route& route) const {
  if (rules_.is_heartbeat(route.topic)) return true;
  return std::ranges::any_of(route.sources, [](const auto& source) {
    return source.second.qos.durability != bus::RawQos::Durability::kVolatile;
  });
}

/// Under the lock.
void OneWay::open(Route& route) {
  route.listener = std::make_unique<bus::TopicListener>(from_, handlers(route), false, kReadDepth);
  for (const auto& [id, source] : route.sources) route.listener->add(source);
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
    const bool wanted = route->writer->matched() > 0;
    if (wanted == (route->listener != nullptr)) continue;
    if (wanted) {
      open(*route);
    } else {
      route->listener.reset();
    }
  }
}

std::vector<Passed> OneWay::passed() const {
  const std::lock_guard lock(mutex_);
  std::vector<Passed> passed;
  for (const auto& [topic, route] : routes_) {
    passed.push_back({topic, route->messages, route->bytes, route->lost, route->listener != nullptr});
  }
  return passed;
}

}  // namespace rtd::link
