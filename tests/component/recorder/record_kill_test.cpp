// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// kill -9 while recording: nothing that was acknowledged is lost. RTD_KILL_RUNS=200 for the long campaign (3 min).
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <random>
#include <thread>

#include "common/bus/raw_bus.hpp"
#include "common/mcap/copy.hpp"
#include "tests/component/recorder/recorded_file.hpp"
#include "tests/component/recorder/recorder_process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::recorder {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using Clock = std::chrono::system_clock;

int runs() {
  const char* const asked = std::getenv("RTD_KILL_RUNS");
  return asked == nullptr ? 5 : std::atoi(asked);
}

std::uint64_t now_ns() {
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(Clock::now().time_since_epoch()).count());
}

/// Sends numbered messages of changing size until it ends, about 4 MB/s.
class NumberSender {
 public:
  NumberSender(bus::RawBus& bus, const std::string& topic) : writer_(bus.writer({topic, "Numbers"}, {deep()})) {
    thread_ = std::thread([this] { loop(); });
  }
  ~NumberSender() {
    ended_ = true;
    thread_.join();
  }
  /// When that message was sent.
  std::uint64_t sent_ns(std::size_t number) const {
    const std::lock_guard lock(mutex_);
    return times_.at(number);
  }
  static std::size_t size_of(std::size_t number) { return 1000 + (number * 7919) % 30'000 / 4 * 4; }
  std::size_t sent() const {
    const std::lock_guard lock(mutex_);
    return times_.size();
  }

 private:
  static bus::RawQos deep() {
    bus::RawQos qos;
    qos.depth = 500;
    return qos;
  }
  void loop() {
    std::vector<std::byte> bytes;
    for (std::uint64_t number = 0; !ended_; ++number) {
      bytes.assign(size_of(number), static_cast<std::byte>(number));
      std::memcpy(bytes.data() + 4, &number, sizeof(number));
      {
        const std::lock_guard lock(mutex_);
        times_.push_back(now_ns());
      }
      writer_->write(bytes);
      std::this_thread::sleep_for(4ms);
    }
  }

  std::unique_ptr<bus::RawWriter> writer_;
  mutable std::mutex mutex_;
  std::vector<std::uint64_t> times_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

std::uint64_t number_in(const ReadMessage& message) {
  std::uint64_t number = 0;
  std::memcpy(&number, message.cdr.data() + 4, sizeof(number));
  return number;
}

/// The newest word of one recorder on how many of the numbers are on disk.
class Watermark {
 public:
  void follow(std::int64_t pid) {
    const std::lock_guard lock(mutex_);
    pid_ = pid;
    acknowledged_ = 0;
  }
  void receive(const msg::ServiceStatus& status) {
    const std::lock_guard lock(mutex_);
    if (status.pid != pid_) return;
    for (const msg::Metric& metric : status.metrics) {
      if (metric.name == "acknowledged:numbers") acknowledged_ = static_cast<std::uint64_t>(metric.value);
    }
  }
  std::uint64_t acknowledged() const {
    const std::lock_guard lock(mutex_);
    return acknowledged_;
  }

 private:
  mutable std::mutex mutex_;
  std::int64_t pid_ = 0;
  std::uint64_t acknowledged_ = 0;
};

/// Every message whole and in order. What did not reach the recorder at all, on a busy host or while it joins, is a gap
/// that it has named; how many of those there are is returned.
int count_gaps(const NumberSender& sender, const std::vector<ReadMessage>& kept) {
  int gaps = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::uint64_t number = number_in(kept[i]);
    EXPECT_EQ(kept[i].cdr.size(), NumberSender::size_of(number));
    EXPECT_EQ(kept[i].cdr.back(), static_cast<std::byte>(number));
    if (i == 0) continue;
    EXPECT_GT(number, number_in(kept[i - 1]));
    if (number != number_in(kept[i - 1]) + 1) ++gaps;
  }
  EXPECT_LT(number_in(kept.back()), sender.sent());
  return gaps;
}

class RecordKill : public ::testing::Test {
 protected:
  RecordKill() {
    bus::BusOptions options;
    options.domain = test_domain();
    options.participant_name = "kill-test";
    typed_ = bus::connect(options);
    raw_ = bus::connect_raw(options);
  }

