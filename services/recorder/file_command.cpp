// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/file_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "common/mcap/byte_sink.hpp"
#include "common/service/exit_code.hpp"

namespace rtd::recorder {

int run_file_command(CLI::App& app, int argc, char** argv, const std::function<int()>& work) {
  try {
    app.parse(argc - 1, argv + 1);
    return work();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? service::kOk : service::kUsageOrConfig;
  } catch (const mcap::IoError& error) {
    std::cerr << "rtd-record: " << error.what() << '\n';
    return service::kUsageOrConfig;
  } catch (const std::exception& error) {
    std::cerr << "rtd-record: " << error.what() << '\n';
    return service::kRunFailed;
  }
}

}  // namespace rtd::recorder
