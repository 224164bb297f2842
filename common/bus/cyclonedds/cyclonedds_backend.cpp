// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/cyclonedds_backend.hpp"

#include <utility>

#include "common/bus/cyclonedds/codec.hpp"
#include "common/bus/cyclonedds/cyclonedds_reader.hpp"
#include "common/bus/cyclonedds/qos_mapping.hpp"
#include "common/bus/cyclonedds/typed_writer.hpp"

namespace rtd::bus::cyclonedds {
namespace {

CycloneReader::Handlers typed_handlers(MessageId id, ErasedCallback on_message, StatusCallbacks callbacks) {
  CycloneReader::Handlers handlers;
  handlers.on_sample = [id, on_message = std::move(on_message)](const TakenSample& sample) {
    std::shared_ptr<const void> message = decode(id, sample.bytes);
    if (message == nullptr) return false;
    on_message(std::move(message));
    return true;
  };
  handlers.status = std::move(callbacks);
  return handlers;
}

class CycloneBackend : public BusBackend {
 public:
  explicit CycloneBackend(const BusOptions& options) : participant_(std::make_shared<Participant>(options)) {}

  const std::string& vendor() const override { return vendor_; }
  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    Qos qos = writer_qos(to_raw_qos(qos_settings(profile)));
    return std::make_unique<TypedWriter>(participant_, id, topic, std::move(qos), std::move(callbacks));
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    Qos qos = reader_qos(to_raw_qos(qos_settings(profile)));
    return std::make_unique<CycloneReader>(participant_, sample_type(id), topic, std::move(qos),
                                           typed_handlers(id, std::move(on_message), std::move(callbacks)));
  }

 private:
  const std::string vendor_ = "cyclonedds";
  std::shared_ptr<Participant> participant_;
};

}  // namespace

std::shared_ptr<BusBackend> create_backend(const BusOptions& options) {
  return std::make_shared<CycloneBackend>(options);
}

}  // namespace rtd::bus::cyclonedds
