// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/writer_id.hpp"

/// Topics as bytes: recording, replaying and inspecting need no type. In addition to Bus, on its own connection.
namespace rtd::bus {

/// Bytes of a changing number in memory that is kept and not cleared. Made for samples as CDR: what follows the 4 bytes
/// of their header is aligned to 16, and the last bytes may be read in groups of 4.
class ByteBlock {
 public:
  static constexpr std::size_t kCdrHeaderBytes = 4;

  /// The bytes are undefined afterwards.
  void resize(std::size_t size) {
    if (size > capacity_) {
      memory_.reset();
      memory_ = std::make_unique_for_overwrite<std::byte[]>(kLead + size + kPadding);
      capacity_ = size;
    }
    size_ = size;
    if (memory_) std::memset(bytes().data() + size, 0, kPadding);
  }
  void assign(std::span<const std::byte> bytes_to_keep) {
    resize(bytes_to_keep.size());
    if (!bytes_to_keep.empty()) std::memcpy(bytes().data(), bytes_to_keep.data(), bytes_to_keep.size());
  }
  std::span<std::byte> bytes() { return memory_ ? std::span(memory_.get() + kLead, size_) : std::span<std::byte>(); }
  std::size_t capacity() const { return capacity_; }
  std::span<const std::byte> view() const { return const_cast<ByteBlock*>(this)->bytes(); }

 private:
  static constexpr std::size_t kLead = 16 - kCdrHeaderBytes, kPadding = 3;

  std::unique_ptr<std::byte[]> memory_;
  std::size_t size_ = 0, capacity_ = 0;
};

static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= 16, "ByteBlock aligns by what new gives");

inline constexpr std::int64_t kUnlimitedNs = std::numeric_limits<std::int64_t>::max();

/// What a writer offers, as discovery has it or as it is to be. The numbers of `Durability` and `Liveliness` grow with
/// what they offer.
struct RawQos {
  enum class Durability { kVolatile, kTransientLocal, kTransient, kPersistent };
  enum class Liveliness { kAutomatic, kManualByParticipant, kManualByTopic };
  bool reliable = true;
  Durability durability = Durability::kVolatile;
  int depth = 0;  ///< keep-last history; 0: not known, for DDS does not announce it (a writer then keeps 10)
  std::int64_t deadline_ns = kUnlimitedNs, lifespan_ns = kUnlimitedNs;
  Liveliness liveliness = Liveliness::kAutomatic;
  std::int64_t liveliness_lease_ns = kUnlimitedNs;
  bool operator==(const RawQos&) const = default;
};

/// A topic by its DDS names: "rt/slam/odometry", "nav_msgs::msg::dds_::Odometry_".
struct RawTopic {
  std::string name, type;
  bool keyed = false;  ///< all instances of a keyed topic count as one
  bool operator==(const RawTopic&) const = default;
};

/// The largest sample of a topic, its CDR header included: by the table of common/msg/largest_sample.hpp, and
/// msg::kLargestOfOthers for unknown types and for large ones on topics of other programs.
std::size_t largest_sample(const RawTopic& topic);

struct TopicWriter {
  WriterId id{};
  RawTopic topic;
  RawQos qos;
  bool own = false;            ///< belongs to this connection
  bool shared_memory = false;  ///< its samples, of a fixed size, can be read in its shared memory
  std::string
      user_data;  ///< what it announces besides; ROS 2: "typehash=RIHS01_...;" (common/ros2/type_description.hpp)
};

struct TopicReader {
  WriterId id{};
  RawTopic topic;
  bool own = false;       ///< belongs to this connection
  std::string user_data;  ///< as that of a TopicWriter
};

enum class WriterChange { kAppeared, kChanged, kGone };

/// One sample as it came: 4 bytes of CDR header (byte order), the fields, and what Fast DDS may fill up to four.
struct RawSample {
  WriterId writer{};
  std::int64_t sequence = 0;     ///< the writer counts its samples from 1
  std::int64_t source_ns = 0;    ///< CLOCK_REALTIME of the writer; the reception if unknown
  std::int64_t received_ns = 0;  ///< CLOCK_REALTIME here
  std::shared_ptr<const ByteBlock> bytes;
  std::span<const std::byte> cdr() const { return bytes->view(); }
};

/// Samples that a writer has sent and that will not come.
struct RawLoss {
  WriterId writer{};
  std::int64_t first_sequence = 0;
  std::uint64_t count = 0;
};

