// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/typed_writer.hpp"

#include <dds/ddsc/dds_loan_api.h>

#include <utility>

#include "common/bus/cyclonedds/codec.hpp"

namespace rtd::bus::cyclonedds {

TypedWriter::TypedWriter(std::shared_ptr<Participant> participant, MessageId id, const std::string& topic, Qos qos,
                         StatusCallbacks callbacks)
    : id_(id),
      writer_(participant, sample_type(id), topic, std::move(qos), std::move(callbacks)),
      shares_memory_(participant->shares_memory() && dds_is_shared_memory_available(writer_.handle())) {}

TypedWriter::~TypedWriter() {
  while (!shared_loans_.empty()) discard_loan(*shared_loans_.begin());
}

bool TypedWriter::write(const void* message) {
  if (shares_memory_) return dds_write(writer_.handle(), message) == DDS_RETCODE_OK;
  return writer_.write(encode(id_, writer_.type(), message));
}

void* TypedWriter::loan() {
  void* slot = nullptr;
  if (shares_memory_ && dds_loan_sample(writer_.handle(), &slot) == DDS_RETCODE_OK) {
    return *shared_loans_.insert(slot).first;
  }
  std::shared_ptr<ByteBlock> block = plain_block(id_, writer_.type());
  slot = block->bytes().data() + ByteBlock::kCdrHeaderBytes;
  loans_.emplace(slot, std::move(block));
  return slot;
}

bool TypedWriter::write_loaned(void* slot) {
  if (shared_loans_.erase(slot) > 0) return dds_write(writer_.handle(), slot) == DDS_RETCODE_OK;
  auto node = loans_.extract(slot);
  if (node.empty()) return false;
  if (shares_memory_) return dds_write(writer_.handle(), slot) == DDS_RETCODE_OK;  // there was none left to lend
  return writer_.write(std::move(node.mapped()));
}

void TypedWriter::discard_loan(void* slot) {
  if (shared_loans_.erase(slot) > 0) {
    dds_return_loan(writer_.handle(), &slot, 1);
  } else {
    loans_.erase(slot);
  }
}

}  // namespace rtd::bus::cyclonedds
