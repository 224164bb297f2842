// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Samples of other programs: whatever their bytes, they give a message or nothing.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>

#include "common/bus/cyclonedds/samples.hpp"
#include "tests/unit/bus/recorded_samples.hpp"

namespace rtd::bus::cyclonedds {
namespace {

using Type = std::unique_ptr<ddsi_sertype, decltype(&destroy_sertype)>;

class CycloneCodec : public testing::TestWithParam<MessageId> {
 protected:
  const MessageId id = GetParam();
  Type type{create_sertype(sample_type(id)), destroy_sertype};
  std::mt19937_64 random{7};

  std::shared_ptr<ByteBlock> sample() {
    return visit_message_type(id, [&]<class T>() {
      auto message = std::make_unique<T>();
      if constexpr (MessageTraits<T>::kPlain) {
        std::memset(static_cast<void*>(message.get()), 0, sizeof(T));
      } else {
        reflect::randomize(*message, random);
      }
      return encode(id, type.get(), message.get());
    });
  }
  std::shared_ptr<ByteBlock> copy_of(std::span<const std::byte> bytes) {
    auto block = std::make_shared<ByteBlock>();
    block->assign(bytes);
    return block;
  }
  /// Some bytes changed, or the end cut off or made longer.
  std::shared_ptr<ByteBlock> mutated(const ByteBlock& sample) {
    const auto bytes = sample.view();
    std::vector<std::byte> changed(bytes.begin(), bytes.end());
    for (std::size_t i = random() % 4; i > 0; --i)
      changed[random() % changed.size()] = static_cast<std::byte>(random());
    const std::size_t way = random() % 4;
    if (way == 0) changed.resize(random() % (changed.size() + 1));
    if (way == 1) changed.resize(changed.size() + random() % 64, static_cast<std::byte>(random()));
    return copy_of(changed);
  }
};

TEST_P(CycloneCodec, every_mutation_gives_a_message_or_nothing) {
  const int rounds = sample_type(id).plain_bytes > 100'000 ? 50 : 5000;
  for (int i = 0; i < rounds; ++i) (void)decode(id, mutated(*sample()));
}

TEST_P(CycloneCodec, refuses_other_encodings_and_half_samples) {
  auto big_endian = copy_of(sample()->view());
  big_endian->bytes()[1] = std::byte{0};
  EXPECT_EQ(decode(id, big_endian), nullptr);
  const auto whole = sample();
  EXPECT_EQ(decode(id, copy_of(whole->view().first(whole->view().size() / 2))), nullptr);
  EXPECT_EQ(decode(id, copy_of({})), nullptr);
}

TEST_P(CycloneCodec, gives_the_recorded_bytes) {
  visit_message_type(id, [&]<class T>() {
    expect_recorded_bytes<T>([&](const T& message) {
      const auto block = encode(id, type.get(), &message);
      const auto* const first = reinterpret_cast<const std::uint8_t*>(std::as_const(*block).view().data());
      return Cdr(first, first + block->view().size());
    });
  });
}

template <class... T>
std::vector<MessageId> ids_of(TypeList<T...>) {
  return {MessageTraits<T>::kId...};
}
INSTANTIATE_TEST_SUITE_P(Messages, CycloneCodec, testing::ValuesIn(ids_of(MessageTypes())));

}  // namespace
}  // namespace rtd::bus::cyclonedds
