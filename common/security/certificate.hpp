// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/evp.h>
#include <openssl/x509.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

namespace rtd::security {

/// A keystore cannot be made or used; what() names file or enclave, cause and fix.
class SecurityError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Owners of OpenSSL's objects.
template <auto kFree>
struct FreeWith {
  template <class T>
  void operator()(T* object) const {
    kFree(object);
  }
};
using Certificate = std::unique_ptr<X509, FreeWith<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, FreeWith<EVP_PKEY_free>>;

/// From when to when, in seconds since 1970 (UTC).
struct Validity {
  std::int64_t not_before_s = 0, not_after_s = 0;
};

/// A certificate with its private key.
struct Identity {
  Certificate certificate;
  Key key;
};

/// A new EC P-256 key with a certificate that it signs itself.
Identity create_ca(const std::string& common_name, const Validity& validity);
/// A new EC P-256 key with a certificate that the CA signs.
Identity issue(const std::string& common_name, const Validity& validity, const Identity& ca);

std::string to_pem(const X509& certificate);
std::string to_pem(const EVP_PKEY& key);
/// `origin`: file name for the error. Throw SecurityError.
Certificate certificate_from_pem(const std::string& pem, const std::string& origin);
Key key_from_pem(const std::string& pem, const std::string& origin);

/// As DDS-Security compares it (RFC 2253): "CN=/rtd/slam".
std::string subject_name(const X509& certificate);
Validity validity_of(const X509& certificate);
bool belongs_to(const EVP_PKEY& key, const X509& certificate);
/// The CA has signed it, whatever the date.
bool signed_by(const X509& certificate, const X509& ca);

/// S/MIME as DDS-Security asks it of governance and permissions: text/plain, detached signature.
std::string sign_document(const std::string& text, const Identity& signer);
/// The text within. Throws SecurityError naming `origin` when it is not a signed document or `signer` has not signed
/// it.
std::string verified_text(const std::string& signed_text, const X509& signer, const std::string& origin);

}  // namespace rtd::security
