// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Prints the poses of the camera with Fast DDS: pose_fastdds [COUNT]. ROS_DOMAIN_ID sets the domain.
#include <geometry_msgsPubSubTypes.h>
#include <cstdio>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
using namespace eprosima::fastdds::dds;

int main(int argc, char** argv) {
  int left = argc > 1 ? std::stoi(argv[1]) : 100;
  const char* domain = std::getenv("ROS_DOMAIN_ID");
  auto* factory = DomainParticipantFactory::get_instance();
  auto* participant = factory->create_participant(domain ? std::stoi(domain) : 0, PARTICIPANT_QOS_DEFAULT);
  if (participant == nullptr) return 1;
  const TypeSupport type(new geometry_msgs::msg::dds_::PoseStamped_PubSubType);
  type.register_type(participant);
  auto* topic = participant->create_topic("rt/slam/pose", type.get_type_name(), TOPIC_QOS_DEFAULT);
  DataReaderQos qos;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.history().depth = 10;
  auto* reader = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT)->create_datareader(topic, qos);
  geometry_msgs::msg::dds_::PoseStamped_ pose;
  SampleInfo info;
  while (left > 0 && reader->wait_for_unread_message({20, 0})) {
    if (!(reader->take_next_sample(&pose, &info) == ReturnCode_t(0)) || !info.valid_data) continue;  // 0: OK
    const auto& stamp = pose.header().stamp();
    const auto& at = pose.pose().position();
    std::printf("%d.%09u %s %.3f %.3f %.3f\n", stamp.sec(), stamp.nanosec(), pose.header().frame_id().c_str(), at.x(),
                at.y(), at.z());
    --left;
  }
  participant->delete_contained_entities();
  factory->delete_participant(participant);
  return left > 0 ? 1 : 0;
}
