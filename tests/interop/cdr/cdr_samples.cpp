// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Samples of the standard messages, one JSON object a line: {"type": "nav_msgs/Odometry", "value": {..}, "cdr":
// "0001.."}
//   cdr_samples types            prints our definitions of them: {"type": "nav_msgs/Odometry", "text": ".."}
//   cdr_samples write            prints samples of our own
//   cdr_samples check < SAMPLES  encodes and decodes those of another implementation; exit code 1 where we differ
#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/bus/message_types.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/type_description.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/unit/bus/random_message.hpp"

namespace rtd::msg {

/// Messages as JSON, each field by its name: what another implementation reads and gives.
template <Message T>
void to_json(nlohmann::json& json, const T& message) {
  for_each_field(message, [&](const char* name, const auto& field) { json[name] = field; });
}
template <Message T>
void from_json(const nlohmann::json& json, T& message) {
  for_each_field(message, [&](const char* name, auto& field) { json.at(name).get_to(field); });
}

}  // namespace rtd::msg

namespace rtd {
namespace {

using Json = nlohmann::json;
using Cdr = std::vector<std::uint8_t>;

/// Calls use.operator()<T>(name) with each standard type of a topic.
template <class... T>
void for_each_type(auto use, bus::TypeList<T...>) {
  const auto use_standard = [&]<class Type>() {
    constexpr std::string_view kName = msg::type_name(msg::TypeOf<Type>());
    if constexpr (!kName.starts_with("rtd_msgs/")) use.template operator()<Type>(kName);
  };
  (use_standard.template operator()<T>(), ...);
}

void write_types() {
  for (const auto& [type, fields] : ros2::message_fields()) {
    if (type.starts_with("rtd_msgs/")) continue;
    const std::size_t slash = type.find('/');
    const std::string name = ros2::dds_type(type.substr(0, slash) + "/msg" + type.substr(slash));
    const std::string text = ros2::definition_of(name).text;
    std::cout << Json{{"type", type}, {"text", text.substr(0, text.find("=="))}}.dump() << '\n';
  }
}

std::string to_hex(const Cdr& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

Cdr from_hex(const std::string& text) {
  Cdr bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

void write_samples() {
  constexpr int kSamples = 50;  // of a type; the first one is empty
  std::mt19937_64 random(21);
  for_each_type(
      [&]<class T>(std::string_view name) {
        for (int i = 0; i < kSamples; ++i) {
          T message;
          if (i > 0) bus::reflect::randomize(message, random);
          const Json sample{{"type", name}, {"value", message}, {"cdr", to_hex(ros::encode<ros::Wire::kCdr>(message))}};
          std::cout << sample.dump() << '\n';
        }
      },
      bus::MessageTypes());
}

/// Empty: we write the same bytes and read the same values.
template <class T>
std::string difference(const Json& sample) {
  const Cdr theirs = from_hex(sample.at("cdr"));
  const Cdr ours = ros::encode<ros::Wire::kCdr>(sample.at("value").get<T>());
  if (ours != theirs) return "we write\n  " + to_hex(ours) + "\nthey write\n  " + to_hex(theirs);
  T message;
  ros::WireReader<ros::Wire::kCdr>{theirs}(message);  // whatever it holds
  const Json read = message;
  if (read != sample.at("value")) return "we read " + read.dump();
  return {};
}

int check_samples() {
  int samples = 0, differences = 0;
  for (std::string line; std::getline(std::cin, line); ++samples) {
    const Json sample = Json::parse(line);
    bool known = false;
    for_each_type(
        [&]<class T>(std::string_view name) {
          if (sample.at("type") != name) return;
          known = true;
          const std::string what = difference<T>(sample);
          if (what.empty()) return;
          ++differences;
          std::cerr << name << ' ' << sample.at("value").dump() << ": " << what << '\n';
        },
        bus::MessageTypes());
    if (!known) ++differences;
  }
  std::cout << samples << " of their samples, " << differences << " differ\n";
  return samples > 0 && differences == 0 ? 0 : 1;
}

}  // namespace
}  // namespace rtd

int main(int argc, char** argv) {
  const std::string command = argc == 2 ? argv[1] : "";
  try {
    if (command == "check") return rtd::check_samples();
    if (command == "types") {
      rtd::write_types();
      return 0;
    }
    if (command == "write") {
      rtd::write_samples();
      return 0;
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  std::cerr << "usage: cdr_samples types|write|check\n";
  return 2;
}
