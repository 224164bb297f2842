// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/source_window.hpp"

#include <algorithm>

namespace rtd::mcap {

std::optional<ByteView> SourceWindow::view(std::uint64_t offset, std::uint64_t length) {
  if (!has(offset, length)) return std::nullopt;
  const bool inside =
      offset >= start_ && offset - start_ <= bytes_.size() && length <= bytes_.size() - (offset - start_);
  if (!inside) {
    constexpr std::uint64_t kReadAhead = 1 << 16;
    const std::span<std::byte> into = buffer_.reset(std::min(std::max(length, kReadAhead), size() - offset));
    bytes_ = into.first(source_.read(offset, into));
    start_ = offset;
    if (bytes_.size() < length) return std::nullopt;
  }
  return bytes_.subspan(offset - start_, length);
}

bool SourceWindow::peek(std::uint64_t offset, std::span<std::byte> into) const {
  return has(offset, into.size()) && source_.read(offset, into) == into.size();
}

}  // namespace rtd::mcap
