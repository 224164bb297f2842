// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/openssl_handles.hpp"

#include <openssl/err.h>

#include "common/security/security_error.hpp"

namespace rtd::security {

void throw_openssl(const std::string& what) {
  const unsigned long code = ERR_get_error();
  const char* const reason = ERR_reason_error_string(code);
  ERR_clear_error();
  throw SecurityError(what + (reason == nullptr ? std::string() : std::string(": ") + reason));
}

void require(int ok, const std::string& what) {
  if (ok != 1) throw_openssl(what);
}

Bio memory_bio(const std::string& content) {
  Bio bio(BIO_new(BIO_s_mem()));
  if (!bio) throw_openssl("no memory");
  if (!content.empty()) BIO_write(bio.get(), content.data(), static_cast<int>(content.size()));
  return bio;
}

std::string content_of(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return size > 0 ? std::string(data, static_cast<std::size_t>(size)) : std::string();
}

}  // namespace rtd::security
