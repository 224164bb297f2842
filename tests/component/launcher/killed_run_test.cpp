// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Every service of a run dies once, at every pace: no frame may be lost without being counted.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <atomic>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "common/bus/topics.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/camera/tum/tum_export.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::launcher {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kKilledFrames = 150;
const std::string kDriver = "ros2:/camera/color/image_raw,/camera/aligned_depth_to_color/image_raw";
const std::string kRoom = "synthetic:office?width=320&height=240&people=1&frames=";

struct Killed {
  std::string name, source, pace;
  std::uint64_t frames = 0;
};

/// A folder and a recording of one room, and weights, for all tests.
class Stored {
 public:
  static const Stored& get() {
    static const Stored stored;
    return stored;
  }
  std::string operator/(const std::string& name) const { return folder_.file(name); }

 private:
  Stored() {
    const auto source = camera::make_source(kRoom + std::to_string(kKilledFrames));
    source->open();
    camera::export_tum(*source, folder_ / "room", kKilledFrames);
    RtdCommand convert;
    EXPECT_EQ(convert.run({"convert", "tum:" + (*this / "room"), *this / "room.mcap"}), 0) << convert.output();
    folder_.write("tiny.onnx", test::tiny_network_onnx({.class_count = 80}));
  }
  const rtd::test::TemporaryFolder folder_;
};

class KilledRun : public testing::TestWithParam<Killed> {
 protected:
  KilledRun() {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    results_ = bus_->reader<msg::TrackingResult>(bus::topics::kTracking, [this](const auto& result) {
      if (result->seq >= frames_) frames_ = result->seq + 1;
    });
  }
  std::string source_of(const std::string& name) const {
    if (name == "folder") return "tum:" + (stored_ / "room");
    if (name == "recording") return "mcap:" + (stored_ / "room.mcap");
    return name;
  }
  std::vector<std::string> arguments(const std::string& source, const std::string& pace) const {
    return {"run", "--source", source_of(source), "--pace", pace, "--out", out_, "--domain", std::to_string(domain_)};
  }
  std::string log_of(const std::string& service) const { return text_of(out_ + "/logs/" + service + ".log"); }
  /// Once it has started.
  bool abort(const std::string& service) {
    pid_t pid = -1;
    for (int i = 0; i < 500 && (pid = pid_in(log_of(service))) < 1; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      rtd_.take_output();
    }
    return send_signal(pid, SIGABRT) == 0;
  }
  bool frames_come(std::uint64_t more) {
    const std::uint64_t until = frames_ + more;
    for (int i = 0; i < 1500 && frames_ < until; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      rtd_.take_output();
    }
    return frames_ >= until;
  }
  /// And waits until they are there again, and poses come.
  void kill(const std::vector<std::string>& services) {
    for (const std::string& service : services) ASSERT_TRUE(abort(service)) << service << '\n' << rtd_.output();
    for (const std::string& service : services)
      ASSERT_TRUE(rtd_.wait_for(service + " restarted (1st time)")) << rtd_.output();
    ASSERT_TRUE(frames_come(3)) << services.front() << '\n' << rtd_.output();
  }
  nlohmann::json report() const { return nlohmann::json::parse(text_of(out_ + "/report.json")); }

  const Stored& stored_ = Stored::get();
  ScratchFolder scratch_;
  const std::string out_ = scratch_ / "out";
  const std::uint32_t domain_ = test_domain();
  RtdCommand rtd_;
  std::atomic<std::uint64_t> frames_ = 0;
  std::shared_ptr<bus::Bus> bus_ = bus::connect({.domain = domain_});
  bus::Reader<msg::TrackingResult> results_;
};

class EveryService : public KilledRun {};

TEST_P(EveryService, may_die_and_no_frame_is_unaccounted_for) {
  const auto& [name, source, pace, frames] = GetParam();
  std::vector<std::string> run = arguments(source, pace), beside = {"detector", "dense", "record"};
  run.insert(run.end(), {"--frames", std::to_string(frames), "--model", stored_ / "tiny.onnx", "--dense", "--record",
                         scratch_ / "run.mcap", "--set", "slam.map.checkpoint_s=0.2"});
  if (std::filesystem::exists(std::filesystem::path(RTD_EXECUTABLE).parent_path() / "rtd-viewer")) {
    run.emplace_back("--viewer=now,exit");
    beside.emplace_back("viewer");
  }
  rtd_.start(run);
  ASSERT_TRUE(frames_come(10)) << rtd_.output();
  kill(beside);
  for (const char* service : {"camera", "filter", "slam"}) kill({service});
  const int code = rtd_.wait();
  SCOPED_TRACE(rtd_.output());
  const nlohmann::json json = report();
  EXPECT_EQ(json["frames_given"], frames);
  EXPECT_EQ(json["frames_in"], frames);
  EXPECT_EQ(json["frames_used"].get<std::uint64_t>() + json["frames_dropped"].get<std::uint64_t>(), frames);
  if (pace == "realtime") {
    EXPECT_EQ(code, json["frames_dropped"] == 0 ? 0 : 3) << "frames came too late while a service was dead";
  } else {
    EXPECT_EQ(code, 0) << rtd_.output();
    EXPECT_EQ(json["frames_dropped"], 0) << json.dump(2);
  }
  for (const char* service : {"camera", "filter", "detector", "dense", "record"})
    EXPECT_EQ(json["restarts"][service], 1) << service;
  // Seldom the new slam reaches nothing of the new filter; that it is restarted once more is what supervision is for.
  EXPECT_LE(json["restarts"]["slam"], pace == "realtime" ? 2 : 1);
  EXPECT_GE(json["restarts"]["slam"], 1);
}

