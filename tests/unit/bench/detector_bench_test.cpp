// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/detector/detector_bench.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "services/detector/core/engine.hpp"
#include "tests/bench/rtd_bench/detector/detector_command.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::bench {
namespace {

using namespace ::testing;

/// Three images of 64 x 64 px, each with one white cell that the tiny network sees as a person.
class DetectorBench : public testing::Test {
 protected:
  DetectorBench() {
    std::filesystem::create_directory(folder_ / "images");
    for (int i = 0; i < 3; ++i) {
      images_.push_back(cv::Mat::zeros(64, 64, CV_8UC3));
      images_.back()(cv::Rect(8 * i, 24, 8, 8)).setTo(cv::Scalar::all(255));
    }
    options_.batches = {1, 4};
    options_.model_path = folder_.write("free.onnx", test::tiny_network_onnx({.free_batch = true, .metadata = names_}));
  }
  DetectorComparison compare() const {
    return bench_detector(images_, options_, [] {});
  }
  struct Outcome {
    int code = -1;
    std::string out, err;
  };
  Outcome run(std::vector<std::string> arguments) const {
    CLI::App app;
    DetectorRequest request;
    add_detector_command(app, request);
    arguments.insert(arguments.begin(), {"detector", "--model", options_.model_path});
    std::reverse(arguments.begin(), arguments.end());
    app.parse(arguments);
    std::ostringstream out, err;
    const int code = run_detector(app, request, out, err).value_or(-1);
    return {code, out.str(), err.str()};
  }

  const rtd::test::TemporaryFolder folder_;
  const std::map<std::string, std::string> names_ = {{"rtd.class_names", "person\nbox"}};
  std::vector<cv::Mat> images_;
  DetectorOptions options_;
};

TEST_F(DetectorBench, measures_every_engine_with_every_batch) {
  options_.engines = {"cpu", "auto"};
  std::size_t batches = 0;
  const DetectorComparison comparison = bench_detector(images_, options_, [&] { ++batches; });
  EXPECT_EQ(batches, batches_of(images_.size(), options_));
  ASSERT_THAT(comparison.cases, SizeIs(4));
  for (const DetectorResult& result : comparison.cases) {
    EXPECT_THAT(result.failure, IsEmpty());
    EXPECT_THAT(result.batch_ms, AllOf(SizeIs(5), Each(Gt(0.0)))) << "the first one is not counted";
    EXPECT_GT(result.cpu_ms_per_image, 0);
    EXPECT_EQ(result.same.images, 3U) << "each image once";
    EXPECT_EQ(result.same.agreeing, 3U) << result.same.first_difference;
    EXPECT_EQ(result.boxes, 3U);
  }
  EXPECT_EQ(comparison.cases[1].what.engine, "auto");
  EXPECT_EQ(comparison.cases[2].what.batch, 4);
}

TEST_F(DetectorBench, speaks_of_one_image_whatever_the_batch) {
  DetectorResult result;
  result.what = {"cpu", 4};
  result.batch_ms = {40, 40, 80};
  EXPECT_DOUBLE_EQ(result.ms_per_image(), 10);
  EXPECT_DOUBLE_EQ(result.images_per_s(), 75);
}

TEST_F(DetectorBench, an_engine_that_is_not_there_is_a_failure_of_its_cases) {
  options_.engines = {"onnxruntime:/nowhere.so", "cpu"};
  options_.batches = {1};
  const DetectorComparison comparison = compare();
  EXPECT_THAT(comparison.cases[0].failure, HasSubstr("ONNX Runtime"));
  EXPECT_THAT(comparison.cases[1].batch_ms, SizeIs(5));
  EXPECT_THAT(detector_table(comparison), HasSubstr("ONNX Runtime"));
  const auto json = nlohmann::json::parse(detector_json(comparison));
  EXPECT_THAT(json["cases"][0]["failure"].get<std::string>(), HasSubstr("ONNX Runtime"));
  EXPECT_EQ(json["cases"][1]["agreement"]["agreeing"], 3);
}

TEST_F(DetectorBench, a_network_of_one_image_gives_figures_for_one_and_says_how_to_free_it) {
  options_.model_path = folder_.write("fixed.onnx", test::tiny_network_onnx({.metadata = names_}));
  const DetectorComparison comparison = compare();
  EXPECT_THAT(comparison.cases[0].failure, IsEmpty());
  EXPECT_THAT(comparison.cases[1].failure, HasSubstr("--free-batch"));
}

TEST_F(DetectorBench, refuses_what_gives_no_figures_at_all) {
  EXPECT_THROW(bench_detector({}, options_, [] {}), std::invalid_argument);
  options_.engines = {"gpu"};
  EXPECT_THROW(compare(), detector::EngineError);
  options_.engines = {"cpu"};
  options_.model_path = folder_.write("broken.onnx", "<html>");
  EXPECT_THROW(compare(), detector::ModelError);
}

TEST_F(DetectorBench, the_command_writes_table_and_json) {
  cv::imwrite(folder_.file("images/a.png"), images_[0]);
  folder_.write("images/notes.txt", "no image");
  const std::string json = folder_.file("out.json");
  const Outcome outcome = run({"--images", folder_.file("images"), "--batch", "1,2", "--json", json});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("free.onnx, 64x64, 1 image,"), HasSubstr("1 of 1")));
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(json))["cases"][1]["batch"], 2);
}

