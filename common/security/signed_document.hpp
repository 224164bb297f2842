// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/security/certificate.hpp"

/// S/MIME as DDS-Security asks it of governance and permissions: text/plain, detached signature.
namespace rtd::security {

std::string sign_document(const std::string& text, const Identity& signer);
/// The text within. Throws SecurityError naming `origin` when it is no signed document or `signer` has not signed it.
std::string verified_text(const std::string& signed_text, const X509& signer, const std::string& origin);

}  // namespace rtd::security