  /// What the recorder says to have on disk.
  bus::Reader<msg::ServiceStatus> listen(Watermark& watermark) {
    return typed_->reader<msg::ServiceStatus>(bus::topics::kStatus,
                                              [&watermark](const auto& status) { watermark.receive(*status); });
  }
  /// Nothing but the end may be missing: then no chunk before it is.
  static RecordedFile recover(const fs::path& path) {
    const fs::path recovered = path.string() + ".recovered";
    {
      const io::FileSource source(path);
      io::FileSink sink(recovered, io::IfExists::kReplace);
      for (const mcap::Problem& problem : mcap::recover(source, sink).problems) {
        EXPECT_EQ(problem.kind, mcap::ProblemKind::kTruncated) << to_string(problem);
      }
    }
    RecordedFile file = read_recording(recovered);
    fs::remove(recovered);
    return file;
  }

  const rtd::test::TemporaryFolder folder_;
  std::shared_ptr<bus::Bus> typed_;
  std::shared_ptr<bus::RawBus> raw_;
};

TEST_F(RecordKill, nothing_acknowledged_is_lost_and_the_tail_is_short) {
  NumberSender sender(*raw_, "numbers");
  Watermark watermark;
  const auto statuses = listen(watermark);
  std::mt19937 random(7);
  double longest_tail_ms = 0;
  std::uint64_t longest_tail_bytes = 0, acknowledged_in_all = 0;
  int gaps = 0;
  for (int run = 0; run < runs(); ++run) {
    const fs::path path = folder_ / "run.mcap";
    RecorderProcess recorder(test_domain(), {"-o", path, "--topics", "numbers", "--force"});
    watermark.follow(recorder.pid());
    for (int i = 0; i < 20'000 && watermark.acknowledged() == 0; ++i) std::this_thread::sleep_for(1ms);
    ASSERT_GT(watermark.acknowledged(), 0U) << "run " << run << ": nothing was acknowledged within 20 s";
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 700));

    const std::size_t sent = sender.sent();
    const std::uint64_t killed_ns = now_ns();
    recorder.end_by(SIGKILL);
    const std::uint64_t acknowledged = watermark.acknowledged();
    const std::vector<ReadMessage> kept = recover(path).topics.at("numbers");

    ASSERT_GE(kept.size(), acknowledged) << "run " << run;
    gaps += count_gaps(sender, kept);
    const std::uint64_t last = number_in(kept.back());
    std::uint64_t tail_bytes = 0;
    for (std::size_t i = last + 1; i < sent; ++i) tail_bytes += NumberSender::size_of(i);
    const std::uint64_t kept_until = sender.sent_ns(last);
    const double tail_ms = killed_ns > kept_until ? static_cast<double>(killed_ns - kept_until) * 1e-6 : 0.0;
    EXPECT_TRUE(tail_ms <= 250.0 || tail_bytes <= 1024 * 1024)
        << "run " << run << ": " << tail_ms << " ms, " << tail_bytes << " bytes";
    longest_tail_ms = std::max(longest_tail_ms, tail_ms);
    longest_tail_bytes = std::max(longest_tail_bytes, tail_bytes);
    acknowledged_in_all += acknowledged;
  }
  std::printf("%d kills, %llu messages acknowledged, longest tail %.0f ms, %llu bytes; %d gaps in transit\n", runs(),
              static_cast<unsigned long long>(acknowledged_in_all), longest_tail_ms,
              static_cast<unsigned long long>(longest_tail_bytes), gaps);
}

}  // namespace
}  // namespace rtd::recorder
