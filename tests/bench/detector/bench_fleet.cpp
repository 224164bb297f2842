// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// One detector for several robots, each in a process of its own, over Fast DDS on the loopback interface. Robots are
// doubles that send JPEG images and check every answer; in the box, what stands in for the network takes the time that
// it is given. With --link each robot has a domain of its own, behind `rtd-link`. With --detector the box is
// `rtd-detector` with a real network: its answers are then not checked for what they say (column wrong). Prints a line
// for each robot.
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "common/service/log.hpp"
#include "services/detector/fleet_service.hpp"
#include "tests/support/fleet/robot_double.hpp"
#include "tests/support/test_domain.hpp"

namespace {

using namespace rtd;
using test_support::quantile;
using test_support::RobotDouble;

struct Options {
  std::string role = "run";
  int robots = 8, id = 0, batch = 8, width = 640, height = 480, domain = 0;
  double rate_hz = 30, seconds = 20, batch_ms = 3, image_ms = 0, flood_hz = 0;
  std::string detector, link;
};

/// DDS domain of a robot behind a link; others are in that of the box.
constexpr int kFirstLinkedDomain = 62;
int domain_of_robot(const Options& options, int id) {
  return options.link.empty() ? options.domain : kFirstLinkedDomain + id;
}
std::string name_of_robot(int id) {
  return "r" + std::to_string(id);
}

bus::BusOptions bus_options(const Options& options) {
  bus::BusOptions bus;
  bus.vendor = "fastdds";
  bus.domain = static_cast<std::uint32_t>(options.domain);
  return bus;
}

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) * 1e-6;
}

/// Serves until its time is over; what joining and ending take is beside it.
int be_box(const Options& options) {
  service::init_logging("box", "info");
  const auto bus = bus::connect(bus_options(options));
  service::StopToken stop;
  service::Heartbeat heartbeat(*bus, detector::FleetService::kHeartbeatName, stop,
                               service::Heartbeat::SecondInstance::kAllowed);
  service::Runtime runtime{*bus, heartbeat, stop, service::Pace::kRealtime, bus_options(options)};
  const auto stand_in = [&options](std::span<const cv::Mat> images) {
    const double ms = options.batch_ms + options.image_ms * static_cast<double>(images.size());
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double, std::milli>(ms);
    auto found = test_support::read_all_marks(images);
    std::this_thread::sleep_until(until);
    return found;
  };
  detector::FleetConfig config;
  config.queue.batch = static_cast<std::size_t>(options.batch);
  config.decoders = static_cast<int>(std::min(4U, std::thread::hardware_concurrency()));
  detector::FleetService service(config, runtime, {stand_in, [] { return std::string("stands in"); }});
  std::jthread end([&] {
    stop.wait_for(std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(options.seconds)));
    stop.request_stop();
  });
  service.run();
  std::printf("box: %.0f %% of a core\n", 100 * cpu_s() / options.seconds);
  return 0;
}

/// Measures from its first answers on.
int be_robot(const Options& options) {
  const std::string name = name_of_robot(options.id);
  const bool floods = options.flood_hz > 0 && options.id == options.robots - 1;
  RobotDouble robot(bus_options(options), {.name = name,
                                           .id = options.id,
                                           .rate_hz = floods ? options.flood_hz : options.rate_hz,
                                           .size = {options.width, options.height}});
  if (!robot.wait_answers(3)) {
    std::printf("%-6s no answer within 20 s\n", name.c_str());
    return 1;
  }
  std::this_thread::sleep_for(std::chrono::seconds(3));  // until all have joined
  robot.take_figures();
  std::this_thread::sleep_for(std::chrono::duration<double>(options.seconds));
  const RobotDouble::Figures figures = robot.take_figures();
  std::printf("%-6s %8lu %8lu %7.3f %6lu %8.1f %8.1f %8ld\n", name.c_str(), figures.sent, figures.answered,
              static_cast<double>(figures.answered) / static_cast<double>(std::max<std::uint64_t>(figures.sent, 1)),
              figures.wrong, quantile(figures.latencies_ms, 0.5), quantile(figures.latencies_ms, 0.99),
              figures.longest_gap_ms);
  return 0;
}

