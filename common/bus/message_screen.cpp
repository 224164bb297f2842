// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/message_screen.hpp"

#include <algorithm>

#include "common/bus/backend.hpp"

namespace rtd::bus {

bool SequenceGuard::continues(const WriterId& writer, std::uint64_t sequence) {
  const auto found = std::ranges::find_if(last_, [&](const Last& last) { return last.known && last.writer == writer; });
  if (found == last_.end()) {
    last_[oldest_] = {writer, sequence, true};
    oldest_ = (oldest_ + 1) % kMaxWriters;
    return true;
  }
  if (sequence > found->sequence && sequence - found->sequence > kMaxLost) return false;
  found->sequence = sequence;
  return true;
}

msg::ImplausibleField MessageScreen::implausible_field(const void* message, const WriterId& writer) {
  return visit_message_type(id_, [&]<class T>() {
    const T& typed = *static_cast<const T*>(message);
    msg::ImplausibleField bad = msg::implausible_field(typed);
    if constexpr (requires { typed.seq; }) {
      if (!bad && !sequences_.continues(writer, typed.seq)) bad = {msg::type_name(msg::TypeOf<T>()), "seq (a jump)"};
    }
    return bad;
  });
}

}  // namespace rtd::bus
