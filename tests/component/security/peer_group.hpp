// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/process/posix_process_host.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::security {

/// Keystores of one CA, and one that is not of it.
class Keystores {
 public:
  explicit Keystores(std::string scratch);
  /// Enclaves /rtd/writer and /rtd/reader, which may publish and subscribe rt/open and rt/secret; /rtd/expired and
  /// /rtd/stale, which might until an hour ago by certificate and by permissions; /rtd/unpermitted, which may use other
  /// topics.
  std::string good() const { return scratch_ + "/good"; }
  std::string rogue() const { return scratch_ + "/rogue"; }  ///< the same names, another CA
  std::string lax() const { return scratch_ + "/lax"; }      ///< a governance that lets its own side do anything
  /// What lets an expired participant believe that it is not.
  std::vector<std::string> clock_of_expired() const;

 private:
  std::string scratch_;
};

/// Some secure_peer processes in a domain of their own and what they say.
class PeerGroup {
 public:
  explicit PeerGroup(std::string vendor);
  ~PeerGroup();
  PeerGroup(const PeerGroup&) = delete;
  PeerGroup& operator=(const PeerGroup&) = delete;

  /// `environment`: "NAME=value"s. `vendor`: another than the group's.
  void start(const std::string& tag, const std::string& keystore, const std::string& enclave,
             const std::vector<std::string>& topics, const std::vector<std::string>& environment = {},
             const std::string& vendor = {});
  /// False when the condition did not come true within a minute.
  bool wait_until(const std::function<bool()>& condition);
  int sent(const std::string& peer) { return reports_[peer].sent; }
  int got(const std::string& peer, const std::string& from) { return reports_[peer].got[from]; }
  bool refused(const std::string& peer) { return reports_[peer].refused; }
  const std::string& problems(const std::string& peer) { return reports_[peer].problems; }
  const std::string& log() const { return log_; }
  std::string scratch() const { return scratch_.path(); }

 private:
  struct PeerReport {
    int sent = 0;
    std::map<std::string, int> got;
    bool refused = false;  ///< it is not in the domain, or may not write any topic
    std::string problems;
  };
  void read_line(const std::string& peer, const std::string& line);

  const std::string vendor_;
  const test::TemporaryFolder scratch_;
  std::string log_;
  std::map<std::string, PeerReport> reports_;
  std::vector<process::ProcessId> processes_;
  process::PosixProcessHost host_;
};

}  // namespace rtd::security
