// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "services/evaluation/detector/eval_detector_command.hpp"
#include "tests/support/detector/mask_network.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::eval {
namespace {

using rtd::test::read_text;
using rtd::test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct DetectorOutcome {
  int code = -1;
  std::string out, err;
};

/// Two images of 64 x 64 px, each with one white cell of 8 px that the tiny network sees as a person of 10 x 13 px.
class EvalDetectorCommand : public testing::Test {
 protected:
  EvalDetectorCommand() {
    for (const char* name : {"images", "labels", "masks"}) std::filesystem::create_directory(folder_.path() / name);
    write_image("a.png");
    write_image("b.png");
    folder_.write("labels/a.txt", "0 0.6875 0.4375 0.15625 0.203125\n");  // centre 44, 28: exactly the box
    folder_.write("labels/b.txt", "0 0.6875 0.4375 0.15625 0.203125\n0 0.1 0.1 0.1 0.1\n");
    folder_.write("tiny.onnx", test::tiny_network_onnx({.metadata = {{"rtd.class_names", "person\nbox"}}}));
  }
  void write_image(const std::string& name) const {
    cv::Mat image = cv::Mat::zeros(64, 64, CV_8UC3);
    image(cv::Rect(40, 24, 8, 8)).setTo(cv::Scalar::all(255));
    cv::imwrite(folder_.file("images/" + name), image);
  }
  void write_mask(const std::string& name, cv::Size size = {64, 64}) const {
    cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
    mask(cv::Rect(40, 22, 8, 12)).setTo(255);
    cv::imwrite(folder_.file("masks/" + name), mask);
  }
  DetectorOutcome run(std::vector<std::string> arguments) const {
    CLI::App app;
    EvalDetectorOptions options;
    add_eval_detector_command(app, options);
    arguments.insert(arguments.begin(),
                     {"detector", "--model", folder_.file("tiny.onnx"), "--images", folder_.file("images")});
    std::reverse(arguments.begin(), arguments.end());
    std::ostringstream out, err;
    try {
      app.parse(arguments);
    } catch (const CLI::ParseError& error) {
      return {2, "", error.what()};
    }
    const int code = run_eval_detector(options, out, err);
    return {code, out.str(), err.str()};
  }
  DetectorOutcome run_on_labels(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"--labels", folder_.file("labels"), "--json", folder_.file("out.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  nlohmann::json json() const { return nlohmann::json::parse(read_text(folder_.path() / "out.json")); }

  TemporaryFolder folder_;
};

TEST_F(EvalDetectorCommand, prints_and_writes_the_average_precision) {
  const DetectorOutcome outcome = run_on_labels();

  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("tiny.onnx"), HasSubstr("64x64"), HasSubstr("best F1")));
  const auto model = json()["models"][0];
  EXPECT_NEAR(model["ap50"], 67.0 / 101, 1e-6);  // two of three found, nothing wrong
  EXPECT_NEAR(model["ap50_95"], 67.0 / 101, 1e-6);
  EXPECT_EQ(model["levels"]["high"]["objects"], 3);
  EXPECT_NEAR(model["levels"]["high"]["best_f1"]["f1"], 0.8, 1e-6);
  EXPECT_TRUE(model["levels"]["high"]["wanted_recall"]["threshold"] > 0.9);
  EXPECT_GT(model["median_ms"], 0);
  EXPECT_EQ(model["levels"]["high"]["curve"].size(), 99U);
}

TEST_F(EvalDetectorCommand, compares_models) {
  folder_.write("other.onnx", test::tiny_network_onnx({.metadata = {{"rtd.class_names", "box\nperson"}}}));
  const DetectorOutcome outcome =
      run_on_labels({"--model", folder_.file("other.onnx"), "--names", folder_.write("names.txt", "person\nbox\n")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(json()["models"].size(), 2U);
  EXPECT_EQ(json()["models"][1]["ap50"], json()["models"][0]["ap50"]);  // both by the given names
}

TEST_F(EvalDetectorCommand, compares_engines) {
  const DetectorOutcome outcome = run_on_labels({"--engine", "cpu,auto"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("tiny.onnx, auto"), HasSubstr("2 of 2 images")));
  const auto models = json()["models"];
  ASSERT_EQ(models.size(), 2U);
  EXPECT_EQ(models[0]["device"], "CPU (OpenCV DNN)");
  EXPECT_FALSE(models[0].contains("agreement"));
  EXPECT_EQ(models[1]["engine"], "auto");
  EXPECT_EQ(models[1]["agreement"]["agreeing"], 2);
  EXPECT_NEAR(models[1]["ap50"], models[0]["ap50"], 1e-3);
}

TEST_F(EvalDetectorCommand, says_nothing_of_other_engines_when_only_the_cpu_is_asked_for) {
  EXPECT_THAT(run_on_labels().out, AllOf(Not(HasSubstr("same boxes")), Not(HasSubstr("tiny.onnx,"))));
}

TEST_F(EvalDetectorCommand, refuses_engines_that_are_not_there) {
  const DetectorOutcome wrong = run_on_labels({"--engine", "gpu"}),
                        absent = run_on_labels({"--engine", "onnxruntime:/nowhere.so"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--engine: 'gpu' is not an engine: use "));
  EXPECT_EQ(absent.code, 2);
  EXPECT_THAT(absent.err, HasSubstr("ONNX Runtime"));
}

TEST_F(EvalDetectorCommand, reads_voc_labels_by_itself) {
  std::filesystem::remove_all(folder_.path() / "labels");
  std::filesystem::create_directory(folder_.path() / "labels");
  folder_.write("labels/a.xml",
                "<annotation><object><name>person</name><bndbox><xmin>40</xmin><ymin>22</ymin><xmax>49</xmax>"
                "<ymax>34</ymax></bndbox></object></annotation>");
  const DetectorOutcome outcome = run_on_labels();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(json()["label_format"], "voc");
  EXPECT_NEAR(json()["models"][0]["ap50"], 1, 1e-6);
  EXPECT_EQ(json()["input"]["without_partner"], 1);  // b.png: no file, no objects, so its box is wrong but comes later
}

TEST_F(EvalDetectorCommand, counts_and_says_what_is_wrong_and_continues) {
  write_image("c.png");
  folder_.write("images/d.png", "no image");
  folder_.write("labels/b.txt", "0 0.5\n7 0.5 0.5 0.1 0.1\n");
  const DetectorOutcome outcome = run_on_labels();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("3 images, 1 without label file"), HasSubstr("1 left out"),
                                 HasSubstr("d.png: is not an image"), HasSubstr("b.txt:1: 2 columns"),
                                 HasSubstr("b.txt:2: class '7'")));
  EXPECT_EQ(json()["input"]["problems"].size(), 3U);
}

TEST_F(EvalDetectorCommand, refuses_folders_with_nothing_to_evaluate) {
  EXPECT_THAT(run({"--labels", folder_.file("nowhere")}).err, HasSubstr("nowhere: there is no such folder"));
  EXPECT_THAT(run({"--labels", folder_.file("masks")}).err, HasSubstr("neither .txt (YOLO) nor .xml"));
  EXPECT_THAT(run({}).err, HasSubstr("add --labels DIR"));
  folder_.write("labels/z.xml", "");
  EXPECT_THAT(run_on_labels().err, HasSubstr("add --label-format"));
  for (const char* name : {"labels/a.txt", "labels/b.txt"}) folder_.write(name, "");
  EXPECT_THAT(run_on_labels({"--label-format", "yolo"}).err, HasSubstr("no object in it can be used"));
  std::filesystem::rename(folder_.path() / "labels/a.txt", folder_.path() / "labels/y.txt");
  std::filesystem::remove(folder_.path() / "labels/b.txt");
  const DetectorOutcome outcome = run_on_labels({"--label-format", "yolo"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no file in it has the name of an image"));
  std::filesystem::remove_all(folder_.path() / "images");
  std::filesystem::create_directory(folder_.path() / "images");
  EXPECT_THAT(run_on_labels({"--label-format", "yolo"}).err, HasSubstr("has no images"));
}

TEST_F(EvalDetectorCommand, refuses_models_and_outputs_that_cannot_be_used) {
  EXPECT_THAT(run_on_labels({"--model", "/nowhere/x.onnx"}).err, HasSubstr("/nowhere/x.onnx"));
  EXPECT_EQ(run_on_labels({"--model", folder_.write("bad.onnx", "<html>")}).code, 2);
  EXPECT_THAT(run_on_labels({"--names", folder_.file("none.txt")}).err, HasSubstr("none.txt: is missing or empty"));
  EXPECT_THAT(run({"--labels", folder_.file("labels"), "--json", "/proc/none/a.json"}).err,
              HasSubstr("--json /proc/none"));
  EXPECT_EQ(run_on_labels({"--masks", folder_.file("masks")}).code, 2);
}

TEST_F(EvalDetectorCommand, measures_recall_on_masks_by_roll) {
  write_mask("a.png");
  write_mask("b.png", {64, 50});
  const DetectorOutcome outcome =
      run({"--masks", folder_.file("masks"), "--roll", "0:180:90", "--json", folder_.file("out.json")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("1 images, 1 left out"), HasSubstr("b.png: is 64 x 50 px")));
  const auto model = json()["models"][0];
  ASSERT_EQ(model["as_seen"].size(), 3U);
  EXPECT_EQ(model["as_seen"][0]["pixel_recall"], 1);
  EXPECT_LT(model["as_seen"][1]["pixel_recall"], 0.9);  // the box stands across the lying mask
}

TEST_F(EvalDetectorCommand, takes_dark_masks_and_other_classes) {
  write_mask("a.png");
  cv::Mat mask = cv::imread(folder_.file("masks/a.png"), cv::IMREAD_GRAYSCALE);
  cv::imwrite(folder_.file("masks/a.png"), 255 - mask);
  const std::vector<std::string> arguments = {"--masks", folder_.file("masks"), "--dark-masks", "--json",
                                              folder_.file("out.json")};
  EXPECT_EQ(run(arguments).code, 0);
  EXPECT_EQ(json()["models"][0]["as_seen"][0]["pixel_recall"], 1);
  std::vector<std::string> other = arguments;
  other.insert(other.end(), {"--class", "box"});
  EXPECT_EQ(run(other).code, 0);
  EXPECT_EQ(json()["models"][0]["as_seen"][0]["pixel_recall"], 0);
}

TEST_F(EvalDetectorCommand, measures_the_masks_of_another_network_inside_the_boxes) {
  const std::string network = test::mask_network();
  if (network.empty()) GTEST_SKIP() << "no network for masks: deploy/setup.sh --models";
  write_mask("a.png");
  const DetectorOutcome outcome =
      run({"--masks", folder_.file("masks"), "--mask-model", network, "--json", folder_.file("out.json")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("mask IoU"));
  EXPECT_NEAR(json()["models"][0]["masks"][0]["box_precision"], 96.0 / 140, 0.05);
}

TEST_F(EvalDetectorCommand, refuses_a_network_for_masks_that_is_none) {
  write_mask("a.png");
  const std::string masks = folder_.file("masks"), tiny = folder_.file("tiny.onnx");
  EXPECT_THAT(run({"--masks", masks, "--mask-model", tiny}).err, HasSubstr("is not a network for masks"));
  EXPECT_THAT(run({"--masks", masks, "--mask-model", "/nowhere/x.onnx"}).err, HasSubstr("/nowhere/x.onnx"));
  EXPECT_THAT(run({"--masks", masks, "--class", "box", "--mask-model", tiny}).err, HasSubstr("--mask-model needs"));
  EXPECT_THAT(run_on_labels({"--mask-model", tiny}).err, HasSubstr("--mask-model needs --masks"));
}

TEST_F(EvalDetectorCommand, refuses_a_roll_that_is_none) {
  write_mask("a.png");
  for (const std::string roll : {"x", "0:180", "180:0:15", "0:180:0", "0:1e9:15", "0:180:15:7"}) {
    EXPECT_EQ(run({"--masks", folder_.file("masks"), "--roll", roll}).code, 2) << roll;
  }
}

}  // namespace
}  // namespace rtd::eval
