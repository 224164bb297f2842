// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus.hpp"

#include <algorithm>

#include "common/bus/message_screen.hpp"

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
  const auto totals = [&note](std::uint64_t TopicTrouble::*count, std::function<void(int)> next) {
    return [note, count, next = std::move(next), increase = Increase()](int total) mutable {
      note([count, more = increase.of(total)](TopicTrouble& trouble) { trouble.*count += more; });
      if (next) next(total);
    };
  };
  using Text = const std::string&;
  const auto events = [&note](std::uint64_t TopicTrouble::*count, std::string TopicTrouble::*last,
                              std::function<void(Text)> next) {
    return [note, count, last, next = std::move(next)](Text text) {
      note([&](TopicTrouble& trouble) {
        ++(trouble.*count);
        trouble.*last = text;
      });
      if (next) next(text);
    };
  };
  StatusCallbacks counted = callbacks;
  counted.on_samples_lost = totals(&TopicTrouble::lost, callbacks.on_samples_lost);
  counted.on_samples_rejected = totals(&TopicTrouble::rejected, callbacks.on_samples_rejected);
  counted.on_incompatible_qos =
      events(&TopicTrouble::incompatible_qos, &TopicTrouble::policy, callbacks.on_incompatible_qos);
  counted.on_type_mismatch =
      events(&TopicTrouble::type_mismatch, &TopicTrouble::other_type, callbacks.on_type_mismatch);
  counted.on_too_large = [note, next = std::move(callbacks.on_too_large)] {
    note([](TopicTrouble& trouble) { ++trouble.too_large; });
    if (next) next();
  };
  return counted;
}

ErasedCallback TopicCounters::screen(MessageId id, const std::string& topic, ErasedCallback on_message) {
  return [book = book_, screen = MessageScreen(id), topic, on_message = std::move(on_message)](
             std::shared_ptr<const void> message, const WriterId& writer) mutable {
    const msg::ImplausibleField bad = screen.implausible_field(message.get(), writer);
    if (!bad) return on_message(std::move(message), writer);
    const std::lock_guard lock(book->mutex);
    TopicTrouble& trouble = book->troubles[topic];
    ++trouble.implausible;
    trouble.implausible_field = to_string(bad);
  };
}

std::map<std::string, TopicTrouble> TopicCounters::troubles() const {
  const std::lock_guard lock(book_->mutex);
  return book_->troubles;
}

}  // namespace rtd::bus
