// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/fastdds_bus.hpp"

#include <utility>

#include "common/bus/fastdds/endpoints.hpp"
#include "common/bus/fastdds/raw_codec.hpp"
#include "common/bus/host/host_checks.hpp"

namespace rtd::bus::fastdds {
namespace {

class FastddsBackend : public BusBackend {
 public:
  FastddsBackend(std::shared_ptr<Participant> participant, bool shared_memory)
      : participant_(std::move(participant)), shared_memory_(shared_memory) {}

  const std::string& vendor() const override { return vendor_; }
  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    auto codec = create_codec(id);
    const auto qos = writer_qos(settings(profile), codec->plain());
    return std::make_unique<FastddsWriter>(participant_, std::move(codec), topic, qos, std::move(callbacks));
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    auto codec = create_codec(id);
    const auto qos = reader_qos(settings(profile), codec->plain());
    return std::make_unique<FastddsReader>(participant_, std::move(codec), topic, qos, std::move(on_message),
                                           std::move(callbacks));
  }

 private:
  QosSettings settings(QosProfile profile) const {
    QosSettings settings = qos_settings(profile);
    settings.data_sharing = settings.data_sharing && shared_memory_;
    return settings;
  }

  const std::string vendor_ = "fastdds";
  std::shared_ptr<Participant> participant_;
  const bool shared_memory_;
};

class FastddsRawReader : public RawReader {
 public:
  FastddsRawReader(std::shared_ptr<Participant> participant, const RawTopic& topic, const RawReaderOptions& options,
                   RawHandlers handlers)
      : handlers_(std::move(handlers)),
        reader_(
            std::move(participant), create_raw_codec(topic, options), topic.name, raw_reader_qos(options),
            [this](std::shared_ptr<const void> message) {
              receive(*std::static_pointer_cast<const RawSample>(std::move(message)));
            },
            handlers_.status) {}
  int matched() const override { return reader_.matched(); }

 private:
  void receive(const RawSample& sample) {
    const auto loss = gaps_.next(sample.writer, sample.sequence);
    if (loss && handlers_.on_lost) handlers_.on_lost(*loss);
    if (sample.bytes && handlers_.on_sample) handlers_.on_sample(sample);
  }

  const RawHandlers handlers_;
  SequenceGaps gaps_;
  FastddsReader reader_;  // last: its thread uses the others
};

class FastddsRawWriter : public RawWriter {
 public:
  FastddsRawWriter(std::shared_ptr<Participant> participant, const RawTopic& topic, const RawWriterOptions& options,
                   StatusCallbacks callbacks)
      : writer_(std::move(participant), create_raw_codec(topic, options), topic.name, raw_writer_qos(options),
                std::move(callbacks)) {}
  bool write(std::span<const std::byte> cdr, std::int64_t source_ns) override {
    const RawOutput output{cdr, source_ns};
    return writer_.write(&output);
  }
  int matched() const override { return writer_.matched(); }
  bool wait_acknowledged(int timeout_ms) override { return writer_.wait_acknowledged(timeout_ms); }

 private:
  FastddsWriter writer_;
};

class FastddsRawBus : public RawBus {
 public:
  FastddsRawBus(const BusOptions& options, const HostLimits& limits)
      : participant_(std::make_shared<Participant>(options, limits, &registry_)) {}
  ~FastddsRawBus() override {
    registry_.watch(nullptr);
    participant_->silence();
  }

  const std::string& vendor() const override { return vendor_; }
  std::vector<TopicWriter> writers() const override { return registry_.writers(); }
  void watch(Watcher watcher) override { registry_.watch(std::move(watcher)); }
  std::unique_ptr<RawReader> reader(const RawTopic& topic, const RawReaderOptions& options,
                                    RawHandlers handlers) override {
    return std::make_unique<FastddsRawReader>(participant_, topic, options, std::move(handlers));
  }
  std::unique_ptr<RawWriter> writer(const RawTopic& topic, const RawWriterOptions& options,
                                    StatusCallbacks callbacks) override {
    return std::make_unique<FastddsRawWriter>(participant_, topic, options, std::move(callbacks));
  }

 private:
  const std::string vendor_ = "fastdds";
  WriterRegistry registry_;
  std::shared_ptr<Participant> participant_;
};

/// The limits of this host, which must have enough shared memory.
HostLimits sufficient_limits(const BusOptions& options) {
  const HostLimits limits = read_host_limits();
  require_shared_memory(options, limits);
  return limits;
}

}  // namespace

std::shared_ptr<BusBackend> create_backend(const BusOptions& options) {
  return std::make_shared<FastddsBackend>(std::make_shared<Participant>(options, sufficient_limits(options)),
                                          options.shared_memory);
}

std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options) {
  return std::make_shared<FastddsRawBus>(options, sufficient_limits(options));
}

}  // namespace rtd::bus::fastdds
