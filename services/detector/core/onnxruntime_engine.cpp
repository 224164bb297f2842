// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/engine.hpp"

#ifndef RTD_HAS_ONNXRUNTIME

namespace rtd::detector {

bool knows_onnxruntime() {
  return false;
}

std::unique_ptr<Engine> make_onnxruntime_engine(const EngineModel&, const std::string&, const std::string&) {
  throw EngineError(
      "this program was built without the engine onnxruntime: unpack ONNX Runtime, configure with "
      "-DRTD_ONNXRUNTIME_ROOT=DIR (it needs include/onnxruntime_c_api.h) and build again");
}

}  // namespace rtd::detector

#else

#include <dlfcn.h>
#include <fcntl.h>
#include <onnxruntime_c_api.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <iostream>
#include <map>
#include <mutex>
#include <opencv2/core.hpp>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/io/fd_writing.hpp"

namespace rtd::detector {
namespace {

/// The first API with all functions that are used here, that of ONNX Runtime 1.11. Later libraries offer it as well.
constexpr std::uint32_t kApiVersion = 11;
static_assert(ORT_API_VERSION >= kApiVersion, "the header onnxruntime_c_api.h must be of ONNX Runtime 1.11 or later");

constexpr int kLogErrors = ORT_LOGGING_LEVEL_ERROR;

template <class Handle>
using Owned = std::unique_ptr<Handle, void (*)(Handle*)>;

/// A library that has been loaded. Never unloaded, as it may keep threads.
struct Library {
  const OrtApi* api = nullptr;
  OrtEnv* environment = nullptr;
  std::string version;  ///< "1.29.0"
};

/// Providers of devices report it only in words.
bool is_out_of_memory(const std::string& cause) {
  constexpr std::array<std::string_view, 2> kWords = {"out of memory", "Failed to allocate memory"};
  return std::ranges::any_of(kWords, [&](std::string_view words) { return cause.find(words) != std::string::npos; });
}

void require(const OrtApi& api, OrtStatus* status, const std::string& task) {
  if (status == nullptr) return;
  const Owned<OrtStatus> owned(status, api.ReleaseStatus);
  const std::string cause = api.GetErrorMessage(status), text = "ONNX Runtime cannot " + task + ": " + cause;
  if (is_out_of_memory(cause)) throw OutOfDeviceMemory(text);
  throw EngineError(text);
}

Library load_library(const std::string& path) {
  void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) throw EngineError("the ONNX Runtime library cannot be loaded: " + std::string(dlerror()));
  const auto base_of = reinterpret_cast<const OrtApiBase* (*)()>(dlsym(handle, "OrtGetApiBase"));
  if (base_of == nullptr) throw EngineError(path + " is not ONNX Runtime: it has no function OrtGetApiBase");
  const OrtApiBase* const base = base_of();
  Library library{base->GetApi(kApiVersion), nullptr, base->GetVersionString()};
  if (library.api == nullptr)
    throw EngineError(path + " is ONNX Runtime " + library.version + ": version 1." + std::to_string(kApiVersion) +
                      " or later is needed");
  require(*library.api, library.api->CreateEnv(ORT_LOGGING_LEVEL_ERROR, "rtd", &library.environment), "start");
  return library;
}

/// Each library is loaded once. Thread-safe.
const Library& library_at(const std::string& path) {
  static std::mutex mutex;
  static std::map<std::string, Library> libraries;
  const std::lock_guard lock(mutex);
  const auto known = libraries.find(path);
  return known != libraries.end() ? known->second : libraries.emplace(path, load_library(path)).first->second;
}

/// The N of "cuda:N", 0 of "cuda"; -1 for the CPU.
int gpu_of(const std::string& device) {
  constexpr std::string_view kCuda = "cuda";
  if (device == "cpu") return -1;
  if (device == kCuda) return 0;
  int number = -1;
  const char* const end = device.data() + device.size();
  if (device.starts_with("cuda:")) {
    const auto parsed = std::from_chars(device.data() + kCuda.size() + 1, end, number);
    if (parsed.ec == std::errc() && parsed.ptr == end && number >= 0) return number;
  }
  throw EngineError("'" + device + "' is not a device of the engine onnxruntime: use @cpu, @cuda or @cuda:N");
}

void use_gpu(const OrtApi& api, OrtSessionOptions* session, int gpu) {
  const std::string task = "use cuda:" + std::to_string(gpu), number = std::to_string(gpu);
  OrtCUDAProviderOptionsV2* made = nullptr;
  require(api, api.CreateCUDAProviderOptions(&made), task);
  const Owned<OrtCUDAProviderOptionsV2> options(made, api.ReleaseCUDAProviderOptions);
  const char* const key = "device_id";
  const char* const value = number.c_str();
  require(api, api.UpdateCUDAProviderOptions(made, &key, &value, 1), task);
  require(api, api.SessionOptionsAppendExecutionProvider_CUDA_V2(session, made), task);
}

/// Debian's ONNX Runtime has the operators in a library of their own, which registers them once more with the first
/// session and writes a line to stderr for each: a thousand. These are left out; what else is written meanwhile comes
/// when the session is open.
class WithoutSchemaErrors {
 public:
  WithoutSchemaErrors() {
    static std::atomic<bool> first{true};
    void* const operators = dlopen("libonnx.so.1", RTLD_LAZY | RTLD_NOLOAD);
    if (operators == nullptr) return;
    dlclose(operators);
    if (!first.exchange(false)) return;
    written_.reset(memfd_create("rtd-stderr", MFD_CLOEXEC));
    if (written_.get() < 0) return;
    stderr_.reset(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3));
    if (stderr_.get() >= 0) dup2(written_.get(), STDERR_FILENO);
  }
  ~WithoutSchemaErrors() {
    if (stderr_.get() < 0) return;
    dup2(stderr_.get(), STDERR_FILENO);
    pass_on();
  }
  WithoutSchemaErrors(const WithoutSchemaErrors&) = delete;
  WithoutSchemaErrors& operator=(const WithoutSchemaErrors&) = delete;

