// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/offered_qos.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>

namespace rtd::bus {
namespace {

using Durability = RawQos::Durability;
using Liveliness = RawQos::Liveliness;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kForeverSeconds = 2'147'483'647;  // some middlewares count seconds in 31 bits

// The numbers of rmw/types.h.
constexpr int kKeepLast = 1, kUnknownHistory = 3;
constexpr int kReliable = 1, kBestEffort = 2;
constexpr int kTransientLocal = 1, kVolatile = 2;
constexpr int kAutomatic = 1, kManualByTopic = 3;

std::string time_text(const char* name, std::int64_t ns) {
  return fmt::format("  {}:\n    sec: {}\n    nsec: {}\n", name, ns / kSecond, ns % kSecond);
}

std::string text_of(const RawQos& qos) {
  return fmt::format("- history: {}\n  depth: {}\n  reliability: {}\n  durability: {}\n",
                     qos.depth > 0 ? kKeepLast : kUnknownHistory, qos.depth, qos.reliable ? kReliable : kBestEffort,
                     qos.durability == Durability::kVolatile ? kVolatile : kTransientLocal) +
         time_text("deadline", qos.deadline_ns) + time_text("lifespan", qos.lifespan_ns) +
         fmt::format("  liveliness: {}\n", qos.liveliness == Liveliness::kManualByTopic ? kManualByTopic : kAutomatic) +
         time_text("liveliness_lease_duration", qos.liveliness_lease_ns) + "  avoid_ros_namespace_conventions: false\n";
}

/// Whether a policy, as a number or a word, is this one.
bool is(const YAML::Node& policy, int number, const char* word) {
  if (!policy.IsDefined() || !policy.IsScalar()) return false;
  return policy.Scalar() == word || policy.Scalar() == std::to_string(number);
}

/// Zero means "not set" in ROS 2.
std::int64_t time_of(const YAML::Node& node) {
  if (!node.IsDefined() || !node.IsMap()) return kUnlimitedNs;
  const auto seconds = node["sec"].as<std::int64_t>(0);
  const auto nanoseconds = node["nsec"].as<std::int64_t>(0);
  const bool set = seconds >= 0 && seconds < kForeverSeconds && nanoseconds >= 0 && seconds + nanoseconds > 0;
  return set ? seconds * kSecond + nanoseconds : kUnlimitedNs;
}

RawQos qos_of(const YAML::Node& node) {
  RawQos qos;
  qos.reliable = !is(node["reliability"], kBestEffort, "best_effort");
  if (is(node["durability"], kTransientLocal, "transient_local")) qos.durability = Durability::kTransientLocal;
  if (is(node["history"], kKeepLast, "keep_last")) qos.depth = std::max(0, node["depth"].as<int>(0));
  qos.deadline_ns = time_of(node["deadline"]);
  qos.lifespan_ns = time_of(node["lifespan"]);
  if (is(node["liveliness"], kManualByTopic, "manual_by_topic")) qos.liveliness = Liveliness::kManualByTopic;
  qos.liveliness_lease_ns = time_of(node["liveliness_lease_duration"]);
  return qos;
}

}  // namespace

std::string offered_qos_text(const std::vector<RawQos>& offered) {
  std::string text;
  for (const RawQos& qos : offered) text += text_of(qos);
  return text;
}

std::vector<RawQos> parse_offered_qos(const std::string& text) {
  std::vector<RawQos> offered;
  try {
    for (const YAML::Node& node : YAML::Load(text)) {
      if (node.IsMap()) offered.push_back(qos_of(node));
    }
  } catch (const YAML::Exception&) {
    offered.clear();
  }
  return offered;
}

}  // namespace rtd::bus
