// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <map>

#include "common/service/config.hpp"
#include "common/service/model_locator.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::service {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::string kUsualFile = kKnownModels.front().file;

class ModelLocator : public ::testing::Test {
 protected:
  std::string make(const std::string& relative) const { return folder_.write(relative, "weights"); }
  std::string in_folder(const std::string& relative) const { return folder_.file(relative); }
  EnvironmentReader environment(std::map<std::string, std::string> values) const {
    values.emplace("XDG_DATA_DIRS", in_folder("local") + ":" + in_folder("share"));  // not those of this host
    return [values = std::move(values)](const std::string& name) -> std::optional<std::string> {
      const auto found = values.find(name);
      return found == values.end() ? std::nullopt : std::optional<std::string>(found->second);
    };
  }
  EnvironmentReader all() const {
    return environment(
        {{"RTD_MODEL_DIR", in_folder("models")}, {"XDG_CACHE_HOME", in_folder("xdg")}, {"HOME", in_folder("home")}});
  }
  const rtd::test::TemporaryFolder folder_;
};

TEST_F(ModelLocator, looks_in_the_model_folder_the_cache_and_the_folders_for_all_users_in_this_order) {
  const EnvironmentReader only_home = environment({{"HOME", in_folder("home")}, {"XDG_CACHE_HOME", ""}});
  const std::string second = make("share/rtd-slam/models/" + kUsualFile);
  EXPECT_EQ(find_model("", environment({})).path, second);
  const std::string first = make("local/rtd-slam/models/" + kUsualFile);
  EXPECT_EQ(find_model("", environment({})).path, first);
  const std::string at_home = make("home/.cache/rtd-slam/" + kUsualFile);
  EXPECT_EQ(find_model("", only_home).path, at_home);
  const std::string cached = make("xdg/rtd-slam/" + kUsualFile);
  EXPECT_EQ(find_model("", all()).path, cached);
  const std::string in_model_folder = make("models/" + kUsualFile);
  EXPECT_EQ(find_model("", all()).path, in_model_folder);
}

TEST_F(ModelLocator, finds_another_file_name_in_the_same_folders_and_takes_a_path_as_it_is) {
  make("models/" + kUsualFile);
  const std::string named = make("models/mine.onnx"), elsewhere = make("elsewhere/mine.onnx");
  EXPECT_EQ(find_model("mine.onnx", all()).path, named);
  EXPECT_EQ(find_model(elsewhere, all()).path, elsewhere);
}

TEST_F(ModelLocator, does_not_fall_back_when_the_configured_path_is_missing) {
  make(std::string("models/") + kUsualFile);
  const ModelSearch search = find_model(in_folder("missing.onnx"), all());
  EXPECT_FALSE(search);
  EXPECT_THAT(search.message, AllOf(HasSubstr("missing.onnx"), HasSubstr("deploy/setup.sh --models")));
}

TEST_F(ModelLocator, says_where_it_looked_and_what_to_run) {
  const ModelSearch search = find_model("", all());
  EXPECT_FALSE(search);
  EXPECT_THAT(search.message, AllOf(HasSubstr(in_folder("models")), HasSubstr(in_folder("xdg")),
                                    HasSubstr("deploy/setup.sh --models"), HasSubstr("RTD_MODEL_DIR")));
}

TEST_F(ModelLocator, does_not_take_a_folder_for_a_file) {
  std::filesystem::create_directories(folder_ / "models" / kUsualFile);
  EXPECT_FALSE(find_model("", all()));
}

TEST_F(ModelLocator, works_without_any_environment) {
  EXPECT_THAT(find_model("", environment({})).message, HasSubstr("deploy/setup.sh --models"));
}

TEST_F(ModelLocator, takes_the_first_of_the_usual_networks_and_none_under_the_gpl) {
  make("models/v5lite-s-raw-480x640.onnx");
  EXPECT_FALSE(find_model("", all()));
  const std::string second = make("models/nanodet_g.onnx");
  EXPECT_EQ(find_model("", all()).path, second);
  const std::string first = make("models/permissive/yolox_nano.onnx");
  EXPECT_EQ(find_model("yolox-nano", all()).path, first);
}

