// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/process/posix_process_host.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

// linux/close_range.h is missing on older kernels' headers; the value is part of the kernel's interface.
#ifndef CLOSE_RANGE_CLOEXEC
#define CLOSE_RANGE_CLOEXEC (1U << 2)
#endif

namespace rtd::process {
namespace {

void check(bool good) {
  if (!good) throw ProcessError("no socket for signs of life: " + std::generic_category().message(errno));
}

/// Set for each child, or meant for this process only.
bool replaced(std::string_view variable) {
  return std::ranges::any_of(std::array{"NOTIFY_SOCKET=", "WATCHDOG_USEC=", "WATCHDOG_PID="},
                             [&](const char* name) { return variable.starts_with(name); });
}

/// The sender that the kernel names; 0 when it names none.
ProcessId sender_of(const msghdr& message) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(const_cast<msghdr*>(&message), part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_CREDENTIALS) continue;
    ucred sender{};
    std::memcpy(&sender, CMSG_DATA(part), sizeof(sender));
    return sender.pid;
  }
  return 0;
}

constexpr std::size_t kMaxLineBytes = 4096;

struct Pipe {
  int read_end = -1, write_end = -1;
};

Pipe open_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw ProcessError(std::string("no pipe: ") + std::strerror(errno));
  return {ends[0], ends[1]};
}

/// The ends that the new process writes to: what it prints, and the errno of a failed exec.
struct ChildPipes {
  int output_fd, error_fd;
};

/// Runs in the new process between fork and exec: async-signal-safe calls only, the launcher has other threads.
[[noreturn]] void become(char* const* argv, char* const* environment, const ProcessSpec& spec, ChildPipes pipes,
                         pid_t parent) {
  setpgid(0, 0);
  [[maybe_unused]] const int priority = nice(spec.niceness);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);  // it died before the line above

  sigset_t blocked;
  sigemptyset(&blocked);
  if (spec.reads_signals) sigaddset(&blocked, SIGTERM);
  sigprocmask(SIG_SETMASK, &blocked, nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) ::signal(number, SIG_DFL);

  const int null_fd = open("/dev/null", O_RDONLY);
  dup2(null_fd, STDIN_FILENO);
  dup2(pipes.output_fd, STDOUT_FILENO);
  dup2(pipes.output_fd, STDERR_FILENO);
  close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);  // the bus's sockets of the launcher are not the child's
  execve(argv[0], argv, environment);
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(pipes.error_fd, &reason, sizeof(reason));
  _exit(127);
}

/// The errno of a failed exec; 0 once exec has succeeded (the pipe was closed by it).
int exec_error(int fd) {
  int reason = 0;
  ssize_t got = 0;
  do {
    got = read(fd, &reason, sizeof(reason));
  } while (got < 0 && errno == EINTR);
  return got == static_cast<ssize_t>(sizeof(reason)) ? reason : 0;
}

/// As exec wants them: with a null pointer at the end.
std::vector<char*> pointers(const std::vector<std::string>& texts) {
  std::vector<char*> result;
  result.reserve(texts.size() + 1);
  for (const std::string& text : texts) result.push_back(const_cast<char*>(text.c_str()));
  result.push_back(nullptr);
  return result;
}

}  // namespace

NotifySocket::NotifySocket() : fd_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  check(fd_ >= 0);
  const int on = 1;
  check(setsockopt(fd_, SOL_SOCKET, SO_PASSCRED, &on, sizeof(on)) == 0);
  const sa_family_t any_name = AF_UNIX;  // the kernel chooses an abstract one, which leaves no file
  check(bind(fd_, reinterpret_cast<const sockaddr*>(&any_name), sizeof(any_name)) == 0);
}

NotifySocket::~NotifySocket() {
  close(fd_);
}

std::vector<std::string> NotifySocket::environment(std::chrono::microseconds longest_silence) const {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!replaced(*variable)) variables.emplace_back(*variable);
  }
  sockaddr_un address{};
  socklen_t length = sizeof(address);
  check(getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &length) == 0);
  const std::string name(address.sun_path + 1, length - offsetof(sockaddr_un, sun_path) - 1);
  variables.push_back("NOTIFY_SOCKET=@" + name);
  variables.push_back("WATCHDOG_USEC=" + std::to_string(longest_silence.count()));
  return variables;
}

void NotifySocket::read(const std::function<void(ProcessId, std::string_view)>& on_message) const {
  std::array<char, 512> text{};
  alignas(cmsghdr) std::array<char, 256> extra{};
  for (;;) {
    iovec bytes{text.data(), text.size()};
    msghdr message{};
    message.msg_iov = &bytes;
    message.msg_iovlen = 1;
    message.msg_control = extra.data();
    message.msg_controllen = extra.size();
    const ssize_t got = recvmsg(fd_, &message, MSG_CMSG_CLOEXEC);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return;
    on_message(sender_of(message), {text.data(), static_cast<std::size_t>(got)});
  }
}

void LineSplitter::feed(std::string_view bytes, const std::function<void(const std::string&)>& on_line) {
  for (const char c : bytes) {
    if (c == '\n' || rest_.size() >= kMaxLineBytes) {
      on_line(rest_);
      rest_.clear();
    }
    if (c != '\n' && c != '\r') rest_.push_back(c);
  }
}

void LineSplitter::finish(const std::function<void(const std::string&)>& on_line) {
  if (!rest_.empty()) on_line(rest_);
  rest_.clear();
}

