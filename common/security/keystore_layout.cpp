// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/keystore_layout.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "common/security/security_error.hpp"

namespace rtd::security {

namespace fs = std::filesystem;

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
  errno = 0;
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream || text.str().empty())
    throw SecurityError(file.string() + " cannot be read: " + (errno != 0 ? std::strerror(errno) : "it is empty"));
  return text.str();
}

}  // namespace rtd::security
