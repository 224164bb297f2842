// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include "common/bus/cyclonedds/cyclonedds_writer.hpp"
#include "common/bus/message_types.hpp"

namespace rtd::bus::cyclonedds {

/// Writes messages of common/msg. A loan is the sample's own memory: write_loaned() copies nothing. With iceoryx it
/// lies in shared memory, as long as the daemon has some.
class TypedWriter : public WriterBackend {
 public:
  TypedWriter(std::shared_ptr<Participant> participant, MessageId id, const std::string& topic, Qos qos,
              StatusCallbacks callbacks);
  ~TypedWriter() override;

  bool write(const void* message) override;
  void* loan() override;
  bool write_loaned(void* slot) override;
  void discard_loan(void* slot) override;
  int matched() const override { return writer_.matched(); }
  bool wait_acknowledged(int timeout_ms) override { return writer_.wait_acknowledged(timeout_ms); }

 private:
  const MessageId id_;
  CycloneWriter writer_;
  const bool shares_memory_;
  std::map<void*, std::shared_ptr<ByteBlock>> loans_;
  std::set<void*> shared_loans_;
};

}  // namespace rtd::bus::cyclonedds
