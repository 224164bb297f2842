// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/keyframe_masks.hpp"

#include <utility>

namespace rtd::dense {

void KeyframeMasks::put(std::int64_t stamp_ns, const DynamicMask& mask) {
  const std::lock_guard lock(mutex_);
  (awaited_.erase(stamp_ns) > 0 ? found_ : recent_).insert_or_assign(stamp_ns, mask);
  if (recent_.size() > kRecent) recent_.erase(recent_.begin());
}

void KeyframeMasks::put(const msg::KeyframeEvent& event) {
  if (event.kind != msg::KeyframeEventKind::kCreated) return;
  const std::lock_guard lock(mutex_);
  if (auto mask = recent_.extract(event.stamp_ns)) {
    found_.insert(std::move(mask));
  } else {
    awaited_.insert(event.stamp_ns);
    if (awaited_.size() > kRecent) awaited_.erase(awaited_.begin());
  }
}

std::map<std::int64_t, DynamicMask> KeyframeMasks::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(found_, {});
}

}  // namespace rtd::dense