TEST_F(ModelLocator, finds_a_known_network_by_its_name) {
  const std::string paper = make("xdg/rtd-slam/v5lite-s-raw-480x640.onnx");
  EXPECT_EQ(find_model("yolov5-lite", all()).path, paper);
  EXPECT_THAT(find_model("nanodet-g", all()).message,
              AllOf(HasSubstr("nanodet_g.onnx"), HasSubstr("`deploy/setup.sh --models`")));
  EXPECT_THAT(find_model("yolov5-lite", environment({})).message,
              HasSubstr("deploy/setup.sh --models --model yolov5-lite"));
}

TEST(ModelTable, names_weights_and_licence) {
  EXPECT_EQ(describe_model("/any/where/yolox_nano.onnx"), "YOLOX-nano, Apache-2.0");
  EXPECT_EQ(describe_model("v5lite-s-raw-480x640.onnx"), "YOLOv5-Lite s, GPL-3.0");
  EXPECT_EQ(describe_model("a/selfie_segmentation.onnx"), "MediaPipe Selfie Segmentation, Apache-2.0");
  EXPECT_EQ(describe_model("mine/own.onnx"), "own.onnx, licence not known");
}

TEST_F(ModelLocator, finds_the_network_for_masks_in_the_same_folders) {
  EXPECT_FALSE(find_mask_model("auto", "", all()));
  EXPECT_THAT(find_mask_model("auto", "", all()).message,
              AllOf(HasSubstr("selfie_segmentation.onnx"), HasSubstr(in_folder("models")), HasSubstr("setup.sh")));
  const std::string expected = make(std::string("xdg/rtd-slam/") + kMaskModel.file);
  EXPECT_EQ(find_mask_model("auto", "", all()).path, expected);
  EXPECT_EQ(find_mask_model("on", kMaskModel.name, all()).path, expected);
  EXPECT_EQ(find_mask_model("off", kMaskModel.name, all()).path, "");
  EXPECT_EQ(describe_model(expected), "MediaPipe Selfie Segmentation, Apache-2.0");
}

TEST_F(ModelLocator, a_network_for_masks_that_is_asked_for_must_be_there) {
  EXPECT_THAT([&] { find_mask_model("on", "", all()); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("selfie_segmentation.onnx"), HasSubstr("--masks off"))));
  EXPECT_THAT([&] { find_mask_model("auto", "/nowhere/mine.onnx", all()); },
              ThrowsMessage<ConfigError>(HasSubstr("detector.mask_model is '/nowhere/mine.onnx', which is no file")));
}

namespace fs = std::filesystem;

class OnnxruntimeLocator : public ::testing::Test {
 protected:
  std::string make(const std::string& relative) const { return folder_.write(relative, "library"); }
  std::string find(const std::string& named = {}) const {
    return find_onnxruntime([&](const std::string&) { return std::optional(named); },
                            {folder_ / "missing", folder_ / "first", folder_ / "second"});
  }
  const rtd::test::TemporaryFolder folder_;
};

TEST_F(OnnxruntimeLocator, finds_none_where_there_is_none) {
  make("first/libonnxruntime_providers_shared.so");
  fs::create_directories(folder_ / "second/libonnxruntime.so");
  EXPECT_EQ(find(), "");
}

TEST_F(OnnxruntimeLocator, takes_the_first_folder_that_has_it) {
  make("second/libonnxruntime.so");
  const std::string first = make("first/libonnxruntime.so");
  EXPECT_EQ(find(), first);
}

TEST_F(OnnxruntimeLocator, takes_the_newest_of_those_with_a_version) {
  make("first/libonnxruntime.so.1.9.0");
  const std::string newest = make("first/libonnxruntime.so.1.21");
  make("first/libonnxruntime.so.1.20.1");
  EXPECT_EQ(find(), newest);
}

TEST_F(OnnxruntimeLocator, takes_what_the_environment_names_as_it_is) {
  make("first/libonnxruntime.so");
  EXPECT_EQ(find("/opt/mine.so"), "/opt/mine.so");
}

}  // namespace
}  // namespace rtd::service
