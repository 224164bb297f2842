// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/io/bytes.hpp"
#include "common/mcap/codec.hpp"

namespace rtd::mcap {

/// Appends the end of a file, from the first summary record to the closing magic, to `out`, which holds the DataEnd.
class SummarySection {
 public:
  /// `out_offset`: where out[0] stands in the file.
  SummarySection(Bytes& out, std::uint64_t out_offset, ByteView padding)
      : out_(out), out_offset_(out_offset), padding_(padding), start_(out.size()) {}

  /// All records of one kind: a vector, or a map whose values they are.
  template <class Records>
  void group(const Records& records, bool wanted) {
    if (!wanted || records.empty()) return;
    const std::uint64_t group_start = offset();
    for (const auto& entry : records) append_record(out_, record_of(entry), padding_);
    const Opcode opcode = record_of(*records.begin()).kOpcode;
    offsets_.push_back({opcode, group_start, offset() - group_start});
  }

  void finish(bool with_offsets) {
    Footer footer;
    if (out_.size() != start_) footer.summary_start = out_offset_ + start_;
    if (with_offsets && !offsets_.empty()) {
      footer.summary_offset_start = offset();
      for (const SummaryOffset& group : offsets_) append_record(out_, group, padding_);
    }
    append_record(out_, footer);
    // The CRC covers the footer up to itself.
    const std::size_t crc_at = out_.size() - sizeof(footer.summary_crc);
    io::store(out_.data() + crc_at, io::crc32(ByteView(out_).subspan(start_, crc_at - start_)));
    Encoder(out_).rest(io::bytes_of(kMagic));
  }

 private:
  std::uint64_t offset() const { return out_offset_ + out_.size(); }
  template <class R>
  static const R& record_of(const R& record) {
    return record;
  }
  template <class Id, class R>
  static const R& record_of(const std::pair<const Id, R>& entry) {
    return entry.second;
  }

  Bytes& out_;
  std::uint64_t out_offset_;
  ByteView padding_;
  std::size_t start_;
  std::vector<SummaryOffset> offsets_;
};

}  // namespace rtd::mcap
