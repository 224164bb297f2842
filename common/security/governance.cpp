// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/governance.hpp"

#include <fmt/format.h>

namespace rtd::security {
namespace {

std::string topic_rule(const std::string& topic, TopicProtection protection) {
  const bool encrypt = protection == TopicProtection::kEncrypt;
  return fmt::format(
      R"(        <topic_rule>
          <topic_expression>{}</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>{}</metadata_protection_kind>
          <data_protection_kind>{}</data_protection_kind>
        </topic_rule>
)",
      topic, encrypt ? "SIGN" : "NONE", encrypt ? "ENCRYPT" : "NONE");
}

}  // namespace

std::string to_xml(const Governance& governance) {
  std::string rules;
  for (const std::string& topic : governance.access_only) rules += topic_rule(topic, TopicProtection::kAccessOnly);
  rules += topic_rule("*", TopicProtection::kEncrypt);  // the first rule that fits counts
  return fmt::format(
      R"(<?xml version="1.0" encoding="utf-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
      <domains>
        <id_range>
          <min>{}</min>
          <max>{}</max>
        </id_range>
      </domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>NONE</rtps_protection_kind>
      <topic_access_rules>
{}      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)",
      governance.domains.first, governance.domains.last, rules);
}

}  // namespace rtd::security
