// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/torch_engine.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "common/io/own_library.hpp"
#include "services/detector/core/onnx_graph.hpp"
#include "services/detector/core/torch/torch_module.hpp"

namespace rtd::detector {
namespace {

namespace fs = std::filesystem;
using torch_module::Module;

constexpr const char* kLibrary = "librtd_engine_torch.so";

fs::path find_library() {
  const char* const folder = std::getenv(kEngineFolder);
  if (folder == nullptr) return io::find_own_library(kLibrary);
  std::error_code ignored;
  const fs::path file = fs::path(folder) / kLibrary;
  return fs::exists(file, ignored) ? file : fs::path();
}

/// Never unloaded: libtorch keeps threads.
const Module& load() {
  const fs::path file = find_library();
  if (file.empty()) {
    throw EngineError(std::string("there is no torch engine (") + kLibrary +
                      "): install libtorch-dev, configure and build again; " + kEngineFolder + " names another folder");
  }
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw EngineError(file.string() + " cannot be loaded: " + dlerror());
  const auto entry = reinterpret_cast<torch_module::Entry>(dlsym(library, torch_module::kEntry));
  if (entry == nullptr) throw EngineError(file.string() + " is not an engine of RTD-SLAM");
  const Module* const found = entry();
  if (found->version != torch_module::kVersion) {
    throw EngineError(file.string() + " is of another version (" + std::to_string(found->version) + ", needed is " +
                      std::to_string(torch_module::kVersion) + "): build it with this program");
  }
  return *found;
}

const Module& loaded() {
  static const Module& module = load();  // tried again after an exception
  return module;
}

}  // namespace

std::unique_ptr<Engine> make_torch_engine(const EngineModel& model, const std::string& device) {
  const Module& torch = loaded();
  return torch.create(read_onnx_graph(model.onnx), device, model.threads);
}

bool torch_sees_gpu() {
  void* const driver = dlopen("libcuda.so.1", RTLD_LAZY | RTLD_LOCAL);
  if (driver == nullptr) return false;
  dlclose(driver);
  try {
    const std::vector<std::string> devices = loaded().devices();
    return std::ranges::any_of(devices, [](const std::string& device) { return device.starts_with("cuda"); });
  } catch (const EngineError&) {
    return false;
  }
}

std::string torch_devices() {
  try {
    std::string text = std::string(loaded().libtorch) + ":";
    for (const std::string& device : loaded().devices()) text += " " + device;
    return text;
  } catch (const EngineError&) {
    return {};
  }
}

}  // namespace rtd::detector
