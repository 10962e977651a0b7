#include "fit/cuda/kernels.h"

namespace srbf::on_device {
namespace {

constexpr int k_threads = 256;

// The limit on registers leaves room for two blocks on a multiprocessor.
__global__ void __launch_bounds__(k_threads, 2) optimise(const Problem* problems) {
    extern __shared__ float shared[];
    levenberg_marquardt(Block{}, problems[blockIdx.x], shared);
}
__global__ void __launch_bounds__(k_threads, 2) gains(const Problem* problems) {
    extern __shared__ float shared[];
    gains_of_additions(Block{}, problems[blockIdx.x], shared);
}

/// Its text; forgets it, so that a later launch does not report it again.
std::string text(cudaError_t error) {
    if (error == cudaSuccess) return "";
    cudaGetLastError();
    return cudaGetErrorString(error);
}
std::string version(int of) { return std::to_string(of / 1000) + '.' + std::to_string(of % 1000 / 10); }

}  // namespace

std::string device_name(std::string& name) {
    int count = 0, driver = 0;
    if (const auto error = cudaGetDeviceCount(&count); error == cudaErrorInsufficientDriver) {
        cudaGetLastError();
        if (cudaDriverGetVersion(&driver) != cudaSuccess || driver == 0) return "no driver";
        return "a driver of CUDA " + version(driver) + ", older than CUDA " + version(CUDART_VERSION);
    } else if (error != cudaSuccess) {
        return text(error);
    }
    if (count == 0) return "no CUDA device";
    cudaDeviceProp of;
    if (const auto error = cudaGetDeviceProperties(&of, 0); error != cudaSuccess) return text(error);
    name = of.name;
    if (of.major * 10 + of.minor < 75) return name + " of " + std::to_string(of.major) + '.' + std::to_string(of.minor);
    cudaFuncAttributes attributes;  // whether the program has code for it
    const std::string failure = text(cudaFuncGetAttributes(&attributes, optimise));
    return failure.empty() ? "" : name + ": " + failure;
}
std::string free_memory(std::size_t& bytes) {
    std::size_t all = 0;
    return text(cudaMemGetInfo(&bytes, &all));
}
std::string allocate(std::size_t bytes, void*& memory) { return text(cudaMalloc(&memory, bytes)); }
void release(void* memory) { text(cudaFree(memory)); }
std::string copy_to_device(void* to, const void* from, std::size_t bytes) {
    return text(cudaMemcpy(to, from, bytes, cudaMemcpyHostToDevice));
}
std::string copy_to_host(void* to, const void* from, std::size_t bytes) {
    return text(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToHost));
}
std::string launch(Task task, const Problem* problems, int count) {
    constexpr std::size_t shared = sizeof(float) * k_shared;
    static_assert(shared <= 48 * 1024, "what every device has without asking for more");
    if (task == Task::optimise)
        optimise<<<count, k_threads, shared>>>(problems);
    else
        gains<<<count, k_threads, shared>>>(problems);
    if (const auto error = cudaGetLastError(); error != cudaSuccess) return text(error);
    return text(cudaDeviceSynchronize());
}

}  // namespace srbf::on_device
