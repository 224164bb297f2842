// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/mapping_worker.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kQueueCapacity = 16;  ///< commands; keyframes among them are bounded by room()
constexpr int kMaxPendingKeyframes = 3;

}  // namespace

MappingWorker::MappingWorker(const SlamConfig& config, MappingMode mode, std::function<void()> on_thread_start)
    : mode_(mode), mapper_(config), queue_(kQueueCapacity, concurrency::Overflow::kBlock) {
  if (mode_ == MappingMode::kSynchronous) return;
  thread_ = std::thread([this, on_start = std::move(on_thread_start)] {
    if (on_start) on_start();
    loop();
  });
}

MappingWorker::~MappingWorker() {
  finish();
}

bool MappingWorker::room() const {
  return pending_ < kMaxPendingKeyframes;
}

void MappingWorker::insert(KeyframeProposal proposal) {
  const bool first = proposal.reference == kNoKeyframe;
  if (mode_ == MappingMode::kSynchronous || first) {
    run(std::move(proposal));
  } else {
    ++pending_;
    if (!queue_.push(std::move(proposal))) --pending_;
  }
}

void MappingWorker::recentre(KeyframeId centre) {
  if (mode_ == MappingMode::kSynchronous) {
    run(centre);
  } else {
    queue_.push(centre);
  }
}

LocalMapPtr MappingWorker::snapshot() const {
  const std::lock_guard lock(output_mutex_);
  return snapshot_;
}

std::vector<KeyframeChange> MappingWorker::take_changes() {
  const std::lock_guard lock(output_mutex_);
  return std::exchange(changes_, {});
}

void MappingWorker::finish() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

void MappingWorker::read(const std::function<void(const Map&)>& look) const {
  const std::lock_guard lock(mapper_mutex_);
  look(mapper_.map());
}

void MappingWorker::run(const Command& command) {
  const std::lock_guard mapper_lock(mapper_mutex_);
  if (const auto* proposal = std::get_if<KeyframeProposal>(&command)) {
    centre_ = mapper_.insert(*proposal, [this] { return pending_ > 1; });
  } else {
    centre_ = std::get<KeyframeId>(command);
  }
  LocalMapPtr snapshot = mapper_.local_map(centre_);
  const std::vector<KeyframeChange> changes = mapper_.take_changes();
  const std::lock_guard output_lock(output_mutex_);
  snapshot_ = std::move(snapshot);
  changes_.insert(changes_.end(), changes.begin(), changes.end());
}

void MappingWorker::loop() {
  while (const auto command = queue_.pop()) {
    run(*command);
    if (std::holds_alternative<KeyframeProposal>(*command)) --pending_;
  }
}

}  // namespace rtd::slam
