// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/form.hpp"

#include <array>
#include <string_view>

#include "common/io/byte_sink.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/recording_file.hpp"

namespace rtd::recordings {

Form form_of(const io::ByteSource& source) {
  std::array<std::byte, io::kMagicBytes> bytes{};
  const std::size_t count = source.read(0, bytes);
  const std::string_view begin(reinterpret_cast<const char*>(bytes.data()), count);
  if (begin.starts_with(io::kBagMagic)) return Form::kBag;
  if (begin.starts_with(io::kDb3Magic)) return Form::kDb3;
  if (begin.starts_with(io::kZstdMagic)) return Form::kPacked;
  return mcap::looks_like_recording(source) ? Form::kMcap : Form::kOther;
}

Form form_of(const std::filesystem::path& path) {
  try {
    return form_of(io::FileSource(path));
  } catch (const io::IoError&) {
    return Form::kOther;
  }
}

}  // namespace rtd::recordings
