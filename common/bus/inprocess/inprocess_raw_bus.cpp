// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/inprocess/inprocess_raw_bus.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include "common/bus/inprocess/raw_domain.hpp"
#include "common/bus/sequence_gaps.hpp"

namespace rtd::bus::inprocess {
namespace {

std::int64_t realtime_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

class InprocessRawReader : public RawReader {
 public:
  InprocessRawReader(std::shared_ptr<RawDomain> domain, const RawTopic& topic, const RawReaderOptions& options,
                     RawHandlers handlers)
      : domain_(std::move(domain)),
        handlers_(std::move(handlers)),
        mailbox_(static_cast<std::size_t>(options.depth),
                 [this](const Message& message) { receive(*std::static_pointer_cast<const RawSample>(message)); }) {
    endpoint_.topic = topic;
    endpoint_.options = options;
    endpoint_.mailbox = &mailbox_;
    domain_->add(endpoint_);
  }
  ~InprocessRawReader() override { domain_->remove(endpoint_); }
  int matched() const override { return endpoint_.matched; }

 private:
  void receive(const RawSample& sample) {
    const auto loss = gaps_.next(sample.writer, sample.sequence);
    if (loss && handlers_.on_lost) handlers_.on_lost(*loss);
    if (handlers_.on_sample) handlers_.on_sample(sample);
  }

  std::shared_ptr<RawDomain> domain_;
  const RawHandlers handlers_;
  SequenceGaps gaps_;
  RawReaderEndpoint endpoint_;
  Mailbox mailbox_;  // last: its thread uses the others
};

class InprocessRawWriter : public RawWriter {
 public:
  InprocessRawWriter(std::shared_ptr<RawDomain> domain, const RawTopic& topic, const RawQos& qos)
      : domain_(std::move(domain)) {
    endpoint_.writer = {domain_->new_id(), topic, qos};
    if (qos.depth <= 0) endpoint_.writer.qos.depth = 10;
    domain_->add(endpoint_);
  }
  ~InprocessRawWriter() override { domain_->remove(endpoint_); }

  bool write(std::span<const std::byte> cdr, std::int64_t source_ns) override {
    auto block = std::make_shared<ByteBlock>();
    block->assign(cdr);
    const std::int64_t now_ns = realtime_ns();
    domain_->publish(endpoint_, {{}, 0, source_ns == 0 ? now_ns : source_ns, now_ns, std::move(block)});
    return true;
  }
  int matched() const override { return endpoint_.matched; }
  bool wait_acknowledged(int) override { return true; }  // a sample is with its readers when write() returns

 private:
  std::shared_ptr<RawDomain> domain_;
  RawWriterEndpoint endpoint_;
};

class InprocessRawBus : public RawBus {
 public:
  explicit InprocessRawBus(std::uint32_t domain) : domain_(RawDomain::join(domain)) {}
  ~InprocessRawBus() override { end_watch(); }

  const std::string& vendor() const override { return vendor_; }
  std::vector<TopicWriter> writers() const override { return domain_->writers(); }
  void watch(Watcher watcher) override {
    end_watch();
    if (!watcher) return;
    watcher_ = {std::move(watcher), &thread_.emplace()};
    domain_->add(watcher_);
  }
  std::unique_ptr<RawReader> reader(const RawTopic& topic, const RawReaderOptions& options,
                                    RawHandlers handlers) override {
    return std::make_unique<InprocessRawReader>(domain_, topic, options, std::move(handlers));
  }
  std::unique_ptr<RawWriter> writer(const RawTopic& topic, const RawWriterOptions& options, StatusCallbacks) override {
    return std::make_unique<InprocessRawWriter>(domain_, topic, options.qos);
  }

 private:
  void end_watch() {
    if (!thread_) return;
    domain_->remove(watcher_);
    thread_.reset();
  }

  const std::string vendor_ = "inprocess";
  std::shared_ptr<RawDomain> domain_;
  RawWatcher watcher_;
  std::optional<CallbackThread> thread_;
};

}  // namespace

std::shared_ptr<RawBus> create_raw_bus(std::uint32_t domain) {
  return std::make_shared<InprocessRawBus>(domain);
}

}  // namespace rtd::bus::inprocess
