// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/mapping/mapping_worker.hpp"

namespace rtd::slam {
namespace {

/// Commands. No caller ever waits for room: keyframes among them are bounded by room(), the others are one each.
constexpr std::size_t kQueueCapacity = 16;
constexpr int kMaxPendingKeyframes = 3;

}  // namespace

MappingWorker::MappingWorker(const SlamConfig& config, MappingMode mode, std::function<void()> on_thread_start)
    : config_(config),
      mode_(mode),
      places_per_frame_(static_cast<std::size_t>(config.place.candidates_per_frame)),
      queue_(kQueueCapacity, concurrency::Overflow::kBlock) {
  mapper_ = make_mapper();
  if (mode_ == MappingMode::kSynchronous) return;
  thread_ = std::thread([this, on_start = std::move(on_thread_start)] {
    if (on_start) on_start();
    loop();
  });
}

MappingWorker::~MappingWorker() {
  finish(PendingAdjustment::kCancel);
}

std::unique_ptr<Mapper> MappingWorker::make_mapper() {
  auto mapper = std::make_unique<Mapper>(config_);
  if (mode_ == MappingMode::kThreaded) mapper->adjust_in_background([this] { enqueue(ApplyAdjustment{}); });
  return mapper;
}

void MappingWorker::restart() {
  const std::lock_guard mapper_lock(mapper_mutex_);
  mapper_->cancel_adjustment();
  ++session_;  // what is queued is about the map that goes now
  std::vector<KeyframeChange> changes = mapper_->take_back();
  mapper_ = make_mapper();
  centre_ = 0;
  const std::lock_guard output_lock(output_mutex_);
  snapshot_.reset();
  places_.clear();
  loops_.clear();
  changes_ = std::move(changes);
}

void MappingWorker::restore(MapContents contents) {
  const std::lock_guard mapper_lock(mapper_mutex_);
  mapper_->restore(std::move(contents));
  centre_ = mapper_->map().keyframes().begin()->first;
  LocalMapPtr snapshot = mapper_->local_map(centre_);
  const std::lock_guard output_lock(output_mutex_);
  snapshot_ = std::move(snapshot);
}

bool MappingWorker::room() const {
  return pending_ < kMaxPendingKeyframes;
}

void MappingWorker::insert(KeyframeProposal proposal) {
  if (mode_ == MappingMode::kSynchronous) {
    run(std::move(proposal));
  } else {
    ++pending_;
    if (!enqueue(std::move(proposal))) --pending_;
  }
}

LocalMapPtr MappingWorker::begin_map(KeyframeProposal first) {
  return run(std::move(first));
}

void MappingWorker::recentre(KeyframeId centre) {
  wanted_centre_ = centre;
  if (mode_ == MappingMode::kSynchronous) {
    run(Recentre{});
  } else if (!recentre_queued_.exchange(true)) {
    enqueue(Recentre{});
  }
}

std::vector<LocalMapPtr> MappingWorker::places_like(const FramePtr& frame, std::size_t attempt) {
  if (mode_ == MappingMode::kSynchronous) {
    run(PlaceQuestion{frame, attempt});
  } else if (!place_wanted_.exchange(true)) {
    enqueue(PlaceQuestion{frame, attempt});
  }
  const std::lock_guard lock(output_mutex_);
  return std::exchange(places_, {});
}

LocalMapPtr MappingWorker::snapshot() const {
  const std::lock_guard lock(output_mutex_);
  return snapshot_;
}

std::vector<KeyframeChange> MappingWorker::take_changes() {
  const std::lock_guard lock(output_mutex_);
  return std::exchange(changes_, {});
}

void MappingWorker::finish(PendingAdjustment pending) {
  queue_.close();
  if (!thread_.joinable()) return;
  thread_.join();
  const std::lock_guard mapper_lock(mapper_mutex_);
  if (pending == PendingAdjustment::kAwait) {
    mapper_->finish_adjustment();
  } else {
    mapper_->cancel_adjustment();
  }
  if (!mapper_->map().keyframes().empty()) publish();
}

void MappingWorker::forget_removed(const std::function<void(const Map&)>& before) {
  const std::lock_guard lock(mapper_mutex_);
  before(mapper_->map());
  mapper_->forget_removed();
}

std::vector<LoopClosure> MappingWorker::loops(std::size_t first) const {
  const std::lock_guard lock(output_mutex_);
  if (first >= loops_.size()) return {};
  return {loops_.begin() + static_cast<std::ptrdiff_t>(first), loops_.end()};
}

LocalMapPtr MappingWorker::run(const Command& command) {
  const std::lock_guard mapper_lock(mapper_mutex_);
  return run_locked(command);
}

/// What was queued before a restart counts no more.
void MappingWorker::run_queued(const Queued& queued) {
  const std::lock_guard mapper_lock(mapper_mutex_);
  if (queued.session == session_) {
    run_locked(queued.command);
  } else if (std::holds_alternative<Recentre>(queued.command)) {
    recentre_queued_ = false;
  } else if (std::holds_alternative<PlaceQuestion>(queued.command)) {
    place_wanted_ = false;
  }
}

LocalMapPtr MappingWorker::run_locked(const Command& command) {
  if (const auto* question = std::get_if<PlaceQuestion>(&command)) {
    find_places(*question);
    return nullptr;
  }
  if (const auto* proposal = std::get_if<KeyframeProposal>(&command)) {
    work(*proposal);
  } else if (std::holds_alternative<Recentre>(command)) {
    work(Recentre{});
  } else {
    work(ApplyAdjustment{});
  }
  return publish();
}

void MappingWorker::work(const KeyframeProposal& proposal) {
  centre_ = mapper_->insert(proposal, [this] { return pending_ > 1; });
}

void MappingWorker::work(Recentre /*command*/) {
  recentre_queued_ = false;
  centre_ = wanted_centre_;
}

void MappingWorker::work(ApplyAdjustment /*command*/) {
  mapper_->apply_adjustment();
}

LocalMapPtr MappingWorker::publish() {
  LocalMapPtr snapshot = mapper_->local_map(centre_);
  const std::vector<KeyframeChange> changes = mapper_->take_changes();
  const std::lock_guard output_lock(output_mutex_);
  snapshot_ = snapshot;
  loops_ = mapper_->loops();
  changes_.insert(changes_.end(), changes.begin(), changes.end());
  return snapshot;
}

void MappingWorker::find_places(const PlaceQuestion& question) {
  std::vector<LocalMapPtr> places =
      mapper_->places_like(*question.frame, question.attempt * places_per_frame_, places_per_frame_);
  place_wanted_ = false;
  const std::lock_guard output_lock(output_mutex_);
  places_ = std::move(places);
}

void MappingWorker::loop() {
  while (const auto queued = queue_.pop()) {
    run_queued(*queued);
    if (std::holds_alternative<KeyframeProposal>(queued->command)) --pending_;
  }
}

}  // namespace rtd::slam
