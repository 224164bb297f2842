// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/rosbag1/bag_writer.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <stdexcept>
#include <utility>

namespace rtd::test {
namespace {

std::string number(std::uint64_t value) {
  return little_endian(value, 4);
}

std::string op(int value) {
  return little_endian(static_cast<std::uint64_t>(value), 1);
}

std::string time_text(std::int64_t time_ns) {
  const auto ns = static_cast<std::uint64_t>(time_ns);
  return number(ns / 1'000'000'000) + number(ns % 1'000'000'000);
}

std::string bz2(std::string data) {
  std::string packed(data.size() + data.size() / 50 + 700, '\0');
  auto size = static_cast<unsigned>(packed.size());
  if (BZ2_bzBuffToBuffCompress(packed.data(), &size, data.data(), static_cast<unsigned>(data.size()), 9, 0, 0) != BZ_OK)
    throw std::runtime_error("bz2");
  packed.resize(size);
  return packed;
}

std::string lz4(const std::string& data) {
  std::string packed(LZ4F_compressFrameBound(data.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), data.data(), data.size(), nullptr));
  return packed;
}

std::string fields_text(const Fields& fields) {
  std::string text;
  for (const auto& [name, value] : fields) text += number(name.size() + 1 + value.size()) + name + '=' + value;
  return text;
}

}  // namespace

std::string little_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
  return text;
}

std::string bag_record(const Fields& header, const std::string& data) {
  const std::string fields = fields_text(header);
  return number(fields.size()) + fields + number(data.size()) + data;
}

std::uint32_t BagWriter::connection(const std::string& topic, const std::string& type, const std::string& definition) {
  const auto id = static_cast<std::uint32_t>(connections_.size());
  const std::string data =
      fields_text({{"topic", topic}, {"type", type}, {"md5sum", "*"}, {"message_definition", definition}});
  connections_[id] = bag_record({{"op", op(7)}, {"conn", number(id)}, {"topic", topic}}, data);
  return id;
}

void BagWriter::message(std::uint32_t connection, std::int64_t time_ns, std::span<const std::uint8_t> bytes) {
  if (!std::exchange(described_[connection], true)) chunk_ += connections_.at(connection);
  index_[connection] += time_text(time_ns) + number(chunk_.size());
  chunk_ += bag_record({{"op", op(2)}, {"conn", number(connection)}, {"time", time_text(time_ns)}},
                       std::string(bytes.begin(), bytes.end()));
}

std::string BagWriter::chunk_record() const {
  const std::string data = compression_ == "bz2" ? bz2(chunk_) : compression_ == "lz4" ? lz4(chunk_) : chunk_;
  return bag_record({{"op", op(5)}, {"compression", compression_}, {"size", number(chunk_.size())}}, data);
}

void BagWriter::end_chunk() {
  if (chunk_.empty()) return;
  body_ += chunk_record();
  for (const auto& [id, entries] : index_) {
    body_ += bag_record(
        {{"op", op(4)}, {"ver", number(1)}, {"conn", number(id)}, {"count", number(entries.size() / 12)}}, entries);
  }
  chunk_.clear();
  index_.clear();
}

std::string BagWriter::closed() {
  end_chunk();
  std::string end;
  for (const auto& [id, record] : connections_) end += record;
  return kVersion + bag_header(4117 + body_.size()) + body_ + end;
}

std::string BagWriter::killed() {
  return kVersion + bag_header(0) + body_ + (chunk_.empty() ? std::string() : chunk_record());
}

std::string BagWriter::bag_header(std::uint64_t index_pos, const Fields& more) {
  constexpr std::size_t kPadded = 4096;
  Fields fields = {
      {"op", op(3)}, {"index_pos", little_endian(index_pos, 8)}, {"conn_count", number(0)}, {"chunk_count", number(0)}};
  fields.insert(fields.end(), more.begin(), more.end());
  return bag_record(fields, std::string(kPadded - fields_text(fields).size(), ' '));
}

}  // namespace rtd::test
