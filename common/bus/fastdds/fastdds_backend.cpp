// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/fastdds_backend.hpp"

#include <utility>

#include "common/bus/fastdds/fastdds_reader.hpp"
#include "common/bus/fastdds/fastdds_writer.hpp"
#include "common/bus/fastdds/participant.hpp"
#include "common/bus/fastdds/qos_mapping.hpp"
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

}  // namespace

std::shared_ptr<BusBackend> create_backend(const BusOptions& options) {
  const HostLimits limits = read_host_limits();
  require_shared_memory(options, limits);
  return std::make_shared<FastddsBackend>(std::make_shared<Participant>(options, limits), options.shared_memory);
}

}  // namespace rtd::bus::fastdds
