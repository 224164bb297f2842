// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/message_cdr.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/unit/bus/recorded_samples.hpp"

namespace rtd::bus {
namespace {

template <class... T>
testing::Types<T...> as_test_types(TypeList<T...>);

template <class T>
class MessageCdr : public testing::Test {};
TYPED_TEST_SUITE(MessageCdr, decltype(as_test_types(MessageTypes())));

template <class T>
Cdr cdr_of(const T& message) {
  Cdr cdr(cdr_size(message));
  EXPECT_EQ(write_cdr(message, cdr), cdr.size());
  return cdr;
}

/// Counts the members of a struct without its list of fields.
struct AnyMember {
  template <class T>
  operator T() const;
};
template <class T, std::size_t... I>
constexpr bool takes(std::index_sequence<I...>) {
  return requires {
    T{((void)I, AnyMember{})...};
  };
}
template <class T, std::size_t kCount = 20>
constexpr std::size_t member_count() {
  if constexpr (takes<T>(std::make_index_sequence<kCount>())) {
    return kCount;
  } else {
    return member_count<T, kCount - 1>();
  }
}

template <class T>
void expect_complete_list(msg::TypeOf<T>) {
  if constexpr (msg::Message<T>) {
    std::size_t fields = 0;
    msg::for_each_field_type<T>([&]<class Field>(const char*) {
      ++fields;
      expect_complete_list(msg::TypeOf<Field>());
    });
    EXPECT_EQ(fields, member_count<T>()) << msg::type_name(msg::TypeOf<T>());
  }
}
template <class T>
void expect_complete_list(msg::TypeOf<std::vector<T>>) {
  expect_complete_list(msg::TypeOf<T>());
}
template <class T, std::size_t kSize>
void expect_complete_list(msg::TypeOf<std::array<T, kSize>>) {
  expect_complete_list(msg::TypeOf<T>());
}

TYPED_TEST(MessageCdr, list_of_fields_names_every_member) {
  expect_complete_list(msg::TypeOf<TypeParam>());
}

TYPED_TEST(MessageCdr, has_the_recorded_bytes) {
  expect_recorded_bytes<TypeParam>([](const TypeParam& message) { return cdr_of(message); });
  expect_recorded_bytes<TypeParam>([](const TypeParam& message) { return ros::encode<ros::Wire::kCdr>(message); });
}

TYPED_TEST(MessageCdr, gives_the_message_back) {
  std::mt19937_64 random(9);
  for (int number = 0; number < 20; ++number) {
    const auto message = make_message<TypeParam>(number, random), read = make_message<TypeParam>(1, random);
    const Cdr cdr = cdr_of(*message);
    ASSERT_TRUE(read_cdr(cdr, *read)) << "into an object that holds another message";
    ASSERT_EQ(cdr_of(*read), cdr);
    if constexpr (MessageTraits<TypeParam>::kPlain) {
      ASSERT_EQ(std::memcmp(read.get(), message.get(), sizeof(TypeParam)), 0);
      ros::WireReader<ros::Wire::kCdr>{cdr}(*make_message<TypeParam>(1, random));
    } else {
      ASSERT_EQ(reflect::fingerprint(*read), reflect::fingerprint(*message));
    }
  }
}

TYPED_TEST(MessageCdr, is_refused_when_cut_anywhere_or_big_endian) {
  std::mt19937_64 random(10);
  const auto message = make_message<TypeParam>(1, random), read = std::make_unique<TypeParam>();
  Cdr whole = cdr_of(*message);
  const std::size_t step = std::max<std::size_t>(1, whole.size() / 2000);
  for (std::size_t size = 0; size < whole.size(); size += step) {
    EXPECT_FALSE(read_cdr(ros::Bytes(whole).first(size), *read)) << size;
  }
  EXPECT_FALSE(read_cdr(ros::Bytes(whole).first(whole.size() - 1), *read));
  whole[1] = 0;
  EXPECT_FALSE(read_cdr(whole, *read));
}

TYPED_TEST(MessageCdr, is_not_written_into_too_little_memory) {
  std::mt19937_64 random(12);
  const auto message = make_message<TypeParam>(1, random);
  const std::size_t size = cdr_size(*message);
  Cdr memory(size + 1, 0xAB);
  EXPECT_EQ(write_cdr(*message, std::span(memory).first(size - 1)), 0U);
  EXPECT_EQ(memory[size - 1], 0xAB);
  EXPECT_EQ(write_cdr(*message, memory), size);
  EXPECT_EQ(memory[size], 0xAB);
}

TYPED_TEST(MessageCdr, survives_any_change_of_its_bytes) {
  std::mt19937_64 random(11);
  for (int i = 0; i < (MessageTraits<TypeParam>::kPlain ? 3 : 1000); ++i) {
    auto changed = make_message<TypeParam>(1, random);
    Cdr bytes = cdr_of(*changed);
    const std::size_t at = random() % bytes.size();
    const bool absurd_length = random() % 2 == 0;
    for (std::size_t k = at; k < std::min(at + (absurd_length ? 4 : 1), bytes.size()); ++k) {
      bytes[k] = absurd_length ? 0xFF : static_cast<std::uint8_t>(random());
    }
    read_cdr(bytes, *changed);  // either way, but no crash, no exception, no giant allocation
  }
}

TEST(Cdr, of_a_large_image_is_taken_in_one_piece) {
  msg::Image image;
  image.width = image.step = image.height = 4096;
  image.data.resize(image.step * image.height, 7);
  const Cdr cdr = ros::encode<ros::Wire::kCdr>(image);
  EXPECT_EQ(cdr.capacity(), cdr.size()) << "reserved at once";
  EXPECT_EQ(ros::decode<msg::Image>(ros::Wire::kCdr, cdr).data, image.data);
}

TEST(Cdr, of_a_string_without_end_mark_is_refused) {
  Cdr cdr = ros::encode<ros::Wire::kCdr>(msg::Header{{1, 2}, "map"});
  cdr.back() = 'x';
  EXPECT_THROW(ros::decode<msg::Header>(ros::Wire::kCdr, cdr), ros::WireError);
}

TEST(Fingerprint, changes_with_every_kind_of_field) {
  msg::CameraInfo info;
  const auto original = reflect::fingerprint(info);
  const auto changed = [&](auto change) {
    msg::CameraInfo other = info;
    change(other);
    return reflect::fingerprint(other) != original;
  };
  EXPECT_TRUE(changed([](auto& i) { i.header.stamp.nanosec = 1; }));
  EXPECT_TRUE(changed([](auto& i) { i.d.push_back(0.0); }));
  EXPECT_TRUE(changed([](auto& i) { i.p[11] = 1.0; }));
  EXPECT_TRUE(changed([](auto& i) { i.distortion_model = "plumb_bob"; }));
  EXPECT_TRUE(changed([](auto& i) { i.roi.do_rectify = true; }));
}

}  // namespace
}  // namespace rtd::bus
