// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/image_codecs.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>

namespace rtd::vision {
namespace {

const ImageCodecs& load() {
  namespace fs = std::filesystem;
  constexpr const char* kLibrary = "librtd_image_codecs.so";
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& folder : {here, here / "../lib/rtd-slam", here / "../bin"}) {  // the last for tests
    const fs::path file = folder / kLibrary;
    if (!fs::exists(file, error)) continue;
    void* const library = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error(file.string() + " cannot be loaded: " + dlerror());
    const auto entry = reinterpret_cast<const ImageCodecs* (*)()>(dlsym(library, kImageCodecsEntry));
    if (entry == nullptr) throw std::runtime_error(file.string() + " is of another version: install RTD-SLAM again");
    return *entry();
  }
  throw std::runtime_error(std::string("no image can be read or written: ") + kLibrary + " is neither in " +
                           here.string() + " nor in ../lib/rtd-slam from there; install RTD-SLAM again");
}

}  // namespace

const ImageCodecs& image_codecs() {
  static const ImageCodecs& codecs = load();  // tried again after an exception
  return codecs;
}

}  // namespace rtd::vision
