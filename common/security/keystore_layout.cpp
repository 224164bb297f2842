// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/keystore_layout.hpp"

#include <algorithm>
#include <cstdlib>

#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/security/certificate.hpp"

namespace rtd::security {

namespace fs = std::filesystem;
namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string() : value;
}

}  // namespace

std::vector<std::string> enclaves_in(const KeystoreLayout& layout) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(layout.enclaves(), error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().filename() == "cert.pem")
      names.push_back("/" + fs::relative(entry->path().parent_path(), layout.enclaves()).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string read_text(const fs::path& file) {
  try {
    std::string text = io::read_file(file, io::kKeys);
    if (text.empty()) throw SecurityError(file.string() + " cannot be read: it is empty");
    return text;
  } catch (const io::IoError& error) {
    throw SecurityError(error.what());
  }
}

std::string default_keystore() {
  for (const char* name : {"RTD_KEYSTORE", "ROS_SECURITY_KEYSTORE"}) {
    if (std::string named = variable(name); !named.empty()) return named;
  }
  const std::string config = variable("XDG_CONFIG_HOME");
  return (config.empty() ? variable("HOME") + "/.config" : config) + "/rtd/keystore";
}

}  // namespace rtd::security
