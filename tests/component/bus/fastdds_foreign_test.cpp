// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// A program of somebody else on our topics: samples of the right type name with the wrong bytes.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/fastdds/participant.hpp"
#include "common/bus/fastdds/qos_mapping.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"

namespace rtd::bus::fastdds {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// Sends the given bytes as they are, CDR header included.
class RawType : public dds::TopicDataType {
 public:
  explicit RawType(const char* name) {
    setName(name);
    m_typeSize = 2 * sizeof(msg::RgbdFrame);
  }
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const Bytes*>(data);
    payload->length = static_cast<std::uint32_t>(bytes.size());
    std::memcpy(payload->data, bytes.data(), bytes.size());
    return true;
  }
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t*, void*) override { return false; }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [size = static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size())] { return size; };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

/// A writer of raw bytes on one of our topics, in a participant of its own.
class ForeignWriter {
 public:
  ForeignWriter(const char* topic, const char* type_name, QosProfile profile) {
    participant_ =
        dds::DomainParticipantFactory::get_instance()->create_participant(test_domain(), dds::PARTICIPANT_QOS_DEFAULT);
    dds::TypeSupport(new RawType(type_name)).register_type(participant_);
    dds::Topic* dds_topic = participant_->create_topic(topic, type_name, dds::TOPIC_QOS_DEFAULT);
    writer_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT)
                  ->create_datawriter(dds_topic, writer_qos(qos_settings(profile), false));
  }
  ~ForeignWriter() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  bool write(Bytes bytes) { return writer_->write(&bytes); }
  int matched() const {
    dds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }

 private:
  dds::DomainParticipant* participant_ = nullptr;
  dds::DataWriter* writer_ = nullptr;
};

/// Sends malformed samples, then expects a good one of ours to arrive all the same.
template <class T>
void expect_survival(const Topic<T>& topic, const char* type_name, const std::vector<Bytes>& malformed, const T& good) {
  BusOptions options;
  options.domain = test_domain();
  const auto bus = connect(options);
  Collector<T> received;
  const auto reader = bus->reader(topic, received.callback());
  auto writer = bus->writer(topic);
  ForeignWriter foreign(topic.name, type_name, topic.profile);
  for (int i = 0; i < 5000 && (writer.matched() < 1 || foreign.matched() < 1); ++i) std::this_thread::sleep_for(1ms);
  ASSERT_EQ(foreign.matched(), 1);

  for (const Bytes& bytes : malformed) ASSERT_TRUE(foreign.write(bytes));
  std::this_thread::sleep_for(100ms);  // let them arrive first
  ASSERT_TRUE(writer.write(good));

  EXPECT_NE(received.next(), nullptr);
  EXPECT_EQ(received.size(), 0U);
}

TEST(ForeignSamples, malformed_plain_messages_are_left_out) {
  expect_survival<msg::TrackingResult>(topics::kTracking, "rtd_msgs::msg::dds_::TrackingResult_",
                                       {Bytes{0, 1, 0, 0}, Bytes(100, 0xff), Bytes{0, 1, 0, 0, 1, 2, 3, 4}}, {});
}

TEST(ForeignSamples, frames_larger_than_their_arrays_are_left_out) {
  Bytes absurd(4 + sizeof(msg::RgbdFrame), 0xff);
  absurd[0] = 0;
  absurd[1] = 1;
  auto good = std::make_unique<msg::RgbdFrame>();
  fill_frame(*good, 1);
  expect_survival(topics::kFrame, "rtd_msgs::msg::dds_::RgbdFrame_", {Bytes{0, 1, 0, 0}, absurd}, *good);
}

TEST(ForeignSamples, malformed_variable_messages_are_left_out) {
  Bytes endless(200, 0xff);
  endless[0] = 0;
  endless[1] = 1;
  expect_survival<msg::Detection2DArray>(topics::kDetections, "vision_msgs::msg::dds_::Detection2DArray_",
                                         {Bytes{0, 1, 0, 0}, endless, Bytes{0, 1, 0, 0, 1, 2, 3, 4}}, {});
}

}  // namespace
}  // namespace rtd::bus::fastdds
