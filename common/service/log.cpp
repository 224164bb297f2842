// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/log.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <syslog.h>
#include <systemd/sd-journal.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <utility>

#include "common/io/printable.hpp"
#include "common/io/text.hpp"

namespace rtd::service {
namespace {

/// One event is one line, whatever texts from outside it quotes.
class Logger : public spdlog::logger {
 public:
  using spdlog::logger::logger;

  void log_counted() {
    const std::lock_guard lock(mutex_);
    for (const std::string& line : repeated_.take_counted()) {
      spdlog::logger::sink_it_(spdlog::details::log_msg(name(), spdlog::level::info, line));
    }
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string_view line(message.payload.data(), message.payload.size());
    const std::lock_guard lock(mutex_);
    std::optional<std::string> repeated = "";
    if (message.level >= spdlog::level::warn) repeated = repeated_.note(line, message.time);
    if (!repeated) return;
    if (repeated->empty() && io::is_printable(line)) return spdlog::logger::sink_it_(message);
    const std::string shown = io::printable(line) + *repeated;
    spdlog::details::log_msg copy = message;
    copy.payload = shown;
    spdlog::logger::sink_it_(copy);
  }

 private:
  std::mutex mutex_;
  RepeatedEvents repeated_;
};

std::string clock_text(RepeatedEvents::Time time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
  std::tm local{};
  localtime_r(&seconds, &local);
  char text[16];
  std::strftime(text, sizeof text, "%H:%M:%S", &local);
  return text;
}

/// "cause" as a field's name; empty when it cannot be one.
std::string field_name(std::string_view key) {
  std::string name = "RTD_";
  for (const char c : key) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') return {};
    name += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return key.empty() ? std::string() : name;
}

int priority(spdlog::level::level_enum level) {
  switch (level) {
    case spdlog::level::trace:
    case spdlog::level::debug:
      return LOG_DEBUG;
    case spdlog::level::warn:
      return LOG_WARNING;
    case spdlog::level::err:
      return LOG_ERR;
    case spdlog::level::critical:
      return LOG_CRIT;
    default:
      return LOG_INFO;
  }
}

/// Sends log lines to the journal with their fields: `journalctl RTD_EVENT=tracking_lost`.
class JournalSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit JournalSink(std::string service) : service_(std::move(service)) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string_view line(message.payload.data(), message.payload.size());
    std::vector<std::string> fields = journal_fields(line);
    fields.push_back("MESSAGE=" + std::string(line));
    fields.push_back("PRIORITY=" + std::to_string(priority(message.level)));
    fields.push_back("SYSLOG_IDENTIFIER=rtd-" + service_);
    std::vector<iovec> parts;
    parts.reserve(fields.size());
    for (std::string& field : fields) parts.push_back({field.data(), field.size()});
    sd_journal_sendv(parts.data(), static_cast<int>(parts.size()));
  }
  void flush_() override {}

 private:
  const std::string service_;
};

}  // namespace

void init_logging(const std::string& service, const std::string& level) {
  spdlog::sink_ptr sink;
  if (stderr_is_journal()) {
    sink = std::make_shared<JournalSink>(service);
  } else {
    sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  }
  auto logger = std::make_shared<Logger>(service, std::move(sink));
  logger->set_pattern("%H:%M:%S.%e %^%l%$ %n %v");
  logger->set_level(spdlog::level::from_str(level));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

void log_repeated_events() {
  if (const auto logger = std::dynamic_pointer_cast<Logger>(spdlog::default_logger())) logger->log_counted();
}

std::optional<std::string> RepeatedEvents::note(std::string_view line, Time now) {
  if (kinds_.size() >= kMaxKinds) kinds_.clear();
  const auto [found, is_new] = kinds_.try_emplace(io::without_numbers(line));
  Kind& kind = found->second;
  if (!is_new && now - kind.written < kGroup) {
    if (kind.counted++ == 0) kind.first = now;
    kind.last = now;
    kind.newest = line;
    return std::nullopt;
  }
  const std::string text =
      kind.counted == 0 ? "" : " repeated=" + std::to_string(kind.counted) + " first=" + clock_text(kind.first);
  kind.written = now;
  kind.counted = 0;
  return text;
}

std::vector<std::string> RepeatedEvents::take_counted() {
  std::vector<std::string> lines;
  for (const auto& [key, kind] : std::exchange(kinds_, {})) {
    if (kind.counted > 0) lines.push_back(summary(kind));
  }
  return lines;
}

std::string RepeatedEvents::summary(const Kind& kind) {
  return kind.newest + " repeated=" + std::to_string(kind.counted) + " first=" + clock_text(kind.first) +
         " last=" + clock_text(kind.last);
}

bool RateLimit::pass() {
  const auto now = std::chrono::steady_clock::now();
  if (last_ != std::chrono::steady_clock::time_point{} && now - last_ < period_) {
    ++suppressed_;
    return false;
  }
  last_ = now;
  last_suppressed_ = suppressed_;
  suppressed_ = 0;
  return true;
}

std::vector<std::string> journal_fields(std::string_view line) {
  std::vector<std::string> fields;
  while (!line.empty()) {
    const std::size_t equals = line.find_first_of("= ");
    if (equals == std::string_view::npos) break;
    if (line[equals] == ' ') {
      line.remove_prefix(equals + 1);
      continue;
    }
    const std::string name = field_name(line.substr(0, equals));
    line.remove_prefix(equals + 1);
    const bool quoted = line.starts_with('"');
    if (quoted) line.remove_prefix(1);
    const std::size_t end = std::min(line.find(quoted ? '"' : ' '), line.size());
    if (!name.empty()) fields.push_back(name + '=' + std::string(line.substr(0, end)));
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return fields;
}

bool stderr_is_journal() {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat file {};
  return stream != nullptr && fstat(STDERR_FILENO, &file) == 0 &&
         std::to_string(file.st_dev) + ':' + std::to_string(file.st_ino) == stream;
}

}  // namespace rtd::service
