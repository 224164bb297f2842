// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <dds/dds.h>
#include <unistd.h>

#include <stdexcept>

#include "geometry_msgs.h"
#include "tests/interop/bus/rmw_double.hpp"

namespace rtd::test_support {
namespace {

/// What rmw_cyclonedds puts before CYCLONEDDS_URI.
std::string config_of(const std::string& setting) {
  if (setting == "localhost_only=1")
    return "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
           "</General></Domain></CycloneDDS>";
  const std::string first_ports =
      "<ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>";
  const std::string begin = "<CycloneDDS><Domain>", end = "</Discovery></Domain></CycloneDDS>";
  const std::string no_multicast = "<General><AllowMulticast>false</AllowMulticast></General>";
  if (setting == "SUBNET") return begin + "<Discovery>" + first_ports + end;
  if (setting == "LOCALHOST")
    return begin + no_multicast + "<Discovery>" + first_ports + "<Peers><Peer address=\"localhost\"/></Peers>" + end;
  if (setting == "OFF")
    return begin + no_multicast + "<Discovery><ParticipantIndex>none</ParticipantIndex><Tag>ros_discovery_off_" +
           std::to_string(getpid()) + "</Tag>" + end;
  return {};
}

dds_entity_t required(dds_entity_t entity) {
  if (entity < 0) throw std::runtime_error(std::string("Cyclone DDS: ") + dds_strretcode(entity));
  return entity;
}

class CycloneDouble final : public RmwDouble {
 public:
  CycloneDouble(const std::string& setting, std::uint32_t domain)
      : domain_(required(dds_create_domain(domain, config_of(setting).c_str()))),
        participant_(required(dds_create_participant(domain, nullptr, nullptr))) {
    dds_qos_t* const qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
    writer_ = required(dds_create_writer(participant_, topic("rt/camera/ground_truth"), qos, nullptr));
    reader_ = required(dds_create_reader(participant_, topic("rt/slam/pose"), qos, nullptr));
    dds_delete_qos(qos);
  }
  ~CycloneDouble() override { dds_delete(domain_); }
  void write() override {
    char frame[] = "world";
    geometry_msgs_msg_dds__PoseStamped_ pose{};
    pose.header.frame_id = frame;
    pose.pose.orientation.w = 1;
    dds_write(writer_, &pose);
  }
  int take() override {
    int taken = 0;
    void* samples[1] = {nullptr};
    dds_sample_info_t info;
    while (dds_take(reader_, samples, &info, 1, 1) > 0) {
      taken += info.valid_data ? 1 : 0;
      dds_return_loan(reader_, samples, 1);
    }
    return taken;
  }

 private:
  dds_entity_t topic(const char* name) const {
    return required(dds_create_topic(participant_, &geometry_msgs_msg_dds__PoseStamped__desc, name, nullptr, nullptr));
  }

  const dds_entity_t domain_, participant_;
  dds_entity_t writer_ = 0, reader_ = 0;
};

}  // namespace

std::unique_ptr<RmwDouble> double_of_cyclonedds(const std::string& setting, std::uint32_t domain) {
  return std::make_unique<CycloneDouble>(setting, domain);
}

}  // namespace rtd::test_support
