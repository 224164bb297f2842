// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <memory>

#include "common/bus/fastdds/versions/vendor.hpp"
#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

/// What one attempt to take a sample brought.
struct TakenSample {
  enum class Kind { kNothing, kMessage, kNoData, kUnusable };
  Kind kind = Kind::kNothing;           ///< kNoData: a dispose or the like; kUnusable: absurd content
  std::shared_ptr<const void> message;  ///< plain struct of common/msg, for kMessage
  WriterId writer{};                    ///< for kMessage; all zero where the message itself names it
};

/// The way of one message type between its plain struct and Fast DDS. One instance per endpoint.
class Codec {
 public:
  virtual ~Codec() = default;
  virtual bool plain() const = 0;
  /// Bytes, CDR header included. A reader refuses larger ones.
  virtual std::size_t largest_sample() const = 0;
  virtual dds::TypeSupport create_type() const = 0;
  /// Of a message that one of our writers makes; 0: it passes on what others made.
  virtual std::size_t sample_size(const void* /*message*/) const { return 0; }
  /// Thread-safe.
  virtual bool write(dds::DataWriter& writer, const void* message) const = 0;
  /// The next sample of a writer that `accepts` wants, if it is given; one of another writer gives kNoData and is not
  /// copied when it is large. For one thread.
  using Accepts = std::function<bool(const WriterId& writer)>;
  virtual TakenSample take(dds::DataReader& reader, const Accepts& accepts) = 0;
  /// Whether a sample in the vendor's memory, 4 bytes behind a multiple of 8, may be used as the message itself.
  virtual bool in_place() const { return false; }
  /// An uninitialised message to fill in. Plain types only. Thread-safe.
  virtual std::shared_ptr<void> allocate() const = 0;
};

std::unique_ptr<Codec> create_codec(MessageId id);

/// What a raw writer's codec takes as its message.
struct RawOutput {
  std::span<const std::byte> cdr;
  std::int64_t source_ns = 0;  ///< 0: now
};

/// A codec without a type: write() takes a RawOutput, take() gives a RawSample.
std::unique_ptr<Codec> create_raw_codec(const RawTopic& topic, const RawReaderOptions& options);
std::unique_ptr<Codec> create_raw_codec(const RawTopic& topic, const RawWriterOptions& options);

}  // namespace rtd::bus::fastdds
