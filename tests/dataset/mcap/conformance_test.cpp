// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/stream_reader.hpp"
#include "common/mcap/writer.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::mcap {
namespace {

struct ConformanceCase {
  std::string name;
  std::filesystem::path mcap;  ///< the file, or the Git LFS pointer to it: its SHA-256 and size
  nlohmann::json records;
  std::set<std::string> features;
};

using Json = nlohmann::json;

/// The fields of a JSON record, by name.
Json fields_of(const Json& record) {
  Json fields = Json::object();
  for (const Json& field : record.at("fields")) fields[field.at(0).get<std::string>()] = field.at(1);
  return fields;
}

std::uint64_t number(const Json& fields, const char* name) {
  return std::stoull(fields.at(name).get<std::string>());
}

std::string text(const Json& fields, const char* name) {
  return fields.at(name).get<std::string>();
}

std::string data_of(const Json& fields) {
  std::string data;
  for (const Json& byte : fields.at("data")) data.push_back(static_cast<char>(std::stoi(byte.get<std::string>())));
  return data;
}

void write_record(Writer& writer, const std::string& type, const Json& fields) {
  if (type == "Schema") {
    writer.write(Schema{static_cast<SchemaId>(number(fields, "id")), text(fields, "name"), text(fields, "encoding"),
                        data_of(fields)});
  } else if (type == "Channel") {
    writer.write(Channel{static_cast<ChannelId>(number(fields, "id")),
                         static_cast<SchemaId>(number(fields, "schema_id")), text(fields, "topic"),
                         text(fields, "message_encoding"), fields.at("metadata")});
  } else if (type == "Message") {
    const std::string data = data_of(fields);
    writer.write(Message{static_cast<ChannelId>(number(fields, "channel_id")),
                         static_cast<std::uint32_t>(number(fields, "sequence")), number(fields, "log_time"),
                         number(fields, "publish_time"), io::bytes_of(data)});
  } else if (type == "Attachment") {
    const std::string data = data_of(fields);
    writer.write(Attachment{number(fields, "log_time"), number(fields, "create_time"), text(fields, "name"),
                            text(fields, "media_type"), io::bytes_of(data), 0});
  } else if (type == "Metadata") {
    writer.write(Metadata{text(fields, "name"), fields.at("metadata")});
  }
}

/// Collects fields as the JSON has them: sorted by name, numbers as text.
class Fields {
 public:
  void operator()(const char* name, std::uint64_t value) { add(name, std::to_string(value)); }
  void operator()(const char* name, const std::string& value) { add(name, value); }
  void operator()(const char* name, const std::map<std::string, std::string>& value) {
    add(name, value.empty() ? Json::object() : Json(value));
  }
  void operator()(const char* name, const std::map<ChannelId, std::uint64_t>& value) {
    Json map = Json::object();
    for (const auto& [key, count] : value) map[std::to_string(key)] = std::to_string(count);
    add(name, map);
  }
  void operator()(const char* name, ByteView data) {
    Json list = Json::array();
    for (const std::byte byte : data) list.push_back(std::to_string(std::to_integer<int>(byte)));
    add(name, list);
  }
  Json record(const char* type) const {
    Json fields = Json::array();
    for (const auto& [name, value] : fields_) fields.push_back({name, value});
    return {{"type", type}, {"fields", fields}};
  }

 private:
  void add(const char* name, Json value) { fields_[name] = std::move(value); }
  std::map<std::string, Json> fields_;
};

struct ToJson {
  Fields f;

