// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>

#include <string_view>

#include "common/io/printable.hpp"
#include "common/service/journal_sink.hpp"

namespace rtd::service {
namespace {

/// One event is one line, whatever texts from outside it quotes.
class Logger : public spdlog::logger {
 public:
  using spdlog::logger::logger;

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string_view line(message.payload.data(), message.payload.size());
    if (io::is_printable(line)) return spdlog::logger::sink_it_(message);
    const std::string shown = io::printable(line);
    spdlog::details::log_msg copy = message;
    copy.payload = shown;
    spdlog::logger::sink_it_(copy);
  }
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

}  // namespace rtd::service
