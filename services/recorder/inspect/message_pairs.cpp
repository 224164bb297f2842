// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/message_pairs.hpp"

#include <algorithm>
#include <deque>
#include <unordered_map>

namespace rtd::recording {
namespace {

using Messages = std::vector<Fingerprint>;

/// Equal keys are taken in order.
MessagePairs pair_by(const Messages& a, const Messages& b, std::uint64_t Fingerprint::*key, PairedBy paired_by) {
  MessagePairs result{paired_by, {}, {}, {}};
  std::unordered_map<std::uint64_t, std::deque<std::size_t>> waiting;
  for (std::size_t i = 0; i < b.size(); ++i) waiting[b[i].*key].push_back(i);
  std::vector<bool> used(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto found = waiting.find(a[i].*key);
    if (found == waiting.end() || found->second.empty()) {
      result.only_a.push_back(i);
      continue;
    }
    result.pairs.push_back({i, found->second.front()});
    used[found->second.front()] = true;
    found->second.pop_front();
  }
  for (std::size_t i = 0; i < b.size(); ++i)
    if (!used[i]) result.only_b.push_back(i);
  return result;
}

MessagePairs pair_by_position(const Messages& a, const Messages& b) {
  MessagePairs result;
  const std::size_t both = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < both; ++i) result.pairs.push_back({i, i});
  for (std::size_t i = both; i < a.size(); ++i) result.only_a.push_back(i);
  for (std::size_t i = both; i < b.size(); ++i) result.only_b.push_back(i);
  return result;
}

}  // namespace

std::string name_of(PairedBy paired_by) {
  switch (paired_by) {
    case PairedBy::kPublishTime:
      return "publish time";
    case PairedBy::kContent:
      return "content";
    case PairedBy::kPosition:
      break;
  }
  return "position";
}

MessagePairs pair_messages(const TopicContents& a, const TopicContents& b) {
  const std::size_t enough = std::min(a.messages.size(), b.messages.size());
  MessagePairs by_time = pair_by(a.messages, b.messages, &Fingerprint::publish_ns, PairedBy::kPublishTime);
  if (2 * by_time.pairs.size() >= enough) return by_time;
  MessagePairs by_content = pair_by(a.messages, b.messages, &Fingerprint::key, PairedBy::kContent);
  if (2 * by_content.pairs.size() >= enough) return by_content;
  return pair_by_position(a.messages, b.messages);
}

}  // namespace rtd::recording
