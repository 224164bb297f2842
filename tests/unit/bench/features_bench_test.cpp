// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/features_bench.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/camera/source_factory.hpp"

namespace rtd::bench {
namespace {

using testing::Each;
using testing::Gt;
using testing::HasSubstr;
using testing::SizeIs;

TEST(FeaturesBench, measures_both_on_every_frame) {
  const auto source = camera::make_source("synthetic:office?frames=5");
  FeaturesOptions options;
  options.frames = 4;
  options.features = 500;
  std::uint64_t reported = 0;
  const FeaturesResult result = bench_features(*source, options, [&](std::uint64_t done) { reported = done; });
  EXPECT_EQ(reported, 4U);
  EXPECT_EQ(result.width, 640);
  for (const ExtractorTimes* times : {&result.own, &result.opencv}) {
    EXPECT_THAT(times->wall_ms, SizeIs(4));
    EXPECT_THAT(times->cpu_ms, Each(Gt(0.0)));
    EXPECT_THAT(times->found, Each(Gt(300)));
    EXPECT_THAT(times->spread, Each(Gt(0.05)));
  }
  const auto json = nlohmann::json::parse(features_json(result, options, "office"));
  EXPECT_EQ(json["frames"], 4);
  EXPECT_EQ(json["rtd_slam"]["wall_ms"]["p50"], percentile(result.own.wall_ms, 50));
  EXPECT_THAT(features_table(result, options, "office"), HasSubstr("cv::ORB"));
}

TEST(FeaturesBench, percentiles_are_samples) {
  EXPECT_EQ(percentile({5, 1, 3}, 50), 3);
  EXPECT_EQ(percentile({5, 1, 3}, 100), 5);
  EXPECT_EQ(percentile({}, 50), 0);
}

TEST(FeaturesBench, a_source_without_frames_is_an_error) {
  const auto source = camera::make_source("synthetic:office?frames=1");
  source->next();
  EXPECT_THROW(bench_features(*source, {}, [](std::uint64_t) {}), camera::SourceError);
}

}  // namespace
}  // namespace rtd::bench
