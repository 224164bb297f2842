// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Our samples against the code that Cyclone's idlc makes of idl/.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <diagnostic_msgs.h>
#include <geometry_msgs.h>
#include <gtest/gtest.h>
#include <nav_msgs.h>
#include <rcl_interfaces.h>
#include <rmw_dds_common.h>
#include <rtd_msgs.h>
#include <sensor_msgs.h>
#include <tf2_msgs.h>
#include <vision_msgs.h>
#include <visualization_msgs.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>

#include "common/bus/cyclonedds/samples.hpp"
#include "common/bus/message_cdr.hpp"
#include "tests/unit/bus/recorded_samples.hpp"
#include "tests/unit/bus/ros_messages.hpp"

namespace rtd::bus {
namespace {

const dds_topic_descriptor_t* const kGenerated[] = {&rtd_msgs_msg_dds__RgbdFrame__desc,
                                                    &rtd_msgs_msg_dds__RgbdFrame848__desc,
                                                    &rtd_msgs_msg_dds__RgbdFrame1280__desc,
                                                    &rtd_msgs_msg_dds__RgbdFrame1920__desc,
                                                    &rtd_msgs_msg_dds__FeatureFrame__desc,
                                                    &rtd_msgs_msg_dds__KeyframeEvent__desc,
                                                    &rtd_msgs_msg_dds__TrackingResult__desc,
                                                    &rtd_msgs_msg_dds__ServiceStatus__desc,
                                                    &sensor_msgs_msg_dds__CompressedImage__desc,
                                                    &sensor_msgs_msg_dds__Image__desc,
                                                    &sensor_msgs_msg_dds__CameraInfo__desc,
                                                    &vision_msgs_msg_dds__Detection2DArray__desc,
                                                    &nav_msgs_msg_dds__Odometry__desc,
                                                    &geometry_msgs_msg_dds__PoseStamped__desc,
                                                    &tf2_msgs_msg_dds__TFMessage__desc,
                                                    &nav_msgs_msg_dds__Path__desc,
                                                    &sensor_msgs_msg_dds__PointCloud2__desc,
                                                    &diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                                                    &rtd_msgs_msg_dds__MapUpdate__desc,
                                                    &rtd_msgs_msg_dds__Movers__desc,
                                                    &vision_msgs_msg_dds__Detection3DArray__desc,
                                                    &visualization_msgs_msg_dds__MarkerArray__desc,
                                                    &nav_msgs_msg_dds__OccupancyGrid__desc,
                                                    &geometry_msgs_msg_dds__TransformStamped__desc,
                                                    &rtd_msgs_msg_dds__KeyframeFeatures__desc,
                                                    &rtd_msgs_msg_dds__KeyframeRequest__desc,
                                                    &rtd_msgs_msg_dds__Submap__desc,
                                                    &rtd_msgs_msg_dds__AtlasState__desc,
                                                    &geometry_msgs_msg_dds__PoseArray__desc};

/// A participant that no other process sees.
class LocalDomain {
 public:
  LocalDomain() {
    constexpr dds_domainid_t kDomain = 97;
    domain_ = dds_create_domain(kDomain,
                                "<General><Interfaces><NetworkInterface name='lo'/></Interfaces>"
                                "<AllowMulticast>false</AllowMulticast></General>");
    participant_ = dds_create_participant(kDomain, nullptr, nullptr);
  }
  ~LocalDomain() { dds_delete(domain_); }
  dds_entity_t participant() const { return participant_; }

 private:
  dds_entity_t domain_ = 0, participant_ = 0;
};

/// Passes samples through the structure that idlc generated.
class GeneratedType {
 public:
  GeneratedType(dds_entity_t participant, const dds_topic_descriptor_t& type) : descriptor_(type) {
    const dds_entity_t topic = dds_create_topic(participant, &type, "generated", nullptr, nullptr);
    reader_ = dds_create_reader(participant, topic, nullptr, nullptr);
    writer_ = dds_create_writer(participant, topic, nullptr, nullptr);
    dds_delete(topic);
    void* const empty = std::calloc(1, descriptor_.m_size);
    EXPECT_EQ(dds_write(writer_, empty), DDS_RETCODE_OK);
    std::free(empty);
    ddsi_serdata* const sample = take();
    type_ = sample->type;
    ddsi_serdata_unref(sample);
  }
  ~GeneratedType() {
    dds_delete(reader_);
    dds_delete(writer_);
  }

  /// Empty where the generated code refuses the bytes.
  Cdr passed_through(const Cdr& cdr) {
    const ddsrt_iovec_t piece{const_cast<std::uint8_t*>(cdr.data()), static_cast<ddsrt_iov_len_t>(cdr.size())};
    ddsi_serdata* const ours = ddsi_serdata_from_ser_iov(type_, SDK_DATA, 1, &piece, cdr.size());
    if (ours == nullptr) return {};
    void* const structure = std::calloc(1, descriptor_.m_size);
    EXPECT_TRUE(ddsi_serdata_to_sample(ours, structure, nullptr, nullptr));
    ddsi_serdata_unref(ours);
    EXPECT_EQ(dds_write(writer_, structure), DDS_RETCODE_OK);
    dds_sample_free(structure, &descriptor_, DDS_FREE_ALL);
    return bytes_of(take());
  }