PosixProcessHost::PosixProcessHost(OnLine on_line, std::chrono::milliseconds longest_silence)
    : on_line_(std::move(on_line)), longest_silence_(longest_silence) {
  if (longest_silence_.count() > 0) signs_.emplace();
}

PosixProcessHost::~PosixProcessHost() {
  for (auto& [process, child] : children_) {
    ::kill(static_cast<pid_t>(process), SIGKILL);
    waitpid(static_cast<pid_t>(process), nullptr, 0);
    close_output(child);
  }
}

ProcessId PosixProcessHost::start(const ProcessSpec& spec) {
  const std::vector<char*> argv = pointers(spec.command);
  std::vector<std::string> variables;
  if (signs_) variables = signs_->environment(longest_silence_);
  const std::vector<char*> environment = pointers(variables);

  const Pipe output = open_pipe(), failure = open_pipe();
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {
    become(argv.data(), signs_ ? environment.data() : environ, spec, {output.write_end, failure.write_end}, parent);
  }
  close(output.write_end);
  close(failure.write_end);
  const int reason = pid < 0 ? errno : exec_error(failure.read_end);
  close(failure.read_end);
  if (reason != 0) {
    close(output.read_end);
    if (pid > 0) waitpid(pid, nullptr, 0);
    throw ProcessError("cannot run " + spec.command.front() + ": " + std::strerror(reason));
  }
  fcntl(output.read_end, F_SETFL, O_NONBLOCK);
  Child& child = children_[pid];
  child.name = spec.name;
  child.output_fd = output.read_end;
  return pid;
}

std::optional<ProcessExit> PosixProcessHost::poll_exit(ProcessId process) {
  const auto found = children_.find(process);
  if (found == children_.end()) return std::nullopt;
  int status = 0;
  rusage usage{};
  if (wait4(static_cast<pid_t>(process), &status, WNOHANG, &usage) != process) return std::nullopt;
  read_output(found->second);
  close_output(found->second);
  children_.erase(found);

  ProcessExit exit;
  if (WIFSIGNALED(status)) exit.signal = WTERMSIG(status);
  if (WIFEXITED(status)) exit.code = WEXITSTATUS(status);
  exit.cpu_s = cpu_s(usage);
  exit.peak_rss_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return exit;
}

void PosixProcessHost::terminate(ProcessId process) {
  if (children_.count(process) != 0) ::kill(static_cast<pid_t>(process), SIGTERM);
}

void PosixProcessHost::kill(ProcessId process) {
  if (children_.count(process) != 0) ::kill(static_cast<pid_t>(process), SIGKILL);
}

void PosixProcessHost::wait(std::chrono::milliseconds timeout, int wake_fd) {
  std::vector<pollfd> fds;
  for (const auto& [process, child] : children_) {
    if (child.output_fd >= 0) fds.push_back({child.output_fd, POLLIN, 0});
  }
  if (wake_fd >= 0) fds.push_back({wake_fd, POLLIN, 0});
  if (signs_) fds.push_back({signs_->fd(), POLLIN, 0});
  if (poll(fds.data(), fds.size(), static_cast<int>(timeout.count())) <= 0) return;
  for (auto& [process, child] : children_) read_output(child);
  if (signs_) signs_->read([this](ProcessId sender, std::string_view text) { receive(sender, text); });
}

void PosixProcessHost::receive(ProcessId sender, std::string_view text) {
  const auto found = children_.find(sender);
  if (found == children_.end()) return;
  if (text.starts_with("STOPPING=1")) found->second.ending = true;
  ++found->second.signs_of_life;
}

std::uint64_t PosixProcessHost::signs_of_life(ProcessId process) const {
  const auto found = children_.find(process);
  return found == children_.end() || found->second.ending ? 0 : found->second.signs_of_life;
}

std::chrono::milliseconds PosixProcessHost::waited_for_processor(ProcessId process) const {
  std::chrono::nanoseconds all{};
  std::error_code error;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task", error)) {
    std::int64_t ran_ns = 0, waited_ns = 0;
    std::ifstream file(thread.path() / "schedstat");
    if (file >> ran_ns >> waited_ns) all += std::chrono::nanoseconds(waited_ns);
  }
  return std::chrono::duration_cast<std::chrono::milliseconds>(all);
}

void PosixProcessHost::read_output(Child& child) {
  std::array<char, 8192> buffer{};
  while (child.output_fd >= 0) {
    const ssize_t got = read(child.output_fd, buffer.data(), buffer.size());
    if (got < 0) return;  // nothing now
    if (got == 0) return close_output(child);
    child.lines.feed({buffer.data(), static_cast<std::size_t>(got)},
                     [&](const std::string& line) { on_line_(child.name, line); });
  }
}

void PosixProcessHost::close_output(Child& child) {
  if (child.output_fd < 0) return;
  child.lines.finish([&](const std::string& line) { on_line_(child.name, line); });
  close(child.output_fd);
  child.output_fd = -1;
}

ProcessExit run_to_end(const ProcessSpec& spec, service::InterruptSignals& signals,
                       const PosixProcessHost::OnLine& on_line) {
  constexpr std::chrono::milliseconds kPollPeriod{20};
  PosixProcessHost host(on_line);
  const ProcessId process = host.start(spec);
  std::optional<ProcessExit> exit;
  bool interrupted = false;
  while (!(exit = host.poll_exit(process))) {
    host.wait(kPollPeriod, signals.fd());
    if (signals.take() > 0) std::exchange(interrupted, true) ? host.kill(process) : host.terminate(process);
  }
  exit->interrupted = interrupted;
  return *exit;
}

}  // namespace rtd::process
