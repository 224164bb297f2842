// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <openssl/sha.h>

#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "common/bus/backend.hpp"
#include "tests/unit/bus/random_message.hpp"

/// The same messages in every run, and what tests/identity/wire_hashes.txt says of their bytes on the wire.
namespace rtd::bus {

using Cdr = std::vector<std::uint8_t>;

/// Message `number` of a type; the first one of variable size is empty. Plain ones are filled with random bytes.
template <class T>
std::unique_ptr<T> make_message(int number, std::mt19937_64& random) {
  auto message = std::make_unique<T>();
  if constexpr (MessageTraits<T>::kPlain) {
    auto* const memory = reinterpret_cast<std::uint8_t*>(message.get());
    std::generate_n(memory, sizeof(T), [&] { return static_cast<std::uint8_t>(random()); });
  } else if (number > 0) {
    reflect::randomize(*message, random);
  }
  return message;
}

struct RecordedSamples {
  std::string hash;                  ///< SHA-256
  std::uint32_t largest_sample = 0;  ///< what fastddsgen counts
};

inline RecordedSamples recorded_samples(MessageId id) {
  std::ifstream file(WIRE_HASHES_PATH);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string type;
    RecordedSamples recorded;
    if (words >> type >> recorded.hash >> recorded.largest_sample && type == dds_type_name(id)) return recorded;
  }
  return {};
}

inline std::string sha256(const Cdr& bytes) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(bytes.data(), bytes.size(), digest);
  std::string hash;
  for (const unsigned char byte : digest) hash += fmt::format("{:02x}", byte);
  return hash;
}

/// Serialises the recorded messages of a type with to_cdr(message) and compares the bytes.
template <class T, class ToCdr>
void expect_recorded_bytes(ToCdr to_cdr) {
  std::mt19937_64 random(13);
  Cdr all;
  for (int number = 0; number < (MessageTraits<T>::kPlain ? 3 : 50); ++number) {
    const Cdr cdr = to_cdr(*make_message<T>(number, random));
    all.insert(all.end(), cdr.begin(), cdr.end());
  }
  EXPECT_EQ(sha256(all), recorded_samples(MessageTraits<T>::kId).hash);
}

}  // namespace rtd::bus
