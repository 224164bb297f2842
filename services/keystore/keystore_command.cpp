// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/keystore/keystore_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <ostream>

#include "common/bus/frame_topics.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topic_roles.hpp"
#include "common/bus/topics.hpp"
#include "common/security/enclave.hpp"
#include "common/security/keystore.hpp"
#include "common/service/command_line.hpp"

namespace rtd::keystore {
namespace {

namespace fs = std::filesystem;

std::string advice(const security::EnclaveFiles& files) {
  std::error_code error;
  const fs::perms others = fs::perms::group_all | fs::perms::others_all;
  const bool open = (fs::status(files.key(), error).permissions() & others) != fs::perms::none;
  return open ? fmt::format("; other users can read its key: chmod 600 {}", files.key().string()) : std::string();
}

/// For people: how many topics an enclave may use; --verbose names them.
std::string summarize(const security::Enclave& enclave, std::int64_t now_s) {
  const security::Permissions& permissions = enclave.permissions;
  const auto [first, last] = permissions.domains;
  const bool every = first == 0 && last >= 230;
  return fmt::format("ok    {:<20} until {} ({} days)  {:<13} {:>3} topics out  {:>3} in{}\n", enclave.name,
                     security::to_utc(enclave.valid_until_s()).substr(0, 10),
                     (enclave.valid_until_s() - now_s) / (24 * 3600),
                     every           ? "all domains"
                     : first == last ? fmt::format("domain {}", first)
                                     : fmt::format("domains {}..{}", first, last),
                     permissions.topics.publish.size(), permissions.topics.subscribe.size(), advice(enclave.files));
}

std::string describe(const security::Enclave& enclave) {
  const security::Permissions& permissions = enclave.permissions;
  return fmt::format("ok    {:<16} until {}  domains {}..{}  publishes {}  subscribes {}{}\n", enclave.name,
                     security::to_utc(enclave.valid_until_s()).substr(0, 10), permissions.domains.first,
                     permissions.domains.last, fmt::join(permissions.topics.publish, " "),
                     fmt::join(permissions.topics.subscribe, " "), advice(enclave.files));
}

/// Prints a line for each enclave: until when and for which domains and topics it is valid, or why it is unusable. True
/// when all are usable. Throws security::SecurityError when there is no keystore.
bool print_info(const std::string& folder, bool verbose, std::int64_t now_s, std::ostream& out) {
  const security::KeystoreLayout layout{folder};
  std::error_code error;
  if (!fs::is_directory(layout.enclaves(), error))
    throw security::SecurityError(
        fmt::format("{} is not a keystore: make one with 'rtd keystore create {}'", folder, folder));
  out << folder << (fs::exists(layout.ca_key(), error) ? ": contains the CA's key (keep it off the robots)\n" : "\n");
  bool all_good = true;
  for (const std::string& name : enclaves_in(layout)) {
    try {
      const int first_domain = security::load_enclave(folder, name).permissions.domains.first;
      const security::Enclave enclave = security::open_enclave(folder, name, first_domain, now_s);
      out << (verbose ? describe(enclave) : summarize(enclave, now_s));
    } catch (const security::SecurityError& problem) {
      out << fmt::format("FAIL  {:<16} {}\n", name, problem.what());
      all_good = false;
    }
  }
  return all_good;
}

constexpr std::int64_t kDay_s = 24 * 3600;
constexpr std::int64_t kClockMargin_s = 3600;  // the clocks of two hosts may differ
constexpr int kCaDays = 3650;
constexpr std::array kSharedRoles = {"detector", "atlas"};  // one process may serve several robots

security::Validity from_now(std::int64_t now_s, int days) {
  return {now_s - kClockMargin_s, now_s + days * kDay_s};
}

security::DomainRange domains_of(const KeystoreRequest& request) {
  if (request.domain < 0) return {};
  return {request.domain, request.domain};
}

std::string folder_of(const KeystoreRequest& request) {
  return request.folder.empty() ? security::default_keystore() : request.folder;
}

security::EnclaveRequest enclave_of(const std::string& role, const std::string& robot = {}) {
  bus::RoleTopics topics = bus::topics_of(role);
  for (std::string& topic : topics.writes) topic = bus::topic_of_robot(topic, robot);
  for (std::string& topic : topics.reads) topic = bus::topic_of_robot(topic, robot);
  return {bus::enclave_of_robot(role, robot), {topics.writes, topics.reads}};
}

void append(std::vector<std::string>& topics, const std::vector<std::string>& more) {
  topics.insert(topics.end(), more.begin(), more.end());
}

/// What a detector or an atlas that serves these robots may do besides.
security::TopicGrant served_topics(const std::string& role, const std::vector<std::string>& robots) {
  security::TopicGrant grant;
  for (const std::string& robot : robots) {
    const security::TopicGrant own = enclave_of(role, robot).topics;
    append(grant.publish, own.publish);
    append(grant.subscribe, own.subscribe);
  }
  return grant;
}

/// The enclave of a role that all robots share, if it is such a role.
security::EnclaveRequest enclave_serving(const std::string& role, const std::vector<std::string>& robots) {
  security::EnclaveRequest enclave = enclave_of(role);
  if (std::ranges::find(kSharedRoles, role) == kSharedRoles.end()) return enclave;
  const auto [publish, subscribe] = served_topics(role, robots);
  append(enclave.topics.publish, publish);
  append(enclave.topics.subscribe, subscribe);
  return enclave;
}

/// An enclave for each role of each robot.
std::vector<security::EnclaveRequest> enclaves_of(const std::vector<std::string>& robots) {
  std::vector<security::EnclaveRequest> enclaves;
  for (const std::string& robot : robots) {
    if (!bus::is_robot_name(robot)) throw security::SecurityError("--robot " + robot + " cannot be a robot's name");
    for (const std::string& role : bus::roles()) enclaves.push_back(enclave_of(role, robot));
  }
  return enclaves;
}

void create(const KeystoreRequest& request, std::int64_t now_s, std::ostream& out) {
  const std::string folder = folder_of(request);
  security::KeystoreOptions options{
      from_now(now_s, request.days), from_now(now_s, std::max(kCaDays, request.days)), {domains_of(request), {}}};
  if (!request.encrypt_frames) {
    for (const bus::FrameTopic& topic : bus::frame_topics()) {
      options.governance.access_only.emplace_back(topic.name);
      options.governance.access_only.push_back(bus::topic_of_robot(topic.name, "*"));
    }
  }
  security::create_keystore(folder, options);
  std::vector<security::EnclaveRequest> enclaves;
  for (const std::string& role : bus::roles()) enclaves.push_back(enclave_serving(role, request.robots));
  for (security::EnclaveRequest& enclave : enclaves_of(request.robots)) enclaves.push_back(std::move(enclave));
  security::add_enclaves(folder, enclaves, options.validity, options.governance.domains);
  out << fmt::format(
      "{}: CA, governance and {} enclaves, valid until {}\nUse it with --secure --keystore {}; other hosts need "
      "enclaves/ and public/, but not private/.\n",
      folder, enclaves.size(), security::to_utc(options.validity.not_after_s).substr(0, 10), folder);
}

/// Their enclaves, and the right of the detector and the atlas that they share to serve them.
void add_robots(const KeystoreRequest& request, std::int64_t now_s, std::ostream& out) {
  const std::string folder = folder_of(request);
  const std::vector<security::EnclaveRequest> enclaves = enclaves_of(request.robots);
  const security::Validity validity = from_now(now_s, request.days);
  security::add_enclaves(folder, enclaves, validity, domains_of(request));
  const std::vector<std::string> there = security::enclaves_in({folder});
  for (const char* role : kSharedRoles) {
    const std::string name = bus::enclave_of_robot(role, "");
    if (std::ranges::find(there, name) != there.end()) {
      security::renew_enclave(folder, name, validity, served_topics(role, request.robots));
    } else {  // the keystore is older than the role
      security::add_enclaves(folder, {enclave_serving(role, request.robots)}, validity, domains_of(request));
    }
  }
  out << fmt::format("{}: {} enclaves for {}; /rtd/{} may serve them\n", folder, enclaves.size(),
                     fmt::join(request.robots, ", "), fmt::join(kSharedRoles, " and /rtd/"));
}

void add(const KeystoreRequest& request, std::int64_t now_s, std::ostream& out) {
  if (request.enclaves.empty() && !request.robots.empty()) return add_robots(request, now_s, out);
  if (request.enclaves.empty() || !request.robots.empty())
    throw security::SecurityError("name one enclave to add, or robots with --robot");
  security::EnclaveRequest enclave;
  if (!request.like.empty()) enclave = enclave_of(request.like);
  enclave.name = request.enclaves.front();
  auto& [publish, subscribe] = enclave.topics;
  append(publish, request.publish);
  append(subscribe, request.subscribe);
  if (publish.empty() && subscribe.empty())
    throw security::SecurityError("enclave " + enclave.name +
                                  ": give its topics with --like, --publish or --subscribe");
  security::add_enclaves(folder_of(request), {enclave}, from_now(now_s, request.days), domains_of(request));
  out << fmt::format("{}: may publish {}; may subscribe {}\n", enclave.name, fmt::join(publish, " "),
                     fmt::join(subscribe, " "));
}

void renew(const KeystoreRequest& request, std::int64_t now_s, std::ostream& out) {
  const std::string folder = folder_of(request);
  const std::vector<std::string> enclaves =
      request.enclaves.empty() ? security::enclaves_in({folder}) : request.enclaves;
  const security::Validity validity = from_now(now_s, request.days);
  for (const std::string& name : enclaves)
    security::renew_enclave(folder, name, validity, {request.publish, request.subscribe});
  out << fmt::format("{}: {} valid until {}\n", folder, fmt::join(enclaves, " "),
                     security::to_utc(validity.not_after_s).substr(0, 10));
}

CLI::App* add_action(CLI::App& app, KeystoreRequest& request, KeystoreRequest::Action action, const std::string& name,
                     const std::string& help) {
  CLI::App* const sub = app.add_subcommand(name, help);
  sub->add_option("dir", request.folder,
                  "Keystore (default: RTD_KEYSTORE, ROS_SECURITY_KEYSTORE, ~/.config/rtd/keystore)");
  sub->callback([&request, action] { request.action = action; });
  return sub;
}

void add_days(CLI::App& sub, KeystoreRequest& request) {
  sub.add_option("--days", request.days, "Days for which certificates and permissions are valid")
      ->check(CLI::Range(1, 36500))
      ->capture_default_str();
}

void add_domain(CLI::App& sub, KeystoreRequest& request) {
  sub.add_option("--domain", request.domain, "Only this DDS domain (default: all)")->check(CLI::Range(0, 230));
}

void add_robots_option(CLI::App& sub, KeystoreRequest& request) {
  sub.add_option(
      "--robot", request.robots,
      "Enclaves /rtd/NAME/... for a robot of this name; /rtd/detector and /rtd/atlas may serve it (repeatable)");
}

void add_topics(CLI::App& sub, KeystoreRequest& request) {
  sub.add_option("--publish", request.publish, "More DDS topics or patterns to publish, e.g. 'rt/my/*'");
  sub.add_option("--subscribe", request.subscribe, "More DDS topics or patterns to subscribe to");
}

}  // namespace

void add_keystore_commands(CLI::App& app, KeystoreRequest& request) {
  using Action = KeystoreRequest::Action;
  app.require_subcommand(1);
  CLI::App* const create =
      add_action(app, request, Action::kCreate, "create", "Create a CA and an enclave for each service");
  add_days(*create, request);
  add_domain(*create, request);
  add_robots_option(*create, request);
  create->add_flag("--encrypt-frames", request.encrypt_frames,
                   "Encrypt raw frames too: they then leave shared memory (docs/security.md has the cost)");
  CLI::App* const add = add_action(app, request, Action::kAdd, "add", "Add an enclave, or those of a robot");
  add->get_option("dir")->required();
  add->add_option("enclave", request.enclaves, "Its name, e.g. /rtd/observer2")->expected(1);
  add_robots_option(*add, request);
  add->add_option("--like", request.like, "Give it the topics of this role")->check(CLI::IsMember(bus::roles()));
  add_topics(*add, request);
  add_days(*add, request);
  add_domain(*add, request);
  CLI::App* const renew =
      add_action(app, request, Action::kRenew, "renew", "Renew keys and dates; topics and domains stay");
  renew->add_option("enclaves", request.enclaves, "Enclaves to renew (default: all)");
  add_topics(*renew, request);
  add_days(*renew, request);
  add_action(app, request, Action::kInfo, "info", "Show permissions and dates of all enclaves, and the problems")
      ->add_flag("--verbose", request.verbose, "Also name the topics that each enclave may use");
  app.footer("Exit code: 0 done, 1 info found an unusable enclave, 2 not possible");
}

int run_keystore(const KeystoreRequest& request, std::int64_t now_s, std::ostream& out, std::ostream& err) {
  using Action = KeystoreRequest::Action;
  return service::report_errors<security::SecurityError>("rtd keystore", err, [&] {
    if (request.action == Action::kCreate) create(request, now_s, out);
    if (request.action == Action::kAdd) add(request, now_s, out);
    if (request.action == Action::kRenew) renew(request, now_s, out);
    const bool good = request.action != Action::kInfo || print_info(folder_of(request), request.verbose, now_s, out);
    return good ? service::kOk : service::kRunFailed;
  });
}

}  // namespace rtd::keystore
