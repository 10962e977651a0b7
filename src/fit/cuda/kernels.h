// What the kernels need of a device, without CUDA's headers. A build without CUDA has a stub of it (no_cuda.cpp).
#pragma once
#include <cstddef>
#include <string>

#include "fit/cuda/steps.h"

namespace srbf::on_device {

/// The task of a launch.
enum class Task { optimise, gains };

// Functions that can fail return an error's text, or an empty one.
std::string device_name(std::string& name);
/// Bytes that can be allocated, at least about.
std::string free_memory(std::size_t& bytes);
std::string allocate(std::size_t bytes, void*& memory);
void release(void* memory);
std::string copy_to_device(void* to, const void* from, std::size_t bytes);
std::string copy_to_host(void* to, const void* from, std::size_t bytes);
/// Runs a block for each of `count` problems, whose array is on the device, and waits for them.
std::string launch(Task task, const Problem* problems, int count);

}  // namespace srbf::on_device
