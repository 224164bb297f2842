// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/read_ahead.hpp"

#include <gmock/gmock.h>

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
    return frame;
  }
  const SourceInfo& info() const override { return info_; }
  const SourceCounters& counters() const override { return counters_; }
  std::vector<StampedPose> groundtruth() const override { return {}; }
  std::vector<SkippedInput> take_skipped() override { return {{SkipReason::kMalformedLine, "a line"}}; }

 private:
  std::uint64_t frames_;
  bool fails_;
  SourceInfo info_;
  SourceCounters counters_;
};

TEST(ReadAhead, HandsOverEveryFrameInOrderThenTheEnd) {
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

TEST(ReadAhead, StopsAtTheLimit) {
  CountingSource source(20, false);
  ReadAhead frames(source, 2, 3);
  int count = 0;
  while (frames.next()->frame) ++count;
  EXPECT_EQ(count, 3);
}

TEST(ReadAhead, ReportsAFailingSource) {
  CountingSource source(1, true);
  ReadAhead frames(source, 2, 0);
  EXPECT_TRUE(frames.next()->frame);
  EXPECT_EQ(frames.next()->error, "the disk went away");
}

TEST(ReadAhead, EndsWhileItsQueueIsFull) {
  CountingSource source(1'000'000, false);
  const auto ended = std::async(std::launch::async, [&source] { const ReadAhead frames(source, 2, 0); });
  EXPECT_EQ(ended.wait_for(std::chrono::seconds(10)), std::future_status::ready);
}

}  // namespace
}  // namespace rtd::camera
