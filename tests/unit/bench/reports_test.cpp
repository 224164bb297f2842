// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/camera/open/source_factory.hpp"
#include "tests/bench/rtd_bench/features_bench.hpp"
#include "tests/bench/rtd_bench/transport/transport_bench.hpp"

namespace rtd::bench {
namespace {

using namespace ::testing;

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

TransportResult measured() {
  TransportResult result;
  result.what = {"fastdds", Path::kSharing, Payload::kFrame};
  result.publisher = {1'536'120, {100, 100, 100}, 0.7, 2000, 0};
  result.subscriber = {{200, 250, 900}, 0.6};
  return result;
}

TEST(Transport, measures_only_what_a_path_can_carry) {
  TransportOptions options;
  options.vendors = {"fastdds", "cyclonedds"};
  const auto cases = transport_cases(options);
  const auto count = [&](Path path, Payload payload) {
    return std::count_if(cases.begin(), cases.end(),
                         [&](const auto& what) { return what.path == path && what.payload == payload; });
  };
  EXPECT_EQ(count(Path::kSharing, Payload::kFrame), 1);
  EXPECT_EQ(count(Path::kSharing, Payload::kJpeg), 0) << "of variable size";
  EXPECT_EQ(count(Path::kUdp, Payload::kPose), 2) << "both vendors";
}

TEST(Transport, names_are_read_back) {
  for (const Path path : {Path::kSharing, Path::kSharedMemory, Path::kUdp}) {
    EXPECT_EQ(parse_path(to_string(path)), path);
  }
  EXPECT_EQ(parse_payload("jpeg"), Payload::kJpeg);
  EXPECT_FALSE(parse_payload("video"));
}

TEST(Transport, table_and_json_report_the_ratio_to_memcpy_and_the_failure) {
  std::vector<TransportResult> results(2, measured());
  results[1].failure = "no such interface";
  TransportOptions options;
  options.messages = 3;
  const std::string table = transport_table(results, options);
  EXPECT_THAT(table, HasSubstr("2.5x"));
  EXPECT_THAT(table, HasSubstr("no such interface"));
  const auto json = nlohmann::json::parse(transport_json(results, options));
  EXPECT_EQ(json["cases"][0]["latency_us"]["p50"], 250);
  EXPECT_EQ(json["cases"][1]["failure"], "no such interface");
}

TEST(Transport, the_table_says_what_never_came) {
  TransportOptions options;
  options.messages = 5;
  EXPECT_THAT(transport_table({measured()}, options), HasSubstr("2 of 5 never came"));
}

}  // namespace
}  // namespace rtd::bench
