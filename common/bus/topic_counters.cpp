// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/topic_counters.hpp"

#include <algorithm>
#include <utility>

namespace rtd::bus {
namespace {

/// An endpoint reports its total; a topic has several endpoints. Called by one endpoint's thread.
class Increase {
 public:
  std::uint64_t of(int total) {
    const int more = std::max(0, total - last_);
    last_ = std::max(last_, total);
    return static_cast<std::uint64_t>(more);
  }

 private:
  int last_ = 0;
};

}  // namespace

StatusCallbacks TopicCounters::count(const std::string& topic, StatusCallbacks callbacks) {
  const auto note = [book = book_, topic](const auto& change) {
    const std::lock_guard lock(book->mutex);
    change(book->troubles[topic]);
  };
  StatusCallbacks counted = callbacks;
  counted.on_samples_lost = [note, next = std::move(callbacks.on_samples_lost),
                             increase = Increase()](int total) mutable {
    note([more = increase.of(total)](TopicTrouble& trouble) { trouble.lost += more; });
    if (next) next(total);
  };
  counted.on_samples_rejected = [note, next = std::move(callbacks.on_samples_rejected),
                                 increase = Increase()](int total) mutable {
    note([more = increase.of(total)](TopicTrouble& trouble) { trouble.rejected += more; });
    if (next) next(total);
  };
  counted.on_incompatible_qos = [note, next = std::move(callbacks.on_incompatible_qos)](const std::string& policy) {
    note([&](TopicTrouble& trouble) {
      ++trouble.incompatible_qos;
      trouble.policy = policy;
    });
    if (next) next(policy);
  };
  counted.on_type_mismatch = [note, next = std::move(callbacks.on_type_mismatch)](const std::string& type) {
    note([&](TopicTrouble& trouble) {
      ++trouble.type_mismatch;
      trouble.other_type = type;
    });
    if (next) next(type);
  };
  return counted;
}

std::map<std::string, TopicTrouble> TopicCounters::troubles() const {
  const std::lock_guard lock(book_->mutex);
  return book_->troubles;
}

}  // namespace rtd::bus
