// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/ddsrt/log.h>

#include <string>

namespace rtd::bus::cyclonedds {

/// While it lives, Cyclone's errors come here instead of on stderr: they say why a call failed.
class LogCapture {
 public:
  LogCapture() { dds_set_log_sink(note, this); }
  ~LogCapture() { dds_set_log_sink(nullptr, nullptr); }
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

  /// ": what it said", or nothing.
  std::string reason() const { return text_.empty() ? "" : ": " + text_; }

 private:
  static void note(void* self, const dds_log_data_t* line) {
    std::string& text = static_cast<LogCapture*>(self)->text_;
    if (text.size() > 2000) return;
    text += (text.empty() ? "" : "; ") + std::string(line->message, line->size);
    while (!text.empty() && text.back() == '\n') text.pop_back();
  }

  std::string text_;
};

}  // namespace rtd::bus::cyclonedds
