// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstring>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "common/bus/message_cdr.hpp"
#include "tests/unit/bus/recorded_samples.hpp"

namespace rtd::bus {
namespace {

struct AnyMessageType {
  std::string name;  ///< "rtd_msgs/RgbdFrame"
  MessageId id;
  bool plain;
  std::size_t bytes;                                                   ///< of a plain one in memory
  std::shared_ptr<void> (*make)(int number, std::mt19937_64& random);  ///< make_message()
  std::size_t (*size)(const void* message);                            ///< cdr_size()
  std::size_t (*write)(const void* message, std::span<std::uint8_t>);  ///< write_cdr()
  bool (*read)(ros::Bytes, void* message);                             ///< read_cdr()
  std::uint64_t (*fingerprint)(const void* message);
};

template <class T>
AnyMessageType any_message_type() {
  using Traits = MessageTraits<T>;
  return {
      msg::type_name(msg::TypeOf<T>()),
      Traits::kId,
      Traits::kPlain,
      sizeof(T),
      [](int number, std::mt19937_64& random) -> std::shared_ptr<void> { return make_message<T>(number, random); },
      [](const void* message) { return cdr_size(*static_cast<const T*>(message)); },
      [](const void* message, std::span<std::uint8_t> cdr) { return write_cdr(*static_cast<const T*>(message), cdr); },
      [](ros::Bytes cdr, void* message) { return read_cdr(cdr, *static_cast<T*>(message)); },
      [](const void* message) -> std::uint64_t {
        if constexpr (Traits::kPlain)
          return 0;  // random bytes: compared in memory
        else
          return reflect::fingerprint(*static_cast<const T*>(message));
      }};
}

template <class... T>
std::vector<AnyMessageType> any_message_types(TypeList<T...>) {
  return {any_message_type<T>()...};
}

class MessageCdr : public testing::TestWithParam<AnyMessageType> {
 protected:
  std::shared_ptr<void> make(int number) { return type_.make(number, random_); }
  Cdr cdr_of(const void* message) const {
    Cdr cdr(type_.size(message));
    EXPECT_EQ(type_.write(message, cdr), cdr.size());
    return cdr;
  }

  const AnyMessageType& type_ = GetParam();
  std::mt19937_64 random_{9};
};

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

/// A type within T whose list does not name every member; nullptr: there is none.
template <class T>
constexpr const char* incomplete_list(msg::TypeOf<T>) {
  if constexpr (msg::Message<T>) {
    std::size_t fields = 0;
    const char* incomplete = nullptr;
    msg::for_each_field_type<T>([&]<class Field>(const char*) {
      ++fields;
      if (const char* const found = incomplete_list(msg::TypeOf<Field>())) incomplete = found;
    });
    return fields == member_count<T>() ? incomplete : msg::type_name(msg::TypeOf<T>());
  }
  return nullptr;
}
template <class T>
constexpr const char* incomplete_list(msg::TypeOf<std::vector<T>>) {
  return incomplete_list(msg::TypeOf<T>());
}
template <class T, std::size_t kSize>
constexpr const char* incomplete_list(msg::TypeOf<std::array<T, kSize>>) {
  return incomplete_list(msg::TypeOf<T>());
}
template <class... T>
std::vector<const char*> incomplete_lists(TypeList<T...>) {
  std::vector<const char*> all = {incomplete_list(msg::TypeOf<T>())...};
  std::erase(all, nullptr);
  return all;
}

TEST(MessageFields, name_every_member) {
  EXPECT_THAT(incomplete_lists(MessageTypes()), testing::IsEmpty());
}

/// The codec of ROS gives the same bytes, and reads those of plain messages.
template <class... T>
void expect_recorded_ros_bytes(TypeList<T...>) {
  const auto encode = []<class Message>(const Message& message) {
    Cdr cdr = ros::encode<ros::Wire::kCdr>(message);
    if constexpr (MessageTraits<Message>::kPlain) ros::WireReader<ros::Wire::kCdr>{cdr}(*std::make_unique<Message>());
    return cdr;
  };
  (expect_recorded_bytes<T>(encode), ...);
}
TEST(RosCdr, has_the_recorded_bytes) {
  expect_recorded_ros_bytes(MessageTypes());
}

TEST_P(MessageCdr, has_the_recorded_bytes) {
  random_.seed(13);
  Cdr all;
  for (int number = 0; number < (type_.plain ? 3 : 50); ++number) {
    const Cdr cdr = cdr_of(make(number).get());
    all.insert(all.end(), cdr.begin(), cdr.end());
  }
  EXPECT_EQ(sha256(all), recorded_samples(type_.id).hash);
}

TEST_P(MessageCdr, gives_the_message_back) {
  for (int number = 0; number < 20; ++number) {
    const auto message = make(number), read = make(1);
    const Cdr cdr = cdr_of(message.get());
    ASSERT_TRUE(type_.read(cdr, read.get())) << "into an object that holds another message";
    ASSERT_EQ(cdr_of(read.get()), cdr);
    if (type_.plain) {
      ASSERT_EQ(std::memcmp(read.get(), message.get(), type_.bytes), 0);
    } else {
      ASSERT_EQ(type_.fingerprint(read.get()), type_.fingerprint(message.get()));
    }
  }
}

TEST_P(MessageCdr, is_refused_when_cut_anywhere_or_big_endian) {
  const auto message = make(1), read = make(0);
  Cdr whole = cdr_of(message.get());
  const std::size_t step = std::max<std::size_t>(1, whole.size() / 2000);
  for (std::size_t size = 0; size < whole.size(); size += step)
    EXPECT_FALSE(type_.read(ros::Bytes(whole).first(size), read.get())) << size;
  EXPECT_FALSE(type_.read(ros::Bytes(whole).first(whole.size() - 1), read.get()));
  whole[1] = 0;
  EXPECT_FALSE(type_.read(whole, read.get()));
}

TEST_P(MessageCdr, is_not_written_into_too_little_memory) {
  const auto message = make(1);
  const std::size_t size = type_.size(message.get());
  Cdr memory(size + 1, 0xAB);
  EXPECT_EQ(type_.write(message.get(), std::span(memory).first(size - 1)), 0U);
  EXPECT_EQ(memory[size - 1], 0xAB);
  EXPECT_EQ(type_.write(message.get(), memory), size);
  EXPECT_EQ(memory[size], 0xAB);
}

TEST_P(MessageCdr, survives_any_change_of_its_bytes) {
  for (int i = 0; i < (type_.plain ? 3 : 1000); ++i) {
    const auto changed = make(1);
    Cdr bytes = cdr_of(changed.get());
    const std::size_t at = random_() % bytes.size();
    const bool absurd_length = random_() % 2 == 0;
    for (std::size_t k = at; k < std::min(at + (absurd_length ? 4 : 1), bytes.size()); ++k)
      bytes[k] = absurd_length ? 0xFF : static_cast<std::uint8_t>(random_());
    type_.read(bytes, changed.get());  // either way, but no crash, no exception, no giant allocation
  }
}

INSTANTIATE_TEST_SUITE_P(Types, MessageCdr, testing::ValuesIn(any_message_types(MessageTypes())),
                         [](const auto& test) { return test.param.name.substr(test.param.name.find('/') + 1); });

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
