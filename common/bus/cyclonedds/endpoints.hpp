// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "common/bus/cyclonedds/participant.hpp"
#include "common/bus/cyclonedds/samples.hpp"
#include "common/bus/message_types.hpp"
#include "common/bus/writer_id.hpp"

namespace rtd::bus::cyclonedds {

/// What the readers of this process take from each writer at most. Thread-safe.
class SampleLimits {
 public:
  /// Cyclone has one largest sample for a domain. When a datagram arrives for it, the first fragment of a sample that
  /// is too large for its own topic is made to say that the sample is larger than that: Cyclone then gives it up, as if
  /// the writer had said that it is gone. Its other fragments become padding. Not with AddressSanitizer or
  /// ThreadSanitizer, and not what is encrypted: that is refused when it is complete.
  static SampleLimits& of_process();

  /// A reader that takes so many bytes is matched with these writers, and no others.
  void note(const void* reader, const std::set<WriterId>& writers, std::size_t largest);
  /// The most that a reader takes; nothing: none is matched with that writer.
  std::optional<std::size_t> of(const WriterId& writer) const;
  /// Changes a datagram that has arrived.
  void mark_too_large(std::span<std::byte> datagram) const;

 private:
  mutable std::mutex mutex_;
  std::map<WriterId, std::map<const void*, std::size_t>> largest_;  ///< by reader
};

/// One reader with its own thread: Cyclone's threads only wake it, so a slow callback holds up neither discovery
/// nor other readers; what it cannot take in time, the keep-last history drops.
class CycloneReader : public ReaderBackend {
 public:
  struct Handlers {
    std::function<bool(const TakenSample&)> on_sample;  ///< false: absurd content, to be counted as lost
    std::function<void(const RawLoss&)> on_gap;         ///< before the sample that revealed it
    StatusCallbacks status;
  };

  CycloneReader(std::shared_ptr<Participant> participant, const SampleType& type, const std::string& topic, Qos qos,
                Handlers handlers);
  ~CycloneReader() override;
  int matched() const override { return status_.matched(); }

 private:
  bool handle_one();
  void report_lost();
  void note_matched(int writers);
  void note_writers();

  std::shared_ptr<Participant> participant_;
  const std::size_t largest_;  ///< sample
  const std::function<bool(const TakenSample&)> on_sample_;
  const std::function<void(const RawLoss&)> on_gap_;
  SequenceGaps gaps_;                         // used by the callback thread
  std::uint64_t missing_ = 0, unusable_ = 0;  // as well
  std::set<WriterId> writers_;                // as well
  std::atomic<dds_entity_t> reader_{0};
  StatusReporter status_;
  std::optional<TopicTypes::Watch> types_;
  std::optional<NodeEndpoints::Entry> entry_;
  CallbackThread thread_;
};

/// One writer of samples as bytes.
class CycloneWriter {
 public:
  CycloneWriter(std::shared_ptr<Participant> participant, const SampleType& type, const std::string& topic, Qos qos,
                StatusCallbacks callbacks);
  ~CycloneWriter();
  CycloneWriter(const CycloneWriter&) = delete;
  CycloneWriter& operator=(const CycloneWriter&) = delete;

  dds_entity_t handle() const { return writer_; }
  const ddsi_sertype* type() const { return topic_.type; }
  /// The bytes must not change afterwards. `source_ns` 0: now. Thread-safe.
  bool write(std::shared_ptr<ByteBlock> bytes, std::int64_t source_ns = 0);
  int matched() const { return status_.matched(); }
  void report_too_large() { status_.report_too_large(); }
  bool wait_acknowledged(int timeout_ms);

 private:
  std::shared_ptr<Participant> participant_;
  VendorTopic topic_;
  StatusReporter status_;
  std::mutex mutex_;
  SampleOrigin last_;  ///< as Cyclone counts, for readers in this process
  dds_entity_t writer_ = 0;
  std::optional<TopicTypes::Watch> types_;
  std::optional<NodeEndpoints::Entry> entry_;
};

/// Writes messages of common/msg. A loan is the sample's own memory: write_loaned() copies nothing.
class TypedWriter : public WriterBackend {
 public:
  TypedWriter(std::shared_ptr<Participant> participant, MessageId id, const std::string& topic, Qos qos,
              StatusCallbacks callbacks);

  bool write(const void* message) override;
  void* loan() override;
  bool write_loaned(void* slot) override;
  void discard_loan(void* slot) override { loans_.erase(slot); }
  int matched() const override { return writer_.matched(); }
  bool wait_acknowledged(int timeout_ms) override { return writer_.wait_acknowledged(timeout_ms); }
  WriterId id() const override { return guid_of(writer_.handle()); }

 private:
  const MessageId id_;
  const std::size_t largest_;  ///< sample
  CycloneWriter writer_;
  std::map<void*, std::shared_ptr<ByteBlock>> loans_;
};

}  // namespace rtd::bus::cyclonedds
