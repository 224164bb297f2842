// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::test_support {

/// Whether this program carries a sanitizer: it is then 5 to 20 times slower, too slow for a camera's pace and for
/// limits on time. Such tests skip with kTooSlow.
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
inline constexpr const char* kTooSlow = "a build with sanitizers cannot keep the pace that this test measures";

}  // namespace rtd::test_support