/// This program again, in a process of its own.
FILE* start(const std::string& role, int id, const Options& options) {
  const double box_s = options.seconds + 8;
  std::string command = "/proc/" + std::to_string(getpid()) + "/exe --role " + role + " --id " + std::to_string(id);
  if (role == "box" && !options.detector.empty()) {
    command = "timeout -s INT " + std::to_string(box_s) + " " + options.detector + " --robots all --batch " +
              std::to_string(options.batch);
  } else {
    const auto add = [&command](const char* name, double value) {
      command += std::string(" ") + name + " " + std::to_string(value);
    };
    command += " --robots " + std::to_string(options.robots) + " --batch " + std::to_string(options.batch) +
               " --size " + std::to_string(options.width) + " " + std::to_string(options.height);
    add("--rate", options.rate_hz);
    add("--batch-ms", options.batch_ms);
    add("--image-ms", options.image_ms);
    add("--flood", options.flood_hz);
    add("--seconds", role == "box" ? box_s : options.seconds);
  }
  const int domain = role == "robot" ? domain_of_robot(options, id) : options.domain;
  return popen((command + " --domain " + std::to_string(domain)).c_str(), "r");
}

/// What takes the images of a robot to the box and brings its boxes back.
FILE* start_link(int id, const Options& options) {
  const std::string time_s = std::to_string(options.seconds + 8);
  return popen(("timeout -s INT " + time_s + " " + options.link + " --robot " + name_of_robot(id) + " --domain " +
                std::to_string(domain_of_robot(options, id)) + " --fleet " + std::to_string(options.domain) +
                " --log-level warning")
                   .c_str(),
               "r");
}

int run(Options options) {
  std::vector<FILE*> processes = {start("box", 0, options)};
  for (int id = 0; id < options.robots; ++id) processes.push_back(start("robot", id, options));
  for (int id = 0; id < options.robots && !options.link.empty(); ++id) processes.push_back(start_link(id, options));
  std::printf("%-6s %8s %8s %7s %6s %8s %8s %8s\n", "robot", "sent", "answers", "share", "wrong", "p50 ms", "p99 ms",
              "gap ms");
  std::fflush(stdout);
  std::rotate(processes.begin(), processes.begin() + 1, processes.end());  // the box ends last
  int code = 0;
  for (FILE* process : processes) {
    char line[512];
    while (std::fgets(line, sizeof line, process) != nullptr) std::fputs(line, stdout);
    code = std::max(code, pclose(process) == 0 ? 0 : 1);
  }
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.domain = test_domain();
  CLI::App app{"One detector for several robots, in processes of their own", "bench_fleet"};
  app.add_option("--role", options.role)->group("");
  app.add_option("--id", options.id)->group("");
  app.add_option("--robots", options.robots, "Number of robots")->check(CLI::Range(1, test_support::kMaxIds));
  app.add_option("--rate", options.rate_hz, "Images a second of each")->capture_default_str();
  std::vector<int> size;
  app.add_option("--size", size, "Width and height of the images")->expected(2);
  app.add_option("--flood", options.flood_hz, "Images a second of the last robot, 0: as the others");
  app.add_option("--seconds", options.seconds, "Time of the measurement")->capture_default_str();
  app.add_option("--batch", options.batch, "Images computed at once, at most")->capture_default_str();
  app.add_option("--batch-ms", options.batch_ms, "Time of the stand-in for a batch")->capture_default_str();
  app.add_option("--image-ms", options.image_ms, "and for each of its images")->capture_default_str();
  app.add_option("--domain", options.domain, "DDS domain");
  app.add_option("--detector", options.detector, "rtd-detector, with its options: in place of the stand-in");
  app.add_option("--link", options.link, "rtd-link: gives each robot a domain of its own");
  CLI11_PARSE(app, argc, argv);
  if (size.size() == 2) {
    options.width = size[0];
    options.height = size[1];
  }
  if (options.role == "box") return be_box(options);
  if (options.role == "robot") return be_robot(options);
  return run(options);
}
