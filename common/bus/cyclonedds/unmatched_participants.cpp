// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/unmatched_participants.hpp"

#include <dds/ddsrt/log.h>

#include <algorithm>
#include <cstdio>
#include <list>
#include <mutex>
#include <utility>

#include "common/bus/security_guard.hpp"

namespace rtd::bus::cyclonedds {
namespace {

/// A handshake takes some tenths of a second, on a busy host more.
constexpr std::chrono::seconds kSuspicious{3};
/// So many at once are an attack on our memory.
constexpr std::size_t kMaxKnown = 1000;

/// What follows the first `mark`; empty without it.
std::string_view after(std::string_view line, std::string_view mark) {
  const std::size_t at = line.find(mark);
  return at == std::string_view::npos ? std::string_view() : line.substr(at + mark.size());
}

/// The participant's part of the GUID with which the text begins: three of its four numbers.
std::string guid_in(std::string_view text) {
  const std::string_view guid = text.substr(0, text.find_first_not_of("0123456789abcdef:"));
  return std::string(guid.substr(0, guid.rfind(':')));
}

/// As RTPS writes it and Fast DDS shows it: "01.10.85.78....".
std::string dotted(const std::string& guid) {
  unsigned words[3] = {};
  if (std::sscanf(guid.c_str(), "%x:%x:%x", &words[0], &words[1], &words[2]) != 3) return guid;
  std::string text;
  for (const unsigned word : words) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) {
      char byte[8];
      std::snprintf(byte, sizeof(byte), "%s%02x", text.empty() ? "" : ".", (word >> shift) & 0xffU);
      text += byte;
    }
  }
  return text;
}

/// "'rtd-slam' 01.10....", as problems name participants.
std::string name_in(std::string_view line, const std::string& guid) {
  const std::string_view rest = after(line, "entity_name=\"");
  std::string name(rest.substr(0, rest.find('"')));
  std::replace_if(
      name.begin(), name.end(), [](char letter) { return letter < ' ' || letter > '~'; }, '?');
  return (name.empty() ? "" : "'" + name + "' ") + dotted(guid);
}

/// Cyclone has one sink for the traces of all domains of a process, and does not say (0.10.2) which one a line is from.
struct Watches {
  std::mutex mutex;
  std::list<UnmatchedWatch*> all;
};

Watches& watches() {
  static Watches watches;
  return watches;
}

}  // namespace

std::vector<std::string> UnmatchedParticipants::read(std::string_view line, TimePoint now) {
  if (line.starts_with("SPDP ST0 ")) return appeared(line, now);
  if (line.starts_with("SPDP ST3 ")) unproven_.erase(guid_in(line.substr(9)));
  if (const auto gone = after(line, "ddsi_delete_proxy_participant_by_guid("); !gone.empty())
    unproven_.erase(guid_in(gone));
  const bool failed = line.find(" failed: ") != std::string_view::npos;
  if (line.starts_with("handshake (lguid=") && !failed) unproven_.erase(guid_in(after(line, "rguid=")));
  const bool handshake = line.starts_with("handshake (") || line.starts_with("Begin handshake ") ||
                         line.starts_with("Process handshake ") || line.starts_with("Validate remote identity ");
  return handshake && failed ? refused(now) : std::vector<std::string>();
}

/// "SPDP ST0 GUID bes f [(secure)] NEW [(versions of Cyclone)] (data ADDRESS ...) QOS={...}"
std::vector<std::string> UnmatchedParticipants::appeared(std::string_view line, TimePoint now) {
  const std::size_t end = line.find(" NEW ");
  if (end == std::string_view::npos) return {};  // our own, or an update of a known one
  const std::string guid = guid_in(line.substr(9));
  const std::string name = name_in(line, guid);
  if (unproven_.size() >= kMaxKnown) unproven_.clear();
  const auto [known, is_new] = unproven_.try_emplace(guid, Participant{name, now});
  if (!is_new) return {};
  const bool secure = line.substr(0, end).find("(secure)") != std::string_view::npos;
  const bool same_vendor = line.substr(end).starts_with(" NEW (0x");
  known->second.reported = !secure || !same_vendor;
  if (!same_vendor) {
    const bool fast = line.find("\"fastdds.") != std::string_view::npos;
    return {other_vendor_problem(domain_, name, fast ? "Fast DDS" : "another DDS")};
  }
  if (!secure) return {not_secured_problem(domain_, name)};
  return {};
}

std::vector<std::string> UnmatchedParticipants::refused(TimePoint now) {
  std::vector<std::string> problems;
  for (auto& [guid, participant] : unproven_) {
    const bool meant = unproven_.size() == 1 || now - participant.since > kSuspicious;
    if (participant.reported || !meant) continue;
    participant.reported = true;
    problems.push_back(refused_problem(domain_, participant.name));
  }
  return problems;
}

std::unique_ptr<UnmatchedWatch> UnmatchedWatch::start(const BusOptions& options) {
  if (!options.security.enabled() || !options.on_problem) return nullptr;
  return std::unique_ptr<UnmatchedWatch>(new UnmatchedWatch(options));
}

UnmatchedWatch::UnmatchedWatch(const BusOptions& options)
    : on_problem_(options.on_problem), unmatched_(options.domain) {
  static std::once_flag once;
  std::call_once(once, [] {
    dds_set_trace_sink([](void*, const dds_log_data_t* line) { dispatch({line->message, line->size}); }, nullptr);
  });
  const std::lock_guard lock(watches().mutex);
  watches().all.push_back(this);
}

UnmatchedWatch::~UnmatchedWatch() {
  const std::lock_guard lock(watches().mutex);
  watches().all.remove(this);
}

void UnmatchedWatch::dispatch(std::string_view line) {
  const std::lock_guard lock(watches().mutex);
  for (UnmatchedWatch* watch : watches().all) watch->read(line);
}

void UnmatchedWatch::read(std::string_view line) {
  for (std::string& problem : unmatched_.read(line, std::chrono::steady_clock::now()))
    thread_.post([this, problem = std::move(problem)] { on_problem_(problem); });
}

}  // namespace rtd::bus::cyclonedds
