// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::process {

/// The folder of this program's executable.
std::string own_directory();

/// The path of `name`: next to this program, else in PATH; empty when it is in neither.
std::string find_executable(const std::string& name);

/// Why `name` cannot be run: where it was searched, and how to build it.
std::string missing_executable(const std::string& name);

/// find_executable(), but throws service::ConfigError with that reason.
std::string require_executable(const std::string& name);

/// NAME of each executable rtd-NAME next to this program and in PATH, sorted.
std::vector<std::string> installed_commands();

/// Becomes the program; returns only on failure, with the reason.
std::string replace_process(const std::string& executable, const std::vector<std::string>& arguments);

/// Starts a program that ends with this process, and with what this process becomes. Its output goes to stderr.
/// Returns why it cannot be started, else "".
std::string start_companion(const std::string& executable, const std::vector<std::string>& arguments);

/// What a program prints, without its errors; empty when it cannot be run.
std::string output_of(const std::string& executable, const std::vector<std::string>& arguments);

/// Runs a tool that shares this program's terminal and waits for it; its exit code, 128 + signal when one ended it.
int run_in_foreground(const std::string& executable, const std::vector<std::string>& arguments);

}  // namespace rtd::process
