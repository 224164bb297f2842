// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Feeds changed message definitions and changed messages to the reader by fields: fuzz_messages [inputs] [seed]. What
/// must hold for every input: no crash, no sanitizer report, bounded memory, no exception but DefinitionError and
/// WireError. Exit code 1 and the input in fuzz_messages_failed.txt otherwise. The preset asan-ubsan gives it its
/// teeth.
#include <nlohmann/json.hpp>

#include "common/ros2/message_json.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/fuzz/mcap/mutation.hpp"

namespace rtd {
namespace {

constexpr std::size_t kMaxAllocated = 64 << 20;  // 100,000 values that take no bytes, each a named JSON value

constexpr char kDefinition[] =
    "Header header\nuint8 ON=1\nstring<=8 name\ntime when\nValue[] values\nfloat64[3] p\nbool[<=4] flags\nEmpty[2] "
    "none\n"
    "================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
    "================\nMSG: a/Value\nfloat32 x\nint64 n 3\nstring[] texts\nduration d\n"
    "================\nMSG: a/Empty\n# nothing\n";

struct Counted {
  std::uint64_t definitions = 0, messages = 0;
};

/// The definition, NUL, the message.
std::vector<io::Bytes> seeds() {
  std::vector<io::Bytes> inputs;
  for (const std::size_t size : {20U, 120U, 400U}) {
    std::string text(kDefinition, sizeof(kDefinition));
    for (std::size_t i = 0; i < size; ++i) text += i == 1 || i % 8 == 4 ? '\1' : '\0';
    const auto bytes = io::bytes_of(text);
    inputs.emplace_back(bytes.begin(), bytes.end());
  }
  return inputs;
}

/// The definition stays.
io::Bytes mutate_message(const io::Bytes& input, std::mt19937_64& random) {
  const auto begin = input.begin() + sizeof(kDefinition);
  const io::Bytes message(begin, input.end());
  const io::Bytes changed = mcap::mutate(message, message, random);
  io::Bytes whole(input.begin(), begin);
  whole.insert(whole.end(), changed.begin(), changed.end());
  return whole;
}

void read_message(const ros::MessageFields& types, ros::Bytes message, Counted& counted) {
  for (const ros::Wire wire : {ros::Wire::kRos1, ros::Wire::kCdr}) {
    try {
      counted.messages += ros2::message_json(types, "a/A", wire, message, wire == ros::Wire::kRos1 ? 0 : 36).size() > 0;
    } catch (const ros::WireError&) {
    }
  }
}

std::string try_input(const io::Bytes& input, Counted& counted) {
  const std::string text(reinterpret_cast<const char*>(input.data()), input.size());
  const std::size_t end = std::min(text.find('\0'), text.size());
  try {
    const ros::MessageFields types = ros::parse_definition("a/A", text.substr(0, end));
    ++counted.definitions;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(input.data());
    const std::size_t begin = std::min(end + 1, input.size());
    read_message(types, {bytes + begin, input.size() - begin}, counted);
  } catch (const ros::DefinitionError&) {
  }
  if (const std::size_t peak = rtd::testing::peak_allocation(); peak > kMaxAllocated)
    return "it made the reader hold " + std::to_string(peak) + " bytes";
  return "";
}

}  // namespace
}  // namespace rtd

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> inputs = seeds();
  Counted counted;
  return rtd::testing::run_fuzz(
      argc, argv, "fuzz_messages_failed.txt",
      [&](std::mt19937_64& random) {
        const io::Bytes &input = inputs[random() % inputs.size()], &other = inputs[random() % inputs.size()];
        return random() % 3 == 0 ? mcap::mutate(input, other, random) : mutate_message(input, random);
      },
      [&](const io::Bytes& input, std::mt19937_64&) { return try_input(input, counted); },
      [&] {
        return "definitions read " + std::to_string(counted.definitions) + ", messages read " +
               std::to_string(counted.messages);
      });
}
