// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed message definitions and changed messages for the reader by fields: no exception but DefinitionError and
/// WireError.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/ros2/message_json.hpp"
#include "tests/fuzz/fuzz_loop.hpp"

namespace rtd {
namespace {

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
    inputs.push_back(fuzz::bytes_of(text));
  }
  return inputs;
}

/// The definition stays.
io::Bytes mutate_message(const io::Bytes& input, fuzz::Random& random) {
  const auto begin = input.begin() + sizeof(kDefinition);
  const io::Bytes message(begin, input.end());
  const io::Bytes changed = fuzz::mutate(message, message, random);
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
  const std::string text = fuzz::text_of(input);
  const std::size_t end = std::min(text.find('\0'), text.size());
  try {
    const ros::MessageFields types = ros::parse_definition("a/A", text.substr(0, end));
    ++counted.definitions;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(input.data());
    const std::size_t begin = std::min(end + 1, input.size());
    read_message(types, {bytes + begin, input.size() - begin}, counted);
  } catch (const ros::DefinitionError&) {
  }
  return "";
}

}  // namespace
}  // namespace rtd

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> inputs = seeds();
  Counted counted;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_messages_failed.txt",
       .make =
           [&](fuzz::Random& random) {
             return random() % 3 == 0 ? fuzz::mutate_one(inputs, random)
                                      : mutate_message(inputs[random() % inputs.size()], random);
           },
       .test = [&](const io::Bytes& input, fuzz::Random&) { return try_input(input, counted); },
       .counted =
           [&] { return fmt::format("{} definitions, {} messages read", counted.definitions, counted.messages); }});
}