  Json operator()(const Header& r) {
    f("library", r.library);
    f("profile", r.profile);
    return f.record("Header");
  }
  Json operator()(const Footer& r) {
    f("summary_crc", r.summary_crc);
    f("summary_offset_start", r.summary_offset_start);
    f("summary_start", r.summary_start);
    return f.record("Footer");
  }
  Json operator()(const Schema& r) {
    f("data", io::bytes_of(r.data));
    f("encoding", r.encoding);
    f("id", r.id);
    f("name", r.name);
    return f.record("Schema");
  }
  Json operator()(const Channel& r) {
    f("id", r.id);
    f("message_encoding", r.message_encoding);
    f("metadata", r.metadata);
    f("schema_id", r.schema_id);
    f("topic", r.topic);
    return f.record("Channel");
  }
  Json operator()(const Message& r) {
    f("channel_id", r.channel_id);
    f("data", r.data);
    f("log_time", r.log_time);
    f("publish_time", r.publish_time);
    f("sequence", r.sequence);
    return f.record("Message");
  }
  Json operator()(const Chunk&) { return nullptr; }
  Json operator()(const MessageIndex&) { return nullptr; }
  Json operator()(const ChunkIndex& r) {
    f("chunk_length", r.chunk_length);
    f("chunk_start_offset", r.chunk_start_offset);
    f("compressed_size", r.compressed_size);
    f("compression", r.compression);
    f("message_end_time", r.message_end_time);
    f("message_index_length", r.message_index_length);
    f("message_index_offsets", r.message_index_offsets);
    f("message_start_time", r.message_start_time);
    f("uncompressed_size", r.uncompressed_size);
    return f.record("ChunkIndex");
  }
  Json operator()(const Attachment& r) {
    f("create_time", r.create_time);
    f("data", r.data);
    f("log_time", r.log_time);
    f("media_type", r.media_type);
    f("name", r.name);
    return f.record("Attachment");
  }
  Json operator()(const AttachmentIndex& r) {
    f("create_time", r.create_time);
    f("data_size", r.data_size);
    f("length", r.length);
    f("log_time", r.log_time);
    f("media_type", r.media_type);
    f("name", r.name);
    f("offset", r.offset);
    return f.record("AttachmentIndex");
  }
  Json operator()(const Statistics& r) {
    f("attachment_count", r.attachment_count);
    f("channel_count", r.channel_count);
    f("channel_message_counts", r.channel_message_counts);
    f("chunk_count", r.chunk_count);
    f("message_count", r.message_count);
    f("message_end_time", r.message_end_time);
    f("message_start_time", r.message_start_time);
    f("metadata_count", r.metadata_count);
    f("schema_count", r.schema_count);
    return f.record("Statistics");
  }
  Json operator()(const Metadata& r) {
    f("metadata", r.metadata);
    f("name", r.name);
    return f.record("Metadata");
  }
  Json operator()(const MetadataIndex& r) {
    f("length", r.length);
    f("name", r.name);
    f("offset", r.offset);
    return f.record("MetadataIndex");
  }
  Json operator()(const SummaryOffset& r) {
    f("group_length", r.group_length);
    f("group_opcode", static_cast<std::uint64_t>(r.group_opcode));
    f("group_start", r.group_start);
    return f.record("SummaryOffset");
  }
  Json operator()(const DataEnd& r) {
    f("data_section_crc", r.data_section_crc);
    return f.record("DataEnd");
  }
};

/// All cases below RTD_DATA_DIR/mcap_conformance; none when it is not there.
std::vector<ConformanceCase> conformance_cases() {
  std::vector<ConformanceCase> cases;
  const char* const root = std::getenv("RTD_DATA_DIR");
  const std::filesystem::path folder = std::filesystem::path(root == nullptr ? "" : root) / "mcap_conformance";
  if (root == nullptr || !std::filesystem::is_directory(folder)) return cases;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    const Json json = Json::parse(std::ifstream(entry.path()));
    std::filesystem::path mcap = entry.path();
    cases.push_back({entry.path().stem(), mcap.replace_extension(".mcap"), json.at("records"),
                     json.at("meta").at("variant").at("features")});
  }
  return cases;
}

/// The file that our writer makes of the records of the data section with the options that the features name.
Bytes write_case(const ConformanceCase& test) {
  const auto has = [&](const char* feature) { return test.features.contains(feature); };
  WriterOptions options;
  options.use_chunks = has("ch");
  options.use_message_index = has("mx");
  options.use_statistics = has("st");
  options.use_repeated_schemas = has("rsh");
  options.use_repeated_channels = has("rch");
  options.use_attachment_index = has("ax");
  options.use_metadata_index = has("mdx");
  options.use_chunk_index = has("chx");
  options.use_summary_offset = has("sum");
  options.add_extra_data_to_records = has("pad");
  const Json header = fields_of(test.records.at(0));
  options.profile = text(header, "profile");
  options.library = text(header, "library");
  io::MemorySink sink;
  Writer writer(sink, options);
  for (const Json& record : test.records) {
    if (record.at("type") == "DataEnd") break;
    write_record(writer, record.at("type"), fields_of(record));
  }
  writer.close();
  return sink.bytes();
}

