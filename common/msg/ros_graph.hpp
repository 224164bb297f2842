// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/msg/fields.hpp"

/// What a participant says about its nodes on the topic ros_discovery_info, from which ROS 2 knows nodes and which
/// topics and services are whose. Up to Humble an identity has 24 bytes, later 16: the GUID of DDS, filled up with
/// zeros.
namespace rtd::msg {

template <std::size_t kBytes>
struct Gid {
  std::array<std::uint8_t, kBytes> data{};
};
template <std::size_t kBytes>
constexpr const char* type_name(TypeOf<Gid<kBytes>>) {
  return "rmw_dds_common/Gid";
}
template <std::size_t kBytes>
constexpr void for_each_member(TypeOf<Gid<kBytes>>, auto&& visit) {
  visit("data", &Gid<kBytes>::data);
}

template <std::size_t kBytes>
struct NodeEntitiesInfo {
  std::string node_namespace;
  std::string node_name;
  std::vector<Gid<kBytes>> reader_gid_seq;
  std::vector<Gid<kBytes>> writer_gid_seq;
};
template <std::size_t kBytes>
constexpr const char* type_name(TypeOf<NodeEntitiesInfo<kBytes>>) {
  return "rmw_dds_common/NodeEntitiesInfo";
}
template <std::size_t kBytes>
constexpr void for_each_member(TypeOf<NodeEntitiesInfo<kBytes>>, auto&& visit) {
  using Info = NodeEntitiesInfo<kBytes>;
  visit("node_namespace", &Info::node_namespace);
  visit("node_name", &Info::node_name);
  visit("reader_gid_seq", &Info::reader_gid_seq);
  visit("writer_gid_seq", &Info::writer_gid_seq);
}

template <std::size_t kBytes>
struct ParticipantEntitiesInfo {
  Gid<kBytes> gid;
  std::vector<NodeEntitiesInfo<kBytes>> node_entities_info_seq;
};
template <std::size_t kBytes>
constexpr const char* type_name(TypeOf<ParticipantEntitiesInfo<kBytes>>) {
  return "rmw_dds_common/ParticipantEntitiesInfo";
}
template <std::size_t kBytes>
constexpr void for_each_member(TypeOf<ParticipantEntitiesInfo<kBytes>>, auto&& visit) {
  visit("gid", &ParticipantEntitiesInfo<kBytes>::gid);
  visit("node_entities_info_seq", &ParticipantEntitiesInfo<kBytes>::node_entities_info_seq);
}

}  // namespace rtd::msg