 private:
  ddsi_serdata* take() {
    ddsi_serdata* sample = nullptr;
    dds_sample_info_t info;
    EXPECT_EQ(dds_takecdr(reader_, &sample, 1, &info, DDS_ANY_STATE), 1);
    return sample;
  }

  /// Without the padding at the end, whose size Cyclone puts into the header.
  static Cdr bytes_of(ddsi_serdata* sample) {
    Cdr bytes(ddsi_serdata_size(sample));
    ddsi_serdata_to_ser(sample, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(sample);
    bytes.resize(bytes.size() - (bytes[3] & 3U));
    bytes[3] = 0;
    return bytes;
  }

  const dds_topic_descriptor_t& descriptor_;
  dds_entity_t reader_ = 0, writer_ = 0;
  const ddsi_sertype* type_ = nullptr;
};

template <class T>
void expect_same_bytes(GeneratedType& generated) {
  std::mt19937_64 random(9);
  for (int number = 0; number < (MessageTraits<T>::kPlain ? 3 : 100); ++number) {
    const Cdr cdr = ros::encode<ros::Wire::kCdr>(*make_message<T>(number, random));
    ASSERT_EQ(generated.passed_through(cdr), cdr);
  }
}

TEST(CycloneTypes, write_and_read_the_bytes_of_generated_code) {
  const LocalDomain domain;
  ASSERT_GT(domain.participant(), 0);
  std::uint8_t place = 0;  // in MessageTypes
  for (const dds_topic_descriptor_t* const descriptor : kGenerated) {
    const MessageId id{place++};
    SCOPED_TRACE(descriptor->m_typename);
    EXPECT_EQ(descriptor->m_typename, dds_type_name(id));
    GeneratedType generated(domain.participant(), *descriptor);
    visit_message_type(id, [&]<class T>() { expect_same_bytes<T>(generated); });
  }
  EXPECT_THROW(dds_type_name(MessageId{place}), BusError) << "a type is not compared";
}

template <class T>
void expect_same_ros_bytes(dds_entity_t participant, const dds_topic_descriptor_t& descriptor) {
  SCOPED_TRACE(descriptor.m_typename);
  GeneratedType generated(participant, descriptor);
  std::mt19937_64 random(9);
  for (int number = 0; number < 100; ++number) {
    const Cdr cdr = ros::encode<ros::Wire::kCdr>(reflect::random_ros_message<T>(random));
    ASSERT_EQ(generated.passed_through(cdr), cdr);
  }
}

TEST(CycloneTypes, of_parameters_and_nodes_have_the_bytes_of_generated_code) {
  const LocalDomain domain;
  const auto compare = [&]<class T>(msg::TypeOf<T>, const dds_topic_descriptor_t& descriptor) {
    expect_same_ros_bytes<T>(domain.participant(), descriptor);
  };
  compare(msg::TypeOf<msg::ListParametersRequest>(), rcl_interfaces_srv_dds__ListParameters_Request__desc);
  compare(msg::TypeOf<msg::ListParametersReply>(), rcl_interfaces_srv_dds__ListParameters_Response__desc);
  compare(msg::TypeOf<msg::ParameterNames>(), rcl_interfaces_srv_dds__GetParameters_Request__desc);
  compare(msg::TypeOf<msg::GetParametersReply>(), rcl_interfaces_srv_dds__GetParameters_Response__desc);
  compare(msg::TypeOf<msg::GetParameterTypesReply>(), rcl_interfaces_srv_dds__GetParameterTypes_Response__desc);
  compare(msg::TypeOf<msg::DescribeParametersReply>(), rcl_interfaces_srv_dds__DescribeParameters_Response__desc);
  compare(msg::TypeOf<msg::ParameterList>(), rcl_interfaces_srv_dds__SetParameters_Request__desc);
  compare(msg::TypeOf<msg::SetParametersReply>(), rcl_interfaces_srv_dds__SetParameters_Response__desc);
  compare(msg::TypeOf<msg::SetParametersAtomicallyReply>(),
          rcl_interfaces_srv_dds__SetParametersAtomically_Response__desc);
  compare(msg::TypeOf<msg::ParticipantEntitiesInfo<16>>(), rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc);
  compare(msg::TypeOf<msg::ParticipantEntitiesInfo<24>>(), rmw_dds_common_msg_dds__ParticipantEntitiesInfo24__desc);
}

}  // namespace
}  // namespace rtd::bus

// Samples of other programs: whatever their bytes, they give a message or nothing.
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