/// The records that our streaming reader delivers, as the JSON has them; problems go to `problems`.
Json read_case(ByteView file, std::string& problems) {
  const io::MemorySource source(file);
  StreamReader reader(source);
  Json records = Json::array();
  while (const Record* record = reader.next()) {
    Json json = std::visit(ToJson{}, *record);
    if (!json.is_null()) records.push_back(std::move(json));
  }
  for (const Problem& problem : reader.problems().listed()) problems += to_string(problem) + '\n';
  return records;
}

/// The messages that our indexed reader delivers (problems other than a missing or partial summary go to `problems`),
/// and those of the data section of the case by log_time.
Json read_case_by_index(ByteView file, std::string& problems) {
  const io::MemorySource source(file);
  IndexedReader reader(source);
  MessageCursor cursor = reader.messages();
  Json messages = Json::array();
  while (const Message* message = cursor.next()) messages.push_back(ToJson{}(*message));
  for (const Problem& problem : reader.problems().listed())
    if (problem.kind != ProblemKind::kNoSummary) problems += to_string(problem) + '\n';
  return messages;
}

Json messages_by_time(const ConformanceCase& test) {
  std::multimap<std::uint64_t, Json> sorted;
  for (const Json& record : test.records)
    if (record.at("type") == "Message") sorted.emplace(number(fields_of(record), "log_time"), record);
  Json messages = Json::array();
  for (const auto& [log_time, record] : sorted) messages.push_back(record);
  return messages;
}

constexpr std::size_t kCases = 416;

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// SHA-256 that a Git LFS pointer names; empty when the file is the real one.
std::string sha256_of_pointer(const std::string& content) {
  static const std::regex kPointer("version https://git-lfs.*\noid sha256:([0-9a-f]{64})\nsize ([0-9]+)\n");
  std::smatch match;
  return std::regex_match(content, match, kPointer) ? match[1].str() : "";
}

class Conformance : public ::testing::Test {
 protected:
  void SetUp() override {
    if (cases().empty()) GTEST_SKIP() << "RTD_DATA_DIR has no mcap_conformance";
    ASSERT_EQ(cases().size(), kCases);
  }
  static const std::vector<ConformanceCase>& cases() {
    static const std::vector<ConformanceCase> kAll = conformance_cases();
    return kAll;
  }
};

TEST_F(Conformance, writes_every_file_byte_by_byte) {
  const rtd::test::TemporaryFolder folder;
  std::ofstream sums(folder / "sums");
  std::size_t by_sum = 0;
  for (const ConformanceCase& test : cases()) {
    const Bytes ours = write_case(test);
    const std::string theirs = read_text(test.mcap);
    const std::string sum = sha256_of_pointer(theirs);
    if (sum.empty()) {
      EXPECT_TRUE(std::ranges::equal(ours, io::bytes_of(theirs))) << test.name;
      continue;
    }
    const std::filesystem::path file = folder / (test.name + ".mcap");
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(ours.data()), static_cast<std::streamsize>(ours.size()));
    sums << sum << "  " << file.string() << '\n';
    ++by_sum;
  }
  sums.close();
  if (by_sum > 0) {
    const rtd::testing::CommandResult check =
        rtd::testing::run_command("sha256sum --strict --quiet -c '" + (folder / "sums").string() + "'");
    EXPECT_EQ(check.exit_code, 0) << check.output;
  }
}

// The files are those that the test above has shown to be the set's, byte by byte.
TEST_F(Conformance, reads_every_file_as_the_set_says) {
  for (const ConformanceCase& test : cases()) {
    const Bytes file = write_case(test);
    std::string problems;
    EXPECT_EQ(read_case(file, problems), test.records) << test.name;
    EXPECT_EQ(problems, "") << test.name;
  }
}

TEST_F(Conformance, finds_the_messages_of_every_file_by_time) {
  for (const ConformanceCase& test : cases()) {
    std::string problems;
    EXPECT_EQ(read_case_by_index(write_case(test), problems), messages_by_time(test)) << test.name;
    EXPECT_EQ(problems, "") << test.name;
  }
}

}  // namespace
}  // namespace rtd::mcap
