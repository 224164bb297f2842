// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/permissions.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>

namespace rtd::security {
namespace {

using tinyxml2::XMLElement;

std::string topics_xml(const char* action, const std::vector<std::string>& topics) {
  if (topics.empty()) return {};
  std::string xml = fmt::format("        <{}>\n          <topics>\n", action);
  for (const std::string& topic : topics) xml += fmt::format("            <topic>{}</topic>\n", topic);
  // Any partition, also none: topics that stay on a host are in its own partition.
  return xml + fmt::format(
                   "          </topics>\n          <partitions>\n            <partition>*</partition>\n"
                   "          </partitions>\n        </{}>\n",
                   action);
}

std::vector<std::string> topics_of(const XMLElement& rule, const char* action) {
  std::vector<std::string> topics;
  for (const XMLElement* part = rule.FirstChildElement(action); part; part = part->NextSiblingElement(action)) {
    const XMLElement* const list = part->FirstChildElement("topics");
    for (const XMLElement* topic = list ? list->FirstChildElement("topic") : nullptr; topic;
         topic = topic->NextSiblingElement("topic"))
      topics.emplace_back(topic->GetText() ? topic->GetText() : "");
  }
  return topics;
}

/// The last of the children along the path, never null; throws where one is missing.
const XMLElement* descend(const XMLElement& from, const std::vector<const char*>& path, const std::string& origin) {
  const XMLElement* element = &from;
  for (const char* name : path) {
    element = element->FirstChildElement(name);
    if (element == nullptr) throw SecurityError(fmt::format("{}: <{}> is missing", origin, name));
  }
  return element;
}

std::string text_of(const XMLElement& parent, const std::vector<const char*>& path, const std::string& origin) {
  const char* const text = descend(parent, path, origin)->GetText();
  return text == nullptr ? std::string() : text;
}

std::int64_t from_utc(const std::string& text, const std::string& origin) {
  std::tm calendar{};
  if (strptime(text.c_str(), "%Y-%m-%dT%T", &calendar) == nullptr)
    throw SecurityError(fmt::format("{}: '{}' is not a time such as 2026-01-31T00:00:00", origin, text));
  return static_cast<std::int64_t>(timegm(&calendar));
}

DomainRange domains_of(const XMLElement& rule, const std::string& origin) {
  const XMLElement& domains = *descend(rule, {"domains"}, origin);
  const auto number = [&](std::vector<const char*> path) { return std::atoi(text_of(domains, path, origin).c_str()); };
  if (domains.FirstChildElement("id_range")) return {number({"id_range", "min"}), number({"id_range", "max"})};
  return {number({"id"}), number({"id"})};
}

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

bool matches_any(const std::vector<std::string>& patterns, const std::string& topic) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
    return fnmatch(pattern.c_str(), topic.c_str(), FNM_NOESCAPE) == 0;
  });
}

std::string to_utc(std::int64_t time_s) {
  const auto time = static_cast<std::time_t>(time_s);
  std::tm calendar{};
  gmtime_r(&time, &calendar);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%T", &calendar)};
}

std::string to_xml(const Permissions& permissions) {
  std::string name = permissions.subject.substr(permissions.subject.find('/') + 1);
  std::replace(name.begin(), name.end(), '/', '_');
  return fmt::format(
      R"(<?xml version="1.0" encoding="utf-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
  <permissions>
    <grant name="{}">
      <subject_name>{}</subject_name>
      <validity>
        <not_before>{}</not_before>
        <not_after>{}</not_after>
      </validity>
      <allow_rule>
        <domains>
          <id_range>
            <min>{}</min>
            <max>{}</max>
          </id_range>
        </domains>
{}{}      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
)",
      name, permissions.subject, to_utc(permissions.validity.not_before_s), to_utc(permissions.validity.not_after_s),
      permissions.domains.first, permissions.domains.last, topics_xml("publish", permissions.topics.publish),
      topics_xml("subscribe", permissions.topics.subscribe));
}

Permissions permissions_from_xml(const std::string& xml, const std::string& origin) {
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr)
    throw SecurityError(origin + " is not XML: " + document.ErrorStr());
  const XMLElement& grant = *descend(*document.RootElement(), {"permissions", "grant"}, origin);
  Permissions permissions;
  permissions.subject = text_of(grant, {"subject_name"}, origin);
  permissions.validity = {from_utc(text_of(grant, {"validity", "not_before"}, origin), origin),
                          from_utc(text_of(grant, {"validity", "not_after"}, origin), origin)};
  const XMLElement& rule = *descend(grant, {"allow_rule"}, origin);
  permissions.domains = domains_of(rule, origin);
  for (const XMLElement* next = &rule; next; next = next->NextSiblingElement("allow_rule")) {
    for (std::string& topic : topics_of(*next, "publish")) permissions.topics.publish.push_back(std::move(topic));
    for (std::string& topic : topics_of(*next, "subscribe")) permissions.topics.subscribe.push_back(std::move(topic));
  }
  return permissions;
}

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
