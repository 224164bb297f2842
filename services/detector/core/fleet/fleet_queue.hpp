// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rtd::detector {

/// How images of several robots become batches.
struct FleetQueueConfig {
  std::size_t batch = 8;                 ///< images taken at once, at most
  std::int64_t gather_ns = 2'000'000;    ///< longest wait for a fuller batch
  std::int64_t active_ns = 500'000'000;  ///< a robot without an image for longer is not waited for
};

/// One mailbox per robot, of one image: the newest wins. Images are taken in turns, at most one per robot and batch, so
/// a robot that sends more often than others gets no more than they do. Times are given. Not thread-safe.
template <class Image>
class FleetQueue {
 public:
  struct Taken {
    std::string robot;
    Image image;
    std::int64_t arrived_ns = 0;
  };
  /// Without images: when to ask again; empty: after the next put().
  struct Turn {
    std::vector<Taken> batch;
    std::optional<std::int64_t> wait_until_ns;
  };

  explicit FleetQueue(const FleetQueueConfig& config) : config_(config) {}

  /// `robot` may be any text; its first image makes its mailbox.
  void put(const std::string& robot, Image image, std::int64_t now_ns) {
    Mailbox& mailbox = mailboxes_[robot];
    if (mailbox.image) {
      ++mailbox.dropped;
    } else {
      mailbox.waiting_since_ns = now_ns;
    }
    mailbox.image = std::move(image);
    mailbox.arrived_ns = now_ns;
  }

  /// The next batch, in the order of turns. While fewer than half of the mailboxes of active robots (or of the batch,
  /// if that is less) are full, it waits for more, at most gather_ns from the first image on.
  Turn take(std::int64_t now_ns) {
    std::size_t full = 0, active = 0;
    std::int64_t since_ns = now_ns;
    for (const auto& [robot, mailbox] : mailboxes_) {
      if (now_ns - mailbox.arrived_ns < config_.active_ns) ++active;
      if (!mailbox.image) continue;
      ++full;
      since_ns = std::min(since_ns, mailbox.waiting_since_ns);
    }
    if (full == 0) return {};
    const std::int64_t until_ns = since_ns + config_.gather_ns;
    if (2 * full < std::min(active, config_.batch) && now_ns < until_ns) return {{}, until_ns};
    return {take_in_turns(std::min(full, config_.batch)), std::nullopt};
  }

  /// The robot has left: its mailbox and counter are gone.
  void remove(const std::string& robot) { mailboxes_.erase(robot); }

  /// Images of the robot that newer ones have replaced.
  std::uint64_t dropped(const std::string& robot) const {
    const auto found = mailboxes_.find(robot);
    return found == mailboxes_.end() ? 0 : found->second.dropped;
  }

 private:
  struct Mailbox {
    std::optional<Image> image;
    std::int64_t waiting_since_ns = 0;  ///< since when there has been an image, whichever
    std::int64_t arrived_ns = 0;        ///< of the newest image
    std::uint64_t dropped = 0;
  };

  /// Begins after the robot that was served last, even when that robot has left.
  std::vector<Taken> take_in_turns(std::size_t count) {
    std::vector<Taken> batch;
    auto next = mailboxes_.upper_bound(served_last_);
    while (batch.size() < count) {
      if (next == mailboxes_.end()) next = mailboxes_.begin();
      if (auto& [robot, mailbox] = *next; mailbox.image) {
        batch.push_back({robot, std::move(*mailbox.image), mailbox.arrived_ns});
        mailbox.image.reset();
      }
      ++next;
    }
    served_last_ = batch.back().robot;
    return batch;
  }

  const FleetQueueConfig config_;
  std::map<std::string, Mailbox> mailboxes_;
  std::string served_last_;
};

/// When the next batch is to be taken and decoded while the network computes the one before: as late as it can be, so
/// that its images are the newest, and early enough that the network does not wait. Times are given. Not thread-safe.
class StageTiming {
 public:
  void decoded(std::int64_t duration_ns) { decode_ns_ = smooth(decode_ns_, duration_ns); }
  void inferred(std::size_t images, std::int64_t duration_ns) {
    infer_image_ns_ =
        smooth(infer_image_ns_, duration_ns / static_cast<std::int64_t>(std::max<std::size_t>(images, 1)));
  }
  /// How long after the network has begun with so many images the next ones are to be taken.
  std::chrono::nanoseconds delay(std::size_t images) const {
    const std::int64_t infer_ns = static_cast<std::int64_t>(images) * infer_image_ns_;
    return std::chrono::nanoseconds(std::max<std::int64_t>(0, infer_ns - decode_ns_));
  }

 private:
  /// A mean that forgets: a quarter is the newest.
  static std::int64_t smooth(std::int64_t mean_ns, std::int64_t value_ns) {
    return mean_ns == 0 ? value_ns : mean_ns + (value_ns - mean_ns) / 4;
  }

  std::int64_t decode_ns_ = 0, infer_image_ns_ = 0;
};

}  // namespace rtd::detector
