// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/raw_bus.hpp"

#include <algorithm>

#include "common/bus/robot.hpp"
#include "common/bus/topic_roles.hpp"
#include "common/msg/imu.hpp"
#include "common/msg/largest_sample.hpp"

namespace rtd::bus {
namespace {

class CountedRawWriter : public RawWriter {
 public:
  CountedRawWriter(std::unique_ptr<RawWriter> writer, Traffic::Sent sent)
      : writer_(std::move(writer)), sent_(std::move(sent)) {}
  bool write(std::span<const std::byte> cdr, std::int64_t source_ns) override {
    const bool written = writer_->write(cdr, source_ns);
    if (written) ++*sent_;
    return written;
  }
  int matched() const override { return writer_->matched(); }
  bool wait_acknowledged(int timeout_ms) override { return writer_->wait_acknowledged(timeout_ms); }

 private:
  const std::unique_ptr<RawWriter> writer_;
  const Traffic::Sent sent_;
};

RawHandlers counted(RawHandlers handlers, const std::shared_ptr<Input>& input) {
  StatusCallbacks counting = input->counting(std::move(handlers.status));
  handlers.on_sample = [receive = std::exchange(counting.accepts, nullptr),
                        next = std::move(handlers.on_sample)](RawSample sample) {
    receive(sample.writer);
    if (next) next(std::move(sample));
  };
  handlers.status = std::move(counting);
  return handlers;
}

}  // namespace

std::unique_ptr<RawReader> RawBus::reader(const RawTopic& topic, const RawReaderOptions& options,
                                          RawHandlers handlers) {
  if (traffic_) handlers = counted(std::move(handlers), traffic_->input(topic.name, false));
  return make_reader(topic, options, std::move(handlers));
}

std::unique_ptr<RawWriter> RawBus::writer(const RawTopic& topic, const RawWriterOptions& options,
                                          StatusCallbacks callbacks) {
  auto writer = make_writer(topic, options, std::move(callbacks));
  if (!traffic_) return writer;
  return std::make_unique<CountedRawWriter>(std::move(writer), traffic_->output(topic.name));
}

std::optional<RawLoss> SequenceGaps::next(const WriterId& writer, std::int64_t sequence) {
  const auto [known, is_first] = newest_.try_emplace(writer, sequence);
  const std::int64_t expected = is_first ? sequence : known->second + 1;
  known->second = std::max(known->second, sequence);
  if (sequence <= expected) return std::nullopt;
  return RawLoss{writer, expected, static_cast<std::uint64_t>(sequence - expected)};
}

namespace {

/// 0: a type that we do not know.
template <class... T>
std::size_t largest_of_type(const std::string& dds_type, TypeList<T...>) {
  if (dds_type == msg::kImuDdsType) return msg::largest_sample<msg::Imu>();
  std::size_t largest = 0;
  (void)((dds_type == dds_type_name(MessageTraits<T>::kId) && (largest = msg::largest_sample<T>()) > 0) || ...);
  return largest;
}

bool is_topic_of_ours(const std::string& wire_name) {
  const std::string name = split_robot(wire_name).topic;
  return std::ranges::any_of(topic_roles(), [&name](const TopicRoles& roles) { return roles.topic == name; });
}

}  // namespace

std::size_t largest_sample(const RawTopic& topic) {
  const std::size_t known = largest_of_type(topic.type, MessageTypes());
  const bool small = known > 0 && known <= msg::kLargestSmallSample;
  return small || (known > 0 && is_topic_of_ours(topic.name)) ? known : msg::kLargestOfOthers;
}

ErasedCallback raw_callback(RawHandlers handlers) {
  return [handlers = std::move(handlers), gaps = SequenceGaps()](const std::shared_ptr<const void>& message,
                                                                 const WriterId&) mutable {
    const auto& sample = *std::static_pointer_cast<const RawSample>(message);
    const auto loss = gaps.next(sample.writer, sample.sequence);
    if (loss && handlers.on_lost) handlers.on_lost(*loss);
    if (sample.bytes && handlers.on_sample) handlers.on_sample(sample);
  };
}

}  // namespace rtd::bus
