// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace rtd::slam {

/// Values by id, for ids that count up and of which most are soon gone again: a lookup is two loads, and pages without
/// a value take no memory, wherever the ids lie. `kNone` is the value of ids that have none.
template <class Value, Value kNone>
class PagedIndex {
 public:
  Value find(std::uint32_t id) const {
    const std::size_t page = id / kPageIds;
    return page >= pages_.size() || pages_[page] == nullptr ? kNone : pages_[page]->values[id % kPageIds];
  }
  /// `id` must have no value yet, `value` must not be kNone.
  void add(std::uint32_t id, Value value) {
    const std::size_t page = id / kPageIds;
    if (page >= pages_.size()) pages_.resize(page + 1);
    if (pages_[page] == nullptr) {
      pages_[page] = std::make_unique<Page>();
      pages_[page]->values.fill(kNone);
    }
    pages_[page]->values[id % kPageIds] = value;
    ++pages_[page]->used;
  }
  /// `id` must have a value.
  void erase(std::uint32_t id) {
    std::unique_ptr<Page>& page = pages_[id / kPageIds];
    page->values[id % kPageIds] = kNone;
    if (--page->used == 0) page.reset();
  }
  /// Ids that have a value, ascending.
  template <class Visitor>
  void for_each_id(Visitor&& visit) const {
    for (std::size_t page = 0; page < pages_.size(); ++page) {
      for (std::size_t i = 0; pages_[page] != nullptr && i < kPageIds; ++i) {
        if (pages_[page]->values[i] != kNone) visit(static_cast<std::uint32_t>(page * kPageIds + i));
      }
    }
  }

 private:
  static constexpr std::size_t kPageIds = 1024;
  struct Page {
    std::array<Value, kPageIds> values;
    std::size_t used = 0;
  };
  std::vector<std::unique_ptr<Page>> pages_;  ///< by id / kPageIds; null where no id has a value
};

}  // namespace rtd::slam
