// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/rtps/service_run.hpp"

#include <regex>

namespace rtd::fuzz {

using launcher::text_of;

ServiceRun::ServiceRun(const std::string& vendor, std::uint32_t domain) : out_(scratch_ / "out") {
  const std::vector<std::string> bus = {"--dds", vendor, "--domain", std::to_string(domain)};
  std::vector<std::string> run = {"run", "--source", "synthetic:office?frames=0", "--out", out_, "--dense"};
  run.insert(run.end(), bus.begin(), bus.end());
  rtd_.start(run);
  // Beside the run, for there it would have to record the raw frames, 46 MB/s.
  std::vector<std::string> record = {"record", "-o", scratch_ / "run.mcap", "--topics", "rtd/status", "rt/slam/*"};
  record.insert(record.end(), bus.begin(), bus.end());
  recorder_.start(record);
}

bool ServiceRun::wait_for_frames() {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < give_up) {
    let_run(std::chrono::milliseconds(50));
    if (text_of(out_ + "/logs/camera.log").find("event=all_ready") != std::string::npos) return true;
  }
  return false;
}

std::vector<std::string> ServiceRun::services() {
  std::vector<std::string> found;
  for (const char* service : {"camera", "detector", "filter", "slam", "dense"})
    if (pid_of(service) > 0) found.emplace_back(service);
  found.insert(found.end(), {"record", "launcher"});
  return found;
}

pid_t ServiceRun::pid_of(const std::string& service) {
  if (service == "launcher") return static_cast<pid_t>(rtd_.process());
  if (service == "record") return static_cast<pid_t>(recorder_.process());
  const std::string log = text_of(out_ + "/logs/" + service + ".log");
  const std::regex started("event=started .*pid=([0-9]+)");
  pid_t newest = -1;
  for (std::sregex_iterator match(log.begin(), log.end(), started), end; match != end; ++match)
    newest = std::stoi((*match)[1]);
  return newest;
}

bool ServiceRun::lives(const std::string& service) {
  const pid_t process = pid_of(service);
  // A dead child that was not waited for yet can still be sent signal 0.
  return process > 0 && text_of("/proc/" + std::to_string(process) + "/stat").find(") Z") == std::string::npos &&
         ::kill(process, 0) == 0;
}

bool ServiceRun::wait_until_alive(const std::string& service, std::chrono::milliseconds timeout) {
  const auto give_up = std::chrono::steady_clock::now() + timeout;
  while (!lives(service) && std::chrono::steady_clock::now() < give_up) let_run(std::chrono::milliseconds(50));
  return lives(service);
}

void ServiceRun::let_run(std::chrono::milliseconds time) {
  recorder_.take_output();
  rtd_.take_output();
  rtd_.wait_for("never printed", time);
}

void ServiceRun::end() {
  std::vector<std::string> left = services();
  recorder_.interrupt();
  rtd_.interrupt();
  const auto asked = std::chrono::steady_clock::now(), give_up = asked + std::chrono::seconds(20);
  do {
    let_run(std::chrono::milliseconds(20));
    std::erase_if(left, [this](const std::string& service) { return !lives(service); });
  } while (!left.empty() && std::chrono::steady_clock::now() < give_up);
  for (const std::string& process : left) {
    std::printf("  %s did not end within 20 s of being asked and was killed\n", process.c_str());
    if (const pid_t pid = pid_of(process); pid > 1) ::kill(pid, SIGKILL);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - asked;
  std::printf("  ended within %.1f s of Ctrl-C\n", took.count());
  std::istringstream output(rtd_.output());
  for (std::string line; std::getline(output, line);)
    if (line.find("did not end when asked") != std::string::npos) std::printf("  %s\n", line.c_str());
}

std::vector<std::string> ServiceRun::take_deaths() {
  std::vector<std::string> lines;
  std::istringstream output(rtd_.output());
  for (std::string line; std::getline(output, line);)
    if (line.find(" died: ") != std::string::npos || line.find("restarted (") != std::string::npos)
      lines.push_back(line);
  lines.erase(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(deaths_reported_));
  deaths_reported_ += lines.size();
  return lines;
}

}  // namespace rtd::fuzz
