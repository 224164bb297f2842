// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/page_hub.hpp"

#include <algorithm>
#include <utility>

#include "services/viewer/core/page_session.hpp"

namespace rtd::viewer {

PageHub::PageHub(PageGreeting greeting, PageLimits limits, Hooks hooks)
    : greeting_(std::move(greeting)), limits_(limits), hooks_(std::move(hooks)) {}

PageHub::~PageHub() = default;

std::unique_ptr<Session> PageHub::open(Rights rights) {
  return std::make_unique<PageSession>(*this, rights);
}

RobotMirror* PageHub::robot(const std::string& name) {
  constexpr std::size_t kMaxRobots = 64;
  const auto known = std::ranges::find(names_, name);
  if (known != names_.end()) return mirrors_[static_cast<std::size_t>(known - names_.begin())].get();
  if (names_.size() >= kMaxRobots) return nullptr;
  names_.push_back(name);
  mirrors_.push_back(std::make_unique<RobotMirror>(static_cast<std::uint8_t>(mirrors_.size())));
  return mirrors_.back().get();
}

void PageHub::set_atlas(std::string json) {
  const auto bytes = std::as_bytes(std::span(json));
  if (atlas_.payload && std::ranges::equal(*atlas_.payload, bytes)) return;
  atlas_ = {atlas_.revision + 1, std::make_shared<const Bytes>(bytes.begin(), bytes.end())};
}

std::optional<PageOptions> PageHub::options(std::uint8_t robot) const {
  if (sessions_.empty()) return std::nullopt;
  PageOptions all = PageOptions::nothing();
  for (const PageSession* session : sessions_) all = all | session->options(robot);
  return all;
}

std::size_t PageHub::ready() const {
  return static_cast<std::size_t>(std::ranges::count_if(sessions_, &PageSession::ready));
}

}  // namespace rtd::viewer