TEST_F(DetectorBench, the_command_names_what_is_wrong) {
  EXPECT_EQ(run({"--engines", "gpu"}).code, 2);
  EXPECT_THAT(run({"--images", "/nowhere"}).err, HasSubstr("--images /nowhere: there is no such folder"));
  EXPECT_THAT(run({"--images", folder_.file("images")}).err, HasSubstr("has no images"));
  const Outcome unwritable = run({"--json", "/nowhere/out.json"});
  EXPECT_EQ(unwritable.code, 2);
  EXPECT_THAT(unwritable.err, HasSubstr("--json /nowhere/out.json: cannot be written"));
  EXPECT_EQ(run({"--engines", "onnxruntime:/nowhere.so", "--frames", "1"}).code, 1);
}

TEST_F(DetectorBench, serves_robots_with_every_engine_and_batch) {
  cv::imwrite(folder_.file("images/a.png"), images_[0]);
  const Outcome done = run({"--images", folder_.file("images"), "--robots", "3", "--batch", "1,4", "--rate", "20",
                            "--seconds", "0.5", "--json", folder_.file("robots.json")});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("robots that send 20 JPEG images a second each"));
  std::ifstream file(folder_ / "robots.json");
  const auto cases = nlohmann::json::parse(file)["robots"];
  ASSERT_THAT(cases, SizeIs(2));
  for (const auto& result : cases) {
    EXPECT_EQ(result["robots"], 3);
    EXPECT_NEAR(result["answered_hz"]["least"].get<double>(), 20, 6);
    EXPECT_GT(result["latency_ms"]["p50"].get<double>(), 0);
    EXPECT_NEAR(result["images_per_s"].get<double>(), 60, 18);
    EXPECT_GT(result["cpu_percent"].get<double>(), 0);
  }
  EXPECT_EQ(cases[1]["batch"], 4);
}

TEST_F(DetectorBench, names_engines_without_libraries) {
  EXPECT_EQ(detector::engine_label("cpu"), "cpu");
  EXPECT_EQ(detector::engine_label("onnxruntime:/opt/ort/lib/libonnxruntime.so"), "onnxruntime");
  EXPECT_EQ(detector::engine_label("onnxruntime:lib/libonnxruntime.so@cuda:1"), "onnxruntime@cuda:1");
}

TEST_F(DetectorBench, says_which_engines_serve_no_robots) {
  options_.engines = {"onnxruntime:/nowhere.so"};
  const std::vector<FleetResult> results = bench_fleet(images_, options_, {.robots = {1}}, [] {});
  ASSERT_THAT(results, SizeIs(2));
  EXPECT_THAT(results[0].failure, HasSubstr("ONNX Runtime"));
  EXPECT_THAT(fleet_table(results, {}), HasSubstr("ONNX Runtime"));
}

}  // namespace
}  // namespace rtd::bench
