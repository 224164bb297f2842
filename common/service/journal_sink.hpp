// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/sinks/base_sink.h>

#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::service {

/// The fields of a log line `event=frame_late frame=12 cause="a b"`, as the journal of systemd names them:
/// {"RTD_EVENT=frame_late", "RTD_FRAME=12", "RTD_CAUSE=a b"}. What is not KEY=VALUE is left out.
std::vector<std::string> journal_fields(std::string_view line);

/// Whether stderr of this process goes to the journal: systemd then sets JOURNAL_STREAM to its device and inode.
bool stderr_is_journal();

/// Sends log lines to the journal with their fields: `journalctl RTD_EVENT=tracking_lost`.
class JournalSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit JournalSink(std::string service) : service_(std::move(service)) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}

 private:
  const std::string service_;
};

}  // namespace rtd::service
