// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

namespace CLI {
class App;
}

namespace rtd::recording {

/// The command line of `rtd convert`.
struct ConvertOptions {
  std::string source, destination;
  std::string compression = "zstd";  ///< of an MCAP file: none, lz4 or zstd
  std::uint64_t frames = 0;          ///< at most so many, 0 = all
  bool json = false;
};

void add_convert_command(CLI::App& app, ConvertOptions& options);

/// Writes a source as a TUM folder or an MCAP file. Returns the exit code: 3 when part of the source was damaged.
int run_convert(const ConvertOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::recording
