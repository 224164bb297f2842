// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/place/vocabulary.hpp"

// The file as it is, between two symbols: no 2 MB of source text to compile.
__asm__(
    ".section .rodata\n"
    ".balign 16\n"
    "rtd_vocabulary_begin:\n"
    ".incbin \"" RTD_VOCABULARY_FILE
    "\"\n"
    "rtd_vocabulary_end:\n"
    ".byte 0\n"
    ".global rtd_vocabulary_begin\n"
    ".global rtd_vocabulary_end\n"
    ".text\n");
extern "C" {
extern const std::byte rtd_vocabulary_begin, rtd_vocabulary_end;
}

namespace rtd::slam {

std::shared_ptr<const Vocabulary> built_in_vocabulary() {
  static const auto vocabulary =
      std::make_shared<const Vocabulary>(Vocabulary::parse({&rtd_vocabulary_begin, &rtd_vocabulary_end}));
  return vocabulary;
}

}  // namespace rtd::slam
