// A build without CUDA.
#include "fit/cuda/kernels.h"

namespace srbf::on_device {
namespace {
const std::string k_without = "this build has no CUDA";
}
std::string device_name(std::string&) { return k_without; }
std::string free_memory(std::size_t&) { return k_without; }
std::string allocate(std::size_t, void*&) { return k_without; }
void release(void*) {}
std::string copy_to_device(void*, const void*, std::size_t) { return k_without; }
std::string copy_to_host(void*, const void*, std::size_t) { return k_without; }
std::string launch(Task, const Problem*, int) { return k_without; }
}  // namespace srbf::on_device
