// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/topic_types.hpp"

#include <utility>

namespace rtd::bus {

TopicTypes::Watch::Watch(TopicTypes& types, const std::string& topic, const std::string& type, OnMismatch on_mismatch)
    : types_(types), topic_(topic), type_(type), on_mismatch_(std::move(on_mismatch)) {
  const std::lock_guard lock(types_.mutex_);
  types_.watches_.push_back(this);
  for (const auto& [id, endpoint] : types_.endpoints_) {
    if (endpoint.topic == topic_) compare(endpoint.type);
  }
}

TopicTypes::Watch::~Watch() {
  const std::lock_guard lock(types_.mutex_);
  types_.watches_.remove(this);
}

void TopicTypes::Watch::compare(const std::string& foreign_type) const {
  if (foreign_type != type_) on_mismatch_(foreign_type);
}

void TopicTypes::appeared(const std::string& endpoint, const std::string& topic, const std::string& type) {
  const std::lock_guard lock(mutex_);
  if (!endpoints_.try_emplace(endpoint, Endpoint{topic, type}).second) return;  // its QoS changed
  for (const Watch* watch : watches_) {
    if (watch->topic_ == topic) watch->compare(type);
  }
}

void TopicTypes::gone(const std::string& endpoint) {
  const std::lock_guard lock(mutex_);
  endpoints_.erase(endpoint);
}

}  // namespace rtd::bus