 private:
  void pass_on() const {
    std::string text;
    std::array<char, 4096> part{};
    lseek(written_.get(), 0, SEEK_SET);
    for (ssize_t n = 0; (n = read(written_.get(), part.data(), part.size())) > 0;)
      text.append(part.data(), static_cast<std::size_t>(n));
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (!line.empty() && !line.starts_with("Schema error: Trying to register")) std::cerr << line << '\n';
  }

  io::Descriptor stderr_, written_;
};

Owned<OrtSession> open_session(const Library& library, const EngineModel& model, int gpu) {
  const OrtApi& api = *library.api;
  const std::string task = "configure itself";
  OrtSessionOptions* made = nullptr;
  require(api, api.CreateSessionOptions(&made), task);
  const Owned<OrtSessionOptions> options(made, api.ReleaseSessionOptions);
  require(api, api.SetIntraOpNumThreads(made, std::max(1, model.threads)), task);
  require(api, api.SetSessionExecutionMode(made, ORT_SEQUENTIAL), task);
  require(api, api.SetSessionLogSeverityLevel(made, kLogErrors), task);
  // Threads that spin while they wait would take the time of the other services.
  require(api, api.AddSessionConfigEntry(made, "session.intra_op.allow_spinning", "0"), task);
  if (gpu >= 0) use_gpu(api, made, gpu);
  OrtSession* session = nullptr;
  const WithoutSchemaErrors quiet;
  require(api, api.CreateSessionFromArray(library.environment, model.onnx.data(), model.onnx.size(), made, &session),
          "load this network");
  return {session, api.ReleaseSession};
}

/// The names of a session's inputs or outputs.
std::vector<std::string> session_names(const OrtApi& api, const OrtSession* session,
                                       decltype(OrtApi::SessionGetInputCount) count,
                                       decltype(OrtApi::SessionGetInputName) name) {
  const std::string task = "describe this network";
  OrtAllocator* allocator = nullptr;
  std::size_t there = 0;
  require(api, api.GetAllocatorWithDefaultOptions(&allocator), task);
  require(api, count(session, &there), task);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < there; ++i) {
    char* text = nullptr;
    require(api, name(session, i, allocator, &text), task);
    names.emplace_back(text);
    require(api, api.AllocatorFree(allocator, text), task);
  }
  return names;
}

