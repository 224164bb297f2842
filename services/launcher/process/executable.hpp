// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::launcher {

/// The folder of this program's executable.
std::string own_directory();

/// `name` beside this program's executable, else in PATH; empty when it is in neither.
std::string find_executable(const std::string& name);

/// The names behind "rtd-" of the executables beside this program and in PATH, sorted.
std::vector<std::string> installed_services();

/// Becomes the program; returns only on failure, with the reason.
std::string replace_process(const std::string& executable, const std::vector<std::string>& arguments);

/// Runs a tool that shares this program's terminal and waits for it; its exit code, 128 + signal when one ended it.
int run_in_foreground(const std::string& executable, const std::vector<std::string>& arguments);

}  // namespace rtd::launcher
