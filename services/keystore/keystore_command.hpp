// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rtd::keystore {

/// The command line of `rtd keystore`.
struct KeystoreRequest {
  enum class Action { kCreate, kAdd, kRenew, kInfo };
  Action action = Action::kInfo;
  std::string folder;                 ///< empty: the default
  std::vector<std::string> enclaves;  ///< to add or renew
  int days = 365;
  int domain = -1;                  ///< the only one; -1 = all
  bool verbose = false;             ///< info: all topics by name
  bool encrypt_frames = false;      ///< also data that otherwise stays in shared memory
  std::vector<std::string> robots;  ///< that get their own enclaves
  std::string like;                 ///< role whose topics a new enclave gets
  std::vector<std::string> publish, subscribe;
};

/// Adds `create`, `add`, `renew` and `info`; parsing fills `request`, which must outlive `app`.
void add_keystore_commands(CLI::App& app, KeystoreRequest& request);

/// Runs the command at the time `now_s` (seconds since 1970). Results go to `out`, errors to `err`. Returns the exit
/// code: 0; 1 when `info` finds an unusable enclave; 2 when the command is not possible.
int run_keystore(const KeystoreRequest& request, std::int64_t now_s, std::ostream& out, std::ostream& err);

}  // namespace rtd::keystore
