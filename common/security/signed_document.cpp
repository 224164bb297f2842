// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/signed_document.hpp"

#include <openssl/err.h>

#include "common/security/security_error.hpp"

namespace rtd::security {

std::string sign_document(const std::string& text, const Identity& signer) {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM;
  const Bio input = memory_bio(text);
  const Pkcs7 signature(PKCS7_sign(signer.certificate.get(), signer.key.get(), nullptr, input.get(), kFlags));
  if (!signature) throw_openssl("signing");
  const Bio output = memory_bio();
  require(SMIME_write_PKCS7(output.get(), signature.get(), input.get(), kFlags), "writing a signed document");
  return content_of(output.get());
}

std::string verified_text(const std::string& signed_text, const X509& signer, const std::string& origin) {
  BIO* detached = nullptr;
  const Pkcs7 signature(SMIME_read_PKCS7(memory_bio(signed_text).get(), &detached));
  const Bio text(detached);
  if (!signature) throw_openssl(origin + " is no signed document (S/MIME)");
  constexpr auto kFree = [](STACK_OF(X509) * stack) { sk_X509_free(stack); };  // a macro
  const std::unique_ptr<STACK_OF(X509), FreeWith<kFree>> signers(sk_X509_new_null());
  sk_X509_push(signers.get(), const_cast<X509*>(&signer));
  const Bio output = memory_bio();
  // Only the given certificate may have signed; what the document brings along does not count.
  if (PKCS7_verify(signature.get(), signers.get(), nullptr, text.get(), output.get(),
                   PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN) != 1)
    throw_openssl(origin + " is not signed by " + subject_name(signer));
  return content_of(output.get());
}

}  // namespace rtd::security
