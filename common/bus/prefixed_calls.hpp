// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/raw_bus.hpp"

/// Calls as rmw_cyclonedds has them: 16 bytes follow the CDR header of every sample, the number of the client (u64)
/// and that of the request (i64).
namespace rtd::bus {

struct PrefixedCall {
  CallId id;                   ///< the first 8 bytes of the client are in use
  std::vector<std::byte> cdr;  ///< without the prefix
};

/// Whether the client is known by its number in a prefix, and not by the GUID of an endpoint, which never ends in
/// zeros.
bool is_prefixed(const CallId& id);

/// The sample with the prefix, little endian. `cdr` has at least its header.
std::vector<std::byte> with_prefix(const CallId& id, std::span<const std::byte> cdr);

/// Nothing when the sample is too short.
std::optional<PrefixedCall> split_prefix(std::span<const std::byte> sample);

/// One end of a service on raw endpoints of its two topics.
class PrefixedCalls : public CallEndpoint {
 public:
  using MakeReader = std::function<std::unique_ptr<RawReader>(RawHandlers)>;

  /// `client`: another number for every client of a domain.
  PrefixedCalls(CallRole role, std::uint64_t client, std::unique_ptr<RawWriter> writer, const MakeReader& make_reader,
                OnCall on_call);

  std::optional<CallId> request(std::span<const std::byte> cdr) override;
  bool reply(const CallId& id, std::span<const std::byte> cdr) override;
  int matched_readers() const override { return writer_->matched(); }
  int matched_writers() const override { return reader_->matched(); }

 private:
  void receive(const RawSample& sample) const;

  const CallRole role_;
  CallId last_;  ///< of this client, guarded by mutex_
  const OnCall on_call_;
  std::mutex mutex_;
  std::unique_ptr<RawWriter> writer_;
  std::unique_ptr<RawReader> reader_;  // last: it uses the others
};

/// What the raw endpoints of a service are: reliable, volatile, keep-last.
RawReaderOptions call_reader_options(CallRole role);
RawWriterOptions call_writer_options();

/// The topic that an end of a service receives, and the one that it sends.
RawTopic received_topic(const CallTopics& topics, CallRole role);
RawTopic sent_topic(const CallTopics& topics, CallRole role);

}  // namespace rtd::bus
