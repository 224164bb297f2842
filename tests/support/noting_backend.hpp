// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/bus/backend.hpp"

namespace rtd::test_support {

/// Another bus, which notes on which topics messages are written, in their order.
class NotingBackend final : public bus::BusBackend {
 public:
  explicit NotingBackend(std::shared_ptr<bus::BusBackend> backend)
      : BusBackend(backend->vendor()), backend_(std::move(backend)) {}

  /// DDS names, one for each message on one of `topics`.
  std::vector<std::string> written(const std::vector<std::string>& topics) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> chosen;
    for (const std::string& topic : written_)
      if (std::ranges::count(topics, topic) > 0) chosen.push_back(topic);
    return chosen;
  }

  std::unique_ptr<bus::WriterBackend> create_writer(bus::MessageId id, const std::string& topic,
                                                    bus::QosProfile profile, bus::StatusCallbacks callbacks) override {
    return std::make_unique<NotingWriter>(*this, topic,
                                          backend_->create_writer(id, topic, profile, std::move(callbacks)));
  }
  std::unique_ptr<bus::ReaderBackend> create_reader(bus::MessageId id, const std::string& topic,
                                                    bus::QosProfile profile, bus::ErasedCallback on_message,
                                                    bus::StatusCallbacks callbacks) override {
    return backend_->create_reader(id, topic, profile, std::move(on_message), std::move(callbacks));
  }
  std::unique_ptr<bus::CallEndpoint> create_calls(const bus::CallTopics& topics, bus::CallRole role,
                                                  bus::OnCall on_call) override {
    return backend_->create_calls(topics, role, std::move(on_call));
  }

 private:
  class NotingWriter final : public bus::WriterBackend {
   public:
    NotingWriter(NotingBackend& bus, std::string topic, std::unique_ptr<bus::WriterBackend> writer)
        : bus_(bus), topic_(std::move(topic)), writer_(std::move(writer)) {}
    bool write(const void* message) override {
      bus_.note(topic_);
      return writer_->write(message);
    }
    void* loan() override { return writer_->loan(); }
    bool write_loaned(void* slot) override {
      bus_.note(topic_);
      return writer_->write_loaned(slot);
    }
    void discard_loan(void* slot) override { writer_->discard_loan(slot); }
    int matched() const override { return writer_->matched(); }
    bool wait_acknowledged(int timeout_ms) override { return writer_->wait_acknowledged(timeout_ms); }
    bus::WriterId id() const override { return writer_->id(); }

   private:
    NotingBackend& bus_;
    const std::string topic_;
    const std::unique_ptr<bus::WriterBackend> writer_;
  };

  void note(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    written_.push_back(topic);
  }

  const std::shared_ptr<bus::BusBackend> backend_;
  mutable std::mutex mutex_;
  std::vector<std::string> written_;
};

}  // namespace rtd::test_support
