// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/io/byte_sink.hpp"
#include "common/mcap/writer.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/component/recorder/recorded_file.hpp"
#include "tests/support/people_messages.hpp"

namespace rtd::launcher {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kScene = "synthetic:static?frames=4&width=64&height=48";

/// `rtd convert` as a user meets it; the pixels are the business of tests/unit/camera.
class ConvertTest : public testing::Test {
 protected:
  ScratchFolder scratch_;

  /// The exit code; what it said is in output_.
  int convert(std::vector<std::string> arguments) {
    RtdCommand rtd;
    arguments.insert(arguments.begin(), "convert");
    const int code = rtd.run(arguments);
    output_ = rtd.output();
    return code;
  }
  std::string output_;
};

TEST_F(ConvertTest, helps_and_documents_its_exit_codes) {
  EXPECT_EQ(convert({"--help"}), 0);
  EXPECT_THAT(output_, AllOf(HasSubstr("FILE.bag"), HasSubstr("tum:FOLDER or FILE.mcap"), HasSubstr("--compress"),
                             HasSubstr("Exit codes:")));
}

TEST_F(ConvertTest, goes_to_mcap_and_back) {
  const std::string file = scratch_ / "x.mcap", folder = scratch_ / "tum";
  EXPECT_EQ(convert({kScene, file}), 0);
  EXPECT_THAT(output_, HasSubstr("4 frames written to " + file));
  EXPECT_FALSE(fs::exists(file + ".partial"));
  EXPECT_EQ(convert({file, folder, "--frames", "3"}), 0);
  EXPECT_EQ(text_of(folder + "/associations.txt").find("rgb/"), text_of(folder + "/associations.txt").find(" ") + 1);
  EXPECT_THAT(text_of(folder + "/groundtruth.txt"), HasSubstr("\n"));
}

TEST_F(ConvertTest, carries_every_topic_of_a_recording) {
  const std::string file = scratch_ / "x.mcap", copy = scratch_ / "y.mcap";
  EXPECT_EQ(convert({kScene, file}), 0);
  EXPECT_EQ(convert({file, copy, "--compress", "none"}), 0) << output_;
  EXPECT_THAT(output_, HasSubstr("16 messages of 4 topics written to " + copy));
  EXPECT_EQ(convert({file, copy}), 2);
  EXPECT_THAT(output_, HasSubstr(copy + " exists"));
}

/// A recording of a frame with a person, and of the detector's boxes or not.
void record_person(const std::string& path, bool detected) {
  io::FileSink sink(path);
  mcap::Writer writer(sink);
  const auto add = [&](const char* topic, const char* type, const std::vector<std::uint8_t>& cdr) {
    const auto channel = writer.add(mcap::Channel{0, writer.add(mcap::Schema{0, type, "", ""}), topic, "cdr", {}});
    writer.write(mcap::Message{channel, 1, 1, 1, std::as_bytes(std::span(cdr))});
  };
  add("rtd/frame", "rtd_msgs::msg::dds_::RgbdFrame_",
      test_support::frame_cdr(1'000'000'000, test_support::room_with_person()));
  if (detected)
    add("/detector/detections", "vision_msgs/msg/Detection2DArray",
        test_support::cdr_of(test_support::detections(1'000'000'000, {test_support::kPerson})));
  writer.close();
}

TEST_F(ConvertTest, takes_people_out_of_a_recording_with_detections) {
  const std::string file = scratch_ / "walk.mcap", shared = scratch_ / "shared.mcap";
  record_person(file, true);
  EXPECT_EQ(convert({file, shared, "--blur-people", "--compress", "none"}), 0) << output_;
  EXPECT_THAT(output_, HasSubstr("people are pixelated in 1 images"));
  const std::vector<std::byte> cdr = recorder::read_recording(shared).topics.at("rtd/frame").at(0).cdr;
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(cdr.data());
  const cv::Mat room = test_support::room_with_person();
  EXPECT_LT(test_support::likeness(room, test_support::colors_of({bytes, bytes + cdr.size()})), 0.5);
  EXPECT_EQ(convert({shared, scratch_ / "tum", "--blur-people"}), 2);
  EXPECT_THAT(output_, HasSubstr("then convert that"));
}

TEST_F(ConvertTest, without_detections_it_says_how_to_get_them_and_writes_nothing) {
  const std::string file = scratch_ / "walk.mcap", shared = scratch_ / "shared.mcap";
  record_person(file, false);
  EXPECT_EQ(convert({file, shared, "--blur-people"}), 2);
  EXPECT_THAT(output_, AllOf(HasSubstr("has no detections"), HasSubstr("rtd run --source " + file),
                             HasSubstr("--record NEW.mcap --blur-people")));
  EXPECT_FALSE(fs::exists(shared));
}

TEST_F(ConvertTest, overwrites_nothing) {
  const std::string file = scratch_ / "x.mcap", folder = scratch_ / "tum";
  EXPECT_EQ(convert({kScene, file}), 0);
  EXPECT_EQ(convert({kScene, file}), 2);
  EXPECT_THAT(output_, HasSubstr(file + " exists"));
  EXPECT_EQ(convert({kScene, "tum:" + folder}), 0);
  EXPECT_EQ(convert({kScene, "tum:" + folder}), 2);
  EXPECT_THAT(output_, HasSubstr("holds a sequence already"));
}

TEST_F(ConvertTest, partial_loss_is_exit_code_3) {
  const std::string file = scratch_ / "x.mcap";
  EXPECT_EQ(convert({"synthetic:static?frames=24&width=160&height=120", file, "--compress", "none"}), 0);
  fs::resize_file(file, fs::file_size(file) / 2);
  EXPECT_EQ(convert({file, scratch_ / "tum", "--json"}), 3) << output_;
  const auto json = nlohmann::json::parse(output_.substr(output_.find("{\n")));
  EXPECT_GT(json["frames"], 2);
  EXPECT_LT(json["frames"], 20);
  EXPECT_GE(json["left_out"]["damaged_record"], 1);
  EXPECT_GE(json["lost"], 1);
}

TEST_F(ConvertTest, wrong_usage_is_exit_code_2) {
  EXPECT_EQ(convert({kScene}), 2);
  EXPECT_EQ(convert({kScene, scratch_ / "x.mcap", "--compress", "zip"}), 2);
  EXPECT_EQ(convert({kScene, scratch_ / "x.bag"}), 2);
  EXPECT_THAT(output_, HasSubstr("bags are read, not written"));
  EXPECT_EQ(convert({"bag:" + (scratch_ / "none.bag"), scratch_ / "x.mcap"}), 2);
  EXPECT_THAT(output_, HasSubstr("none.bag cannot be read: No such file"));
  EXPECT_EQ(convert({"synthetic:box?frames=0", scratch_ / "x.mcap"}), 2);
  EXPECT_THAT(output_, HasSubstr("is endless"));
  EXPECT_FALSE(fs::exists(scratch_ / "x.mcap"));
}

TEST_F(ConvertTest, a_folder_that_is_not_there_fails) {
  EXPECT_EQ(convert({kScene, scratch_ / "no" + "/x.mcap"}), 1);
  EXPECT_THAT(output_, HasSubstr("there is no such folder"));
}

}  // namespace
}  // namespace rtd::launcher
