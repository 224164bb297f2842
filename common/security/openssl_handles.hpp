// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <memory>
#include <string>

namespace rtd::security {

/// Owners of OpenSSL's objects.
template <auto Free>
struct FreeWith {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Bio = std::unique_ptr<BIO, FreeWith<BIO_free_all>>;
using Key = std::unique_ptr<EVP_PKEY, FreeWith<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, FreeWith<X509_free>>;
using Pkcs7 = std::unique_ptr<PKCS7, FreeWith<PKCS7_free>>;

/// Throws SecurityError with `what` and OpenSSL's reason.
[[noreturn]] void throw_openssl(const std::string& what);
/// Throws as above when `ok` is not 1 (OpenSSL's success).
void require(int ok, const std::string& what);

Bio memory_bio(const std::string& content = {});
std::string content_of(BIO* bio);

}  // namespace rtd::security