INSTANTIATE_TEST_SUITE_P(Paces, EveryService,
                         testing::Values(Killed{"lockstep", "folder", "lockstep", kKilledFrames},
                                         Killed{"asap", "recording", "asap", kKilledFrames},
                                         Killed{"realtime", kRoom + "0", "realtime", 2 * kKilledFrames}),
                         [](const auto& given) { return given.param.name; });

using KilledCamera = KilledRun;

class CameraInLockstep : public KilledRun {};

TEST_P(CameraInLockstep, may_die_and_every_pose_is_as_without) {
  const auto& [name, source, pace, frames] = GetParam();
  std::vector<std::string> run = arguments(source, pace);
  run.insert(run.end(), {"--detector", "off", "--frames", std::to_string(frames)});
  const auto results = [this] {
    std::vector<std::string> texts;
    for (const char* file : {"trajectory.txt", "keyframes.txt", "map.ply"}) texts.push_back(text_of(out_ + "/" + file));
    return texts;
  };
  RtdCommand undisturbed;
  ASSERT_EQ(undisturbed.run(run), 0) << undisturbed.output();
  const std::vector<std::string> before = results();
  frames_ = 0;
  rtd_.start(run);
  ASSERT_TRUE(frames_come(10)) << rtd_.output();
  kill({"camera"});
  ASSERT_EQ(rtd_.wait(), 0) << rtd_.output();
  EXPECT_EQ(results(), before);
  EXPECT_EQ(report()["frames_given"], frames);
}

INSTANTIATE_TEST_SUITE_P(Sources, CameraInLockstep,
                         testing::Values(Killed{"folder", "folder", "lockstep", 60},
                                         Killed{"recording", "recording", "lockstep", 60},
                                         Killed{"scene", kRoom + "0", "lockstep", 60}),
                         [](const auto& given) { return given.param.name; });

TEST_F(KilledCamera, that_keeps_dying_fails_the_run_which_counts_all_frames) {
  std::vector<std::string> run = arguments("folder", "lockstep");
  run.insert(run.end(), {"--detector", "off", "--set", "launcher.max_restarts=0"});
  rtd_.start(run);
  ASSERT_TRUE(frames_come(10)) << rtd_.output();
  ASSERT_TRUE(abort("camera"));
  EXPECT_EQ(rtd_.wait(), 1) << rtd_.output();
  const nlohmann::json json = report();
  const int used = json["frames_used"];
  EXPECT_EQ(json["frames_given"], kKilledFrames);
  EXPECT_EQ(json["frames_not_played"].get<int>() + json["frames_in"].get<int>(), kKilledFrames);
  const std::string words = "only " + std::to_string(used) + " of 150 frames were used";
  for (const std::string& said : {rtd_.output(), json["events"].dump(), text_of(out_ + "/report.html")})
    EXPECT_THAT(said, AllOf(HasSubstr(words), HasSubstr("camera died: killed by signal 6 (SIGABRT)")));
  EXPECT_THAT(rtd_.output(), HasSubstr("150 given, " + std::to_string(used) + " used"));
}

TEST_F(KilledCamera, of_ros_2_continues_with_what_the_driver_sends) {
  RtdCommand replay(std::filesystem::path(RTD_EXECUTABLE).parent_path() / "rtd-replay");
  std::vector<std::string> run = arguments(kDriver, "realtime");
  run.insert(run.end(), {"--detector", "off", "--frames", "60"});
  rtd_.start(run);
  ASSERT_TRUE(rtd_.wait_for("it has no publisher")) << rtd_.output();
  replay.start({stored_ / "room.mcap", "--domain", std::to_string(domain_), "--wait-readers", "10"});
  ASSERT_TRUE(frames_come(10)) << rtd_.output();
  kill({"camera"});
  EXPECT_EQ(rtd_.wait(), 3) << "what it did not give meanwhile is missing\n" << rtd_.output();
  EXPECT_THAT(rtd_.output(), HasSubstr("frames were used: camera died: killed by signal 6 (SIGABRT)"));
  replay.interrupt();
  replay.wait();
  const nlohmann::json json = report();
  EXPECT_EQ(json["frames_given"], 60);
  EXPECT_EQ(json["frames_used"].get<int>() + json["frames_dropped"].get<int>(), 60);
  EXPECT_THAT(log_of("slam"), Not(HasSubstr("event=source_restarted"))) << "it is the same camera";
}

}  // namespace
}  // namespace rtd::launcher
