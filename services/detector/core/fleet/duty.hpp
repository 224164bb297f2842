// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <deque>
#include <map>
#include <string>

namespace rtd::detector {

/// Which of several detectors serves a robot: since when (by its own clock), and who it is.
struct Claim {
  std::int64_t started_ns = 0;
  double host_id = 0;
  std::int64_t pid = 0;
  auto operator<=>(const Claim&) const = default;
};

/// Decides whether this detector serves one robot, by the heartbeats of other detectors of that robot. A detector that
/// serves continues; a newcomer waits first and then stands by while another one serves. Two that serve at once, for
/// example after their network was divided, agree: the greater claim steps down. Times are given. Not thread-safe.
class Duty {
 public:
  enum class Role {
    kListening,  ///< too early to know whether another one serves
    kStandby,    ///< another one serves
    kServing,
  };

  /// Discovery of the other one, and two of its heartbeats. Where that takes longer, both answer until the younger one
  /// finds the older.
  static constexpr std::int64_t kListenNs = 600'000'000;
  static constexpr std::int64_t kSilentNs = 800'000'000;  ///< four heartbeats missed: the other one is gone

  explicit Duty(std::int64_t now_ns) : began_ns_(now_ns) {}

  /// A heartbeat of another detector. `serves`: false when it ends or is hung.
  void observe(const Claim& other, const std::string& name, bool serves, std::int64_t now_ns);
  /// The role from now on. `own` is the claim of this detector once it serves; it counts only while it does.
  Role update(const Claim& own, std::int64_t now_ns);

  Role role() const { return role_; }
  /// Who serves, for people: "gpubox (pid 42)"; empty unless in standby.
  const std::string& other() const { return other_; }

 private:
  struct Other {
    std::string name;
    std::int64_t received_ns = 0;
    int times = 0;
  };
  bool must_yield(const Claim& own) const;

  static constexpr std::size_t kMaxOthers = 16;  // a writer could make up claims without end
  /// Any program may have sent a single heartbeat.
  static constexpr int kBelievedAfter = 2;

  const std::int64_t began_ns_;
  Role role_ = Role::kListening;
  std::map<Claim, Other> others_;
  std::string other_;
};

/// How one robot was served in the last seconds.
struct AnswerSummary {
  double rate_hz = 0;
  double latency_p50_ms = 0, latency_p99_ms = 0;  ///< from the arrival of the image to its published detections
  double batch_mean = 0;                          ///< images computed together with those of this robot
};

/// Keeps the answers of the last kWindowNs. Times are given. Not thread-safe.
class AnswerStats {
 public:
  static constexpr std::int64_t kWindowNs = 5'000'000'000;

  void add(std::int64_t arrived_ns, std::int64_t answered_ns, std::size_t batch);
  /// Of the window that ends now; zeros without answers.
  AnswerSummary summary(std::int64_t now_ns);

 private:
  struct Answer {
    std::int64_t answered_ns = 0, latency_ns = 0;
    std::size_t batch = 0;
  };
  static constexpr std::size_t kMaxAnswers = 2000;

  std::int64_t first_ns_ = 0;  ///< of all answers; 0: none yet
  std::deque<Answer> answers_;
};

}  // namespace rtd::detector
