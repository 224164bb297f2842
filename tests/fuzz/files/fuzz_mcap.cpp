// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed MCAP files: what recover() makes of it reads back without a problem.
#include "common/mcap/copy.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

// The limit of the reader, twice (a record and what it becomes), the cache, LZ4's blocks of 4 MiB, and change.
constexpr std::uint64_t kMaxRecord = 1 << 20, kCache = 1 << 20;
constexpr std::size_t kMaxAllocated = 2 * kMaxRecord + kCache + (9 << 20);

std::vector<Bytes> seeds() {
  std::vector<Bytes> files;
  for (const Compression compression : {Compression::kNone, Compression::kLz4, Compression::kZstd}) {
    for (const bool chunks : {true, false}) {
      WriterOptions options;
      options.compression = compression;
      options.use_chunks = chunks;
      options.chunk_size = 300;
      options.add_extra_data_to_records = compression == Compression::kLz4;
      io::MemorySink sink;
      Writer writer(sink, options);
      write_all(writer, sample_messages(12, 20));
      writer.write(Attachment{1, 2, "a.yaml", "text/yaml", io::bytes_of("fx: 1"), 0});
      writer.write(Metadata{"m", {{"key", "value"}}});
      writer.close();
      files.push_back(sink.bytes());
    }
  }
  return files;
}

/// Every byte that is delivered is read.
std::uint64_t touch(ByteView data) {
  std::uint64_t sum = 0;
  for (const std::byte byte : data) sum += std::to_integer<std::uint64_t>(byte);
  return sum;
}

std::uint64_t read_by_index(const io::ByteSource& source, const ReaderOptions& options) {
  IndexedReader reader(source, options);
  std::uint64_t sum = 0;
  MessageCursor cursor = reader.messages({2, 100, [](const Channel& channel) { return channel.topic != "/pose"; }});
  while (const Message* message = cursor.next()) sum += touch(message->data);
  for (const AttachmentIndex& index : reader.summary().attachment_indexes)
    if (const auto attachment = reader.attachment(index)) sum += touch(attachment->data);
  for (const MetadataIndex& index : reader.summary().metadata_indexes) sum += reader.metadata(index) ? 1 : 0;
  return sum;
}

/// Why the input is a failure; empty when it is none.
std::string try_input(const Bytes& file, bool check_crcs, std::uint64_t& sum) {
  ReaderOptions options{kMaxRecord, kCache, 50, check_crcs};
  const io::MemorySource source(file);
  sum += read_by_index(source, options);
  io::MemorySink sink;
  CopyOptions recovery;
  recovery.reader = options;
  sum += recover(source, sink, recovery).copied.message_count;
  const ReadBack again = stream(sink.bytes());
  for (const StoredMessage& message : again.messages) sum += touch(io::bytes_of(message.data));
  if (!again.problems.empty()) return "the recovered file has problems: " + texts(again.problems);
  return "";
}

}  // namespace
}  // namespace rtd::mcap

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> files = mcap::seeds();
  std::uint64_t sum = 0;
  return fuzz::run_fuzz(argc, argv,
                        {.failed_path = "fuzz_mcap_failed.mcap",
                         .make = [&](fuzz::Random& random) { return fuzz::mutate_one(files, random); },
                         .test = [&](const io::Bytes& input,
                                     fuzz::Random& random) { return mcap::try_input(input, random() % 2 == 0, sum); },
                         .counted = [&] { return "sum of all bytes read " + std::to_string(sum); },
                         .max_allocated = mcap::kMaxAllocated});
}