/// Run on a thread of the reader, one at a time: queue and return. A loss is reported before the sample that revealed
/// it.
struct RawHandlers {
  std::function<void(RawSample)> on_sample;
  std::function<void(const RawLoss&)> on_lost;
  StatusCallbacks status;  ///< on_samples_lost: what the transport counts, also before a next sample reveals it
};

/// For backends whose readers give RawSamples: hands them on, and before each the loss that its number reveals.
ErasedCallback raw_callback(RawHandlers handlers);

/// Finds the samples that a reader did not get by the numbers that their writers gave them. The count of a
/// writer begins with its first number that is received: what it sent to others before is not lost.
class SequenceGaps {
 public:
  /// The samples missing before this one.
  std::optional<RawLoss> next(const WriterId& writer, std::int64_t sequence);
  void forget(const WriterId& writer) { newest_.erase(writer); }

 private:
  std::map<WriterId, std::int64_t> newest_;
};

struct RawReaderOptions {
  bool reliable = true;          ///< asking for more than a writer offers is no match
  bool transient_local = false;  ///< also what was written before
  int depth = 64;                ///< samples that may wait for the thread; then the oldest go and count as lost
  /// Takes the samples of a TopicWriter::shared_memory from there instead of having them sent. Spares the writer a
  /// copy, but then the writer's own short history is all the time that there is.
  bool in_place = false;
  std::size_t largest_sample = 0;  ///< bytes; larger ones are refused. 0: as largest_sample() of the topic
  bool operator==(const RawReaderOptions&) const = default;
};

struct RawWriterOptions {
  RawQos qos;
  std::uint32_t fixed_bytes = 0;  ///< size of every sample with its CDR header: they stay in shared memory; 0: varies
};

using RawReader = ReaderBackend;

class RawWriter {
 public:
  virtual ~RawWriter() = default;
  /// Sends the bytes, CDR header included. `source_ns`: the time that readers get as the writer's; 0: now. Thread-safe.
  virtual bool write(std::span<const std::byte> cdr, std::int64_t source_ns = 0) = 0;
  virtual int matched() const = 0;
  /// As Writer::wait_acknowledged.
  virtual bool wait_acknowledged(int timeout_ms) = 0;
};

/// One connection of a process to the bytes of a domain. Readers and writers must not outlive it. Thread-safe.
class RawBus : public CallBackend {
 public:
  using Watcher = std::function<void(const TopicWriter&, WriterChange)>;

  explicit RawBus(std::string vendor) : vendor_(std::move(vendor)) {}
  const std::string& vendor() const { return vendor_; }
  /// Writers known now, without the one that announces this connection to ROS 2. A writer is known before its first
  /// sample is delivered.
  virtual std::vector<TopicWriter> writers() const = 0;
  /// Readers known now.
  virtual std::vector<TopicReader> readers() const = 0;
  /// Names of the connections known now, as BusOptions::participant_name; those that do not announce one are missing.
  virtual std::map<ParticipantId, std::string> participants() const = 0;
  /// Calls the watcher for each writer known now, then for each change. One watcher, on a thread of the bus that may
  /// create and destroy readers and writers. Empty ends it: afterwards it does not run.
  virtual void watch(Watcher watcher) = 0;
  /// Throws BusError: refused, or the topic is in use with another type.
  std::unique_ptr<RawReader> reader(const RawTopic& topic, const RawReaderOptions& options, RawHandlers handlers);
  std::unique_ptr<RawWriter> writer(const RawTopic& topic, const RawWriterOptions& options,
                                    StatusCallbacks callbacks = {});
  /// Readers and writers that are made from now on count there. None: they do not count.
  void count_in(std::shared_ptr<Traffic> traffic) { traffic_ = std::move(traffic); }

 protected:
  virtual std::unique_ptr<RawReader> make_reader(const RawTopic& topic, const RawReaderOptions& options,
                                                 RawHandlers handlers) = 0;
  virtual std::unique_ptr<RawWriter> make_writer(const RawTopic& topic, const RawWriterOptions& options,
                                                 StatusCallbacks callbacks) = 0;

 private:
  const std::string vendor_;
  std::shared_ptr<Traffic> traffic_;
};

/// As connect(). In process, raw endpoints meet raw endpoints only: typed messages have no bytes there.
std::shared_ptr<RawBus> connect_raw(const BusOptions& options);

}  // namespace rtd::bus
