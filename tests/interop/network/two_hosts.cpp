// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/interop/network/two_hosts.hpp"

#include <unistd.h>

#include <stdexcept>

#include "tests/support/run_command.hpp"

namespace rtd::test_support {
namespace {

std::string run(const std::string& command) {
  const testing::CommandResult result = testing::run_command("timeout 10 sh -c '" + command + "'");
  if (result.exit_code != 0) throw std::runtime_error(command + ": " + result.output);
  return result.output;
}

}  // namespace

std::string TwoHosts::unavailable() {
  if (geteuid() != 0) return "needs root for network namespaces";
  for (const char* tool : {"ip", "nft", "tc", "nsenter", "unshare"})
    if (testing::run_command(std::string("command -v ") + tool).exit_code != 0)
      return std::string("needs the program ") + tool + " (packages iproute2, nftables, util-linux)";
  const auto probe = testing::run_command(
      "unshare -n sh -c 'ip link add p0 type veth peer name p1 && tc qdisc add dev p0 root tbf rate 1gbit burst 256kb "
      "latency 50ms && nft \"table netdev t { chain c { type filter hook ingress device p0 priority 0; numgen random "
      "mod "
      "100 < 1 drop; }; }\"'");
  return probe.exit_code == 0 ? "" : "this kernel gives no namespaces, veth, tbf or nft here: " + probe.output;
}

TwoHosts::TwoHosts(int loss_percent) {
  try {
    make(loss_percent);
  } catch (...) {
    remove();
    throw;
  }
}

TwoHosts::~TwoHosts() {
  remove();
}

void TwoHosts::make(int loss_percent) {
  for (const char host : {'a', 'b'}) {
    launcher::RtdCommand& holder = host == 'a' ? holder_a_ : holder_b_;
    run("ip netns add " + name(host));
    holder.start(
        {"-c", "exec ip netns exec " + name(host) +
                   " unshare -m sh -c 'mount -t tmpfs -o size=2g tmpfs /dev/shm && echo pid=$$. && exec sleep 900'"});
    if (!holder.wait_for("pid=") || !holder.wait_for(".")) throw std::runtime_error("no namespace: " + holder.output());
    const std::string& said = holder.output();
    const std::size_t begin = said.find("pid=") + 4;
    (host == 'a' ? pid_a_ : pid_b_) = said.substr(begin, said.find('.', begin) - begin);
  }
  run("ip link add eth0 netns " + name('a') + " type veth peer name eth0 netns " + name('b'));
  for (const char host : {'a', 'b'}) shape(host, loss_percent);
}

void TwoHosts::remove() {
  for (const std::string& pid : {pid_a_, pid_b_})
    if (!pid.empty()) ::kill(std::stoi(pid), SIGKILL);
  for (const char host : {'a', 'b'}) testing::run_command("ip netns del " + name(host));
}

std::string TwoHosts::name(char host) const {
  return "rtd-" + std::to_string(getpid()) + "-" + host;
}

void TwoHosts::shape(char host, int loss_percent) const {
  const std::string ip = "ip -n " + name(host), inside = "ip netns exec " + name(host) + " ";
  run(ip + " link set lo up");
  run(ip + " link set eth0 up");
  run(ip + " addr add " + (host == 'a' ? kAddressA : kAddressB) + "/24 dev eth0");
  run(inside + "tc qdisc add dev eth0 root tbf rate 1gbit burst 256kb latency 50ms");
  const std::string loss =
      loss_percent > 0 ? "numgen random mod 100 < " + std::to_string(loss_percent) + " drop; " : "";
  run(inside + "nft \"table netdev rtd { chain in { type filter hook ingress device eth0 priority 0; " +
      "ip daddr 224.0.0.0/4 drop; " + loss + "}; }\"");
}

std::vector<std::string> TwoHosts::on(char host, std::vector<std::string> command) const {
  const std::string& pid = host == 'a' ? pid_a_ : pid_b_;
  std::vector<std::string> words = {"-t", pid, "-n", "-m", "-r", "-w"};
  words.insert(words.end(), command.begin(), command.end());
  return words;
}

void TwoHosts::cut() {
  run("ip -n " + name('a') + " link set eth0 down");
}

void TwoHosts::heal() {
  run("ip -n " + name('a') + " link set eth0 up");
}

std::uint64_t TwoHosts::sent_by_a(const std::string& interface) const {
  return std::stoull(run("ip netns exec " + name('a') + " cat /sys/class/net/" + interface + "/statistics/tx_bytes"));
}

}  // namespace rtd::test_support
