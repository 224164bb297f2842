// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/component/security/peer_group.hpp"

#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/security/keystore.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::security {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kHour_s = 3600;

Validity valid_until(std::int64_t from_now_s) {
  const std::int64_t now_s = std::time(nullptr);
  return {now_s - 100 * kHour_s, now_s + from_now_s};
}

void replace_text(std::string& text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
}

void create(const std::string& folder) {
  const Validity valid = valid_until(kHour_s);
  const TopicGrant topics = {{"rt/open", "rt/secret"}, {"rt/open", "rt/secret"}};
  create_keystore(folder, {valid, valid, {{}, {"rt/open"}}});
  add_enclaves(folder,
               {{"/rtd/writer", topics}, {"/rtd/reader", topics}, {"/rtd/unpermitted", {{"rt/other"}, {"rt/other"}}}},
               valid, {});
  add_enclaves(folder, {{"/rtd/expired", topics}, {"/rtd/stale", topics}}, valid_until(-kHour_s), {});
}

Identity ca_of(const KeystoreLayout& keystore) {
  return {certificate_from_pem(read_text(keystore.ca_certificate()), "ca"),
          key_from_pem(read_text(keystore.ca_key()), "ca")};
}

/// Certificate expired, permissions not; and the other way round.
void split_expiry(const std::string& folder) {
  const KeystoreLayout keystore{folder};
  const Identity ca = ca_of(keystore);
  const EnclaveFiles expired = keystore.enclave("/rtd/expired"), stale = keystore.enclave("/rtd/stale");
  Permissions permissions = permissions_from_xml(read_text(expired.permissions_xml()), "expired");
  permissions.validity = valid_until(kHour_s);
  std::ofstream(expired.permissions()) << sign_document(to_xml(permissions), ca);
  const Identity renewed = issue("/rtd/stale", valid_until(kHour_s), ca);
  std::ofstream(stale.certificate()) << to_pem(*renewed.certificate);
  std::ofstream(stale.key()) << to_pem(*renewed.key);
}

/// Signed by the right CA, so it could be an old one: without access control in the attacker's own process.
void loosen(const std::string& folder) {
  const KeystoreLayout keystore{folder};
  std::string xml = read_text(keystore.governance_xml());
  replace_text(xml, "access_control>true<", "access_control>false<");
  std::ofstream(keystore.governance()) << sign_document(xml, ca_of(keystore));
}

}  // namespace

Keystores::Keystores(std::string scratch) : scratch_(std::move(scratch)) {
  create(good());
  split_expiry(good());
  create(rogue());
  fs::copy(good(), lax(), fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  loosen(lax());
}

std::vector<std::string> Keystores::clock_of_expired() const {
  return {std::string("LD_PRELOAD=") + SHIFTED_CLOCK_PATH, "CLOCK_SHIFT_S=" + std::to_string(-2 * kHour_s),
          "ASAN_OPTIONS=verify_asan_link_order=0"};  // the clock is loaded before the sanitizer
}

PeerGroup::PeerGroup(std::string vendor)
    : vendor_(std::move(vendor)),
      host_([this](const std::string& peer, const std::string& line) { read_line(peer, line); }) {}

PeerGroup::~PeerGroup() {
  for (const auto process : processes_) host_.terminate(process);
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  for (const auto process : processes_) {
    while (!host_.poll_exit(process) && std::chrono::steady_clock::now() < give_up)
      host_.wait(std::chrono::milliseconds(20));
  }
  for (const auto process : processes_) host_.kill(process);
}

void PeerGroup::start(const std::string& tag, const std::string& keystore, const std::string& enclave,
                      const std::vector<std::string>& topics, const std::vector<std::string>& environment,
                      const std::string& vendor) {
  std::vector<std::string> command = {"/usr/bin/env"};
  command.insert(command.end(), environment.begin(), environment.end());
  const std::string domain = std::to_string(test_domain());
  command.insert(command.end(), {SECURE_PEER_PATH, vendor.empty() ? vendor_ : vendor, domain, keystore, enclave, tag});
  command.insert(command.end(), topics.begin(), topics.end());
  processes_.push_back(host_.start({tag, command}));
}

bool PeerGroup::wait_until(const std::function<bool()>& condition) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition() && std::chrono::steady_clock::now() < give_up) host_.wait(std::chrono::milliseconds(20));
  return condition();
}

void PeerGroup::read_line(const std::string& peer, const std::string& line) {
  std::istringstream text(line);
  std::string event, tag;
  text >> event;
  PeerReport& report = reports_[peer];
  if (event == "sent") {
    text >> report.sent;
  } else if (event == "got") {
    text >> tag;
    text >> report.got[tag];
  } else {
    report.refused = report.refused || event == "refused";
    if (event == "problem") report.problems += line + "\n";
    log_ += peer + ": " + line + "\n";
  }
}

}  // namespace rtd::security