class OnnxruntimeEngine final : public Engine {
 public:
  OnnxruntimeEngine(const Library& library, const EngineModel& model, int gpu)
      : api_(*library.api),
        session_(open_session(library, model, gpu)),
        inputs_(session_names(api_, session_.get(), api_.SessionGetInputCount, api_.SessionGetInputName)),
        outputs_(session_names(api_, session_.get(), api_.SessionGetOutputCount, api_.SessionGetOutputName)),
        device_((gpu < 0 ? "CPU" : "cuda:" + std::to_string(gpu)) + " (ONNX Runtime " + library.version + ")"),
        memory_(nullptr, api_.ReleaseMemoryInfo) {
    if (inputs_.size() != 1)
      throw EngineError("the network has " + std::to_string(inputs_.size()) + " inputs, expected one image");
    OrtMemoryInfo* memory = nullptr;
    require(api_, api_.CreateCpuMemoryInfo(OrtArenaAllocator, OrtMemTypeDefault, &memory), "use memory of the CPU");
    memory_.reset(memory);
  }

  const std::string& device() const override { return device_; }
  std::size_t outputs() const override { return outputs_.size(); }

  const std::vector<RawOutput>& infer(const cv::Mat& blob) override {
    const Owned<OrtValue> input = tensor_of(blob);
    const OrtValue* const given = input.get();
    const char* const input_name = inputs_.front().c_str();
    std::vector<const char*> output_names;
    for (const std::string& name : outputs_) output_names.push_back(name.c_str());
    std::vector<OrtValue*> made(outputs_.size(), nullptr);
    tensors_.clear();
    results_.clear();
    OrtStatus* const status = api_.Run(session_.get(), nullptr, &input_name, &given, 1, output_names.data(),
                                       output_names.size(), made.data());
    for (OrtValue* value : made) results_.emplace_back(value, api_.ReleaseValue);
    require(api_, status, "compute this network");
    for (const Owned<OrtValue>& result : results_) tensors_.push_back(output_of(result.get()));
    return tensors_;
  }

 private:
  /// Uses the memory of the blob.
  Owned<OrtValue> tensor_of(const cv::Mat& blob) const {
    const std::vector<std::int64_t> shape(blob.size.p, blob.size.p + blob.dims);
    OrtValue* tensor = nullptr;
    require(api_,
            api_.CreateTensorWithDataAsOrtValue(memory_.get(), blob.data, blob.total() * blob.elemSize(), shape.data(),
                                                shape.size(), ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT, &tensor),
            "take the images");
    return {tensor, api_.ReleaseValue};
  }

  RawOutput output_of(OrtValue* value) const {
    const std::string task = "give its outputs";
    OrtTensorTypeAndShapeInfo* made = nullptr;
    require(api_, api_.GetTensorTypeAndShape(value, &made), task);
    const Owned<OrtTensorTypeAndShapeInfo> info(made, api_.ReleaseTensorTypeAndShapeInfo);
    ONNXTensorElementDataType type = ONNX_TENSOR_ELEMENT_DATA_TYPE_UNDEFINED;
    std::size_t dimensions = 0;
    require(api_, api_.GetTensorElementType(made, &type), task);
    require(api_, api_.GetDimensionsCount(made, &dimensions), task);
    if (type != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT || dimensions == 0) return {};
    std::vector<std::int64_t> sides(dimensions);
    require(api_, api_.GetDimensions(made, sides.data(), sides.size()), task);
    void* values = nullptr;
    require(api_, api_.GetTensorMutableData(value, &values), task);
    RawOutput output{static_cast<const float*>(values), {}};
    for (const std::int64_t side : sides) output.shape.push_back(static_cast<int>(side));
    return output;
  }

  const OrtApi& api_;
  const Owned<OrtSession> session_;
  const std::vector<std::string> inputs_, outputs_;
  const std::string device_;
  Owned<OrtMemoryInfo> memory_;
  std::vector<Owned<OrtValue> > results_;
  std::vector<RawOutput> tensors_;
};

}  // namespace

bool knows_onnxruntime() {
  return true;
}

std::unique_ptr<Engine> make_onnxruntime_engine(const EngineModel& model, const std::string& library,
                                                const std::string& device) {
  const int gpu = gpu_of(device);
  return std::make_unique<OnnxruntimeEngine>(library_at(library), model, gpu);
}

}  // namespace rtd::detector

#endif
