// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/certificate.hpp"

#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509v3.h>

#include <ctime>

namespace rtd::security {
namespace {

using Bio = std::unique_ptr<BIO, FreeWith<BIO_free_all>>;
using Pkcs7 = std::unique_ptr<PKCS7, FreeWith<PKCS7_free>>;

/// Throws SecurityError with OpenSSL's reason.
[[noreturn]] void throw_openssl(const std::string& what) {
  const unsigned long code = ERR_get_error();
  const char* const reason = ERR_reason_error_string(code);
  ERR_clear_error();
  throw SecurityError(what + (reason == nullptr ? std::string() : std::string(": ") + reason));
}

/// `ok`: 1 is OpenSSL's success.
void require(int ok, const std::string& what) {
  if (ok != 1) throw_openssl(what);
}

Bio memory_bio(const std::string& content = {}) {
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

Key generate_key() {
  Key key(EVP_EC_gen("P-256"));
  if (!key) throw_openssl("no EC key");
  return key;
}

void set_random_serial(X509& certificate) {
  constexpr int kBits = 159;  // RFC 5280: at most 20 bytes, positive
  const std::unique_ptr<BIGNUM, FreeWith<BN_free>> serial(BN_new());
  require(BN_rand(serial.get(), kBits, BN_RAND_TOP_ANY, BN_RAND_BOTTOM_ANY), "no random number");
  BN_to_ASN1_INTEGER(serial.get(), X509_get_serialNumber(&certificate));
}

void add_extension(X509& certificate, int id, const char* value) {
  const std::unique_ptr<X509_EXTENSION, FreeWith<X509_EXTENSION_free>> extension(
      X509V3_EXT_conf_nid(nullptr, nullptr, id, value));
  if (!extension) throw_openssl("certificate extension");
  require(X509_add_ext(&certificate, extension.get(), -1), "certificate extension");
}

Certificate unsigned_certificate(const std::string& common_name, const Validity& validity, EVP_PKEY& key) {
  Certificate certificate(X509_new());
  if (!certificate) throw_openssl("no certificate");
  X509_set_version(certificate.get(), X509_VERSION_3);
  set_random_serial(*certificate);
  ASN1_TIME_set(X509_getm_notBefore(certificate.get()), static_cast<std::time_t>(validity.not_before_s));
  ASN1_TIME_set(X509_getm_notAfter(certificate.get()), static_cast<std::time_t>(validity.not_after_s));
  const auto* const name = reinterpret_cast<const unsigned char*>(common_name.c_str());
  require(X509_NAME_add_entry_by_txt(X509_get_subject_name(certificate.get()), "CN", MBSTRING_UTF8, name, -1, -1, 0),
          "name " + common_name + " cannot be used in a certificate (at most 64 characters)");
  require(X509_set_pubkey(certificate.get(), &key), "public key");
  return certificate;
}

void sign(X509& certificate, const X509& issuer, EVP_PKEY& issuer_key) {
  require(X509_set_issuer_name(&certificate, X509_get_subject_name(&issuer)), "issuer");
  if (X509_sign(&certificate, &issuer_key, EVP_sha256()) == 0) throw_openssl("signing a certificate");
}

std::int64_t seconds(const ASN1_TIME* time) {
  std::tm calendar{};
  return ASN1_TIME_to_tm(time, &calendar) == 1 ? static_cast<std::int64_t>(timegm(&calendar)) : 0;
}

}  // namespace

Identity create_ca(const std::string& common_name, const Validity& validity) {
  Identity ca{nullptr, generate_key()};
  ca.certificate = unsigned_certificate(common_name, validity, *ca.key);
  add_extension(*ca.certificate, NID_basic_constraints, "critical,CA:TRUE,pathlen:1");
  add_extension(*ca.certificate, NID_key_usage, "critical,keyCertSign,cRLSign,digitalSignature");
  sign(*ca.certificate, *ca.certificate, *ca.key);
  return ca;
}

Identity issue(const std::string& common_name, const Validity& validity, const Identity& ca) {
  Identity identity{nullptr, generate_key()};
  identity.certificate = unsigned_certificate(common_name, validity, *identity.key);
  add_extension(*identity.certificate, NID_basic_constraints, "critical,CA:FALSE");
  add_extension(*identity.certificate, NID_key_usage, "critical,digitalSignature");
  sign(*identity.certificate, *ca.certificate, *ca.key);
  return identity;
}

std::string to_pem(const X509& certificate) {
  const Bio bio = memory_bio();
  require(PEM_write_bio_X509(bio.get(), &certificate), "writing a certificate");
  return content_of(bio.get());
}

std::string to_pem(const EVP_PKEY& key) {
  const Bio bio = memory_bio();
  require(PEM_write_bio_PKCS8PrivateKey(bio.get(), &key, nullptr, nullptr, 0, nullptr, nullptr), "writing a key");
  return content_of(bio.get());
}

Certificate certificate_from_pem(const std::string& pem, const std::string& origin) {
  Certificate certificate(PEM_read_bio_X509(memory_bio(pem).get(), nullptr, nullptr, nullptr));
  if (!certificate) throw_openssl(origin + " is not a certificate in PEM");
  return certificate;
}

Key key_from_pem(const std::string& pem, const std::string& origin) {
  Key key(PEM_read_bio_PrivateKey(memory_bio(pem).get(), nullptr, nullptr, nullptr));
  if (!key) throw_openssl(origin + " is not a private key in PEM");
  return key;
}

std::string subject_name(const X509& certificate) {
  const Bio bio = memory_bio();
  X509_NAME_print_ex(bio.get(), X509_get_subject_name(&certificate), 0, XN_FLAG_RFC2253 & ~ASN1_STRFLGS_ESC_MSB);
  return content_of(bio.get());
}

Validity validity_of(const X509& certificate) {
  return {seconds(X509_get0_notBefore(&certificate)), seconds(X509_get0_notAfter(&certificate))};
}

bool belongs_to(const EVP_PKEY& key, const X509& certificate) {
  const bool same = X509_check_private_key(&certificate, &key) == 1;
  ERR_clear_error();
  return same;
}

bool signed_by(const X509& certificate, const X509& ca) {
  const bool ok = X509_verify(const_cast<X509*>(&certificate), X509_get0_pubkey(&ca)) == 1;
  ERR_clear_error();
  return ok;
}

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
  if (!signature) throw_openssl(origin + " is not a signed document (S/MIME)");
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
