// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/image_codecs.hpp"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

#include "common/io/own_library.hpp"

namespace rtd::vision {
namespace {

const ImageCodecs& load() {
  constexpr const char* kLibrary = "librtd_image_codecs.so";
  const std::string file = io::find_own_library(kLibrary).string();
  if (file.empty()) {
    throw std::runtime_error(
        std::string("no image can be read or written: ") + kLibrary +
        " is neither beside this program nor in ../lib/rtd-slam from there; install RTD-SLAM again");
  }
  void* const library = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(file + " cannot be loaded: " + dlerror());
  const auto entry = reinterpret_cast<const ImageCodecs* (*)()>(dlsym(library, kImageCodecsEntry));
  if (entry == nullptr) throw std::runtime_error(file + " is of another version: install RTD-SLAM again");
  return *entry();
}

}  // namespace

const ImageCodecs& image_codecs() {
  static const ImageCodecs& codecs = load();  // tried again after an exception
  return codecs;
}

}  // namespace rtd::vision
