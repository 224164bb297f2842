// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/read_ahead.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>

namespace rtd::camera {
namespace {

/// Frames 0, 1, 2, ... until `frames`, then a failure when asked for one.
class CountingSource final : public FrameSource {
 public:
  CountingSource(std::uint64_t frames, bool fails) : frames_(frames), fails_(fails) {}
  std::optional<SourceFrame> next() override {
    if (counters_.frames == frames_) {
      if (fails_) throw SourceError("the disk went away");
      return std::nullopt;
    }
    SourceFrame frame;
    frame.image.seq = counters_.frames++;
    frame.image.stamp_ns = static_cast<std::int64_t>(frame.image.seq);
    return frame;
  }
  std::uint64_t pass_over(std::int64_t stamp_ns) override {
    const std::uint64_t before = counters_.frames;
    counters_.frames =
        std::max(before, std::min(frames_, static_cast<std::uint64_t>(std::max<std::int64_t>(stamp_ns, 0))));
    return counters_.frames - before;
  }
  const SourceInfo& info() const override { return info_; }
  const SourceCounters& counters() const override { return counters_; }
  geometry::Trajectory groundtruth() const override { return {}; }
  std::vector<SkippedInput> take_skipped() override { return {{SkipReason::kMalformedLine, "a line"}}; }

 private:
  std::uint64_t frames_;
  bool fails_;
  SourceInfo info_;
  SourceCounters counters_;
};

TEST(ReadAhead, hands_over_every_frame_in_order_then_the_end) {
  CountingSource source(20, false);
  ReadAhead frames(source, 2, 0);
  for (std::uint64_t seq = 0; seq < 20; ++seq) {
    const std::optional<ReadItem> item = frames.next();
    ASSERT_TRUE(item && item->frame);
    EXPECT_EQ(item->frame->image.seq, seq);
    EXPECT_EQ(item->counters.frames, seq + 1);
    EXPECT_EQ(item->skipped.size(), 1U);
  }
  const std::optional<ReadItem> end = frames.next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->frame);
  EXPECT_TRUE(end->error.empty());
}

TEST(ReadAhead, passes_over_frames_that_are_too_old) {
  CountingSource source(1000, false);
  ReadAhead frames(source, 2, 0);
  frames.next();
  frames.pass_over(500);
  std::uint64_t passed_over = 0, read = 1, last_seq = 0;
  while (const std::optional<ReadItem> item = frames.next()) {
    passed_over += item->passed_over;
    if (!item->frame) break;
    ++read;
    last_seq = item->frame->image.seq;
  }
  EXPECT_EQ(last_seq, 999U);
  EXPECT_EQ(read + passed_over, 1000U) << "every frame is either read or counted";
  EXPECT_GE(passed_over, 490U);
}

TEST(ReadAhead, stops_at_the_limit) {
  CountingSource source(20, false);
  ReadAhead frames(source, 2, 3);
  int count = 0;
  while (frames.next()->frame) ++count;
  EXPECT_EQ(count, 3);
}

TEST(ReadAhead, counts_what_it_passed_over_against_the_limit) {
  CountingSource source(1000, false);
  ReadAhead frames(source, 2, 10);
  frames.pass_over(500);
  std::uint64_t read = 0, passed_over = 0;
  for (std::optional<ReadItem> item = frames.next();; item = frames.next()) {
    passed_over += item->passed_over;
    if (!item->frame) break;
    ++read;
  }
  EXPECT_EQ(read + passed_over, 10U);
}

TEST(ReadAhead, reports_a_failing_source) {
  CountingSource source(1, true);
  ReadAhead frames(source, 2, 0);
  EXPECT_TRUE(frames.next()->frame);
  EXPECT_EQ(frames.next()->error, "the disk went away");
}

TEST(ReadAhead, ends_while_its_queue_is_full) {
  CountingSource source(1'000'000, false);
  const auto ended = std::async(std::launch::async, [&source] { const ReadAhead frames(source, 2, 0); });
  EXPECT_EQ(ended.wait_for(std::chrono::seconds(10)), std::future_status::ready);
}

}  // namespace
}  // namespace rtd::camera
