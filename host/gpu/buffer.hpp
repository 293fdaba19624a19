// A typed array on the device, owned.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/gpu/cl_error.hpp"
#include "host/gpu/context.hpp"
#include "host/gpu/host_memory.hpp"

namespace hemiray {

/// Move-only owner of `size` elements of T in device memory. An empty buffer still has one element's room, since OpenCL
/// knows no empty buffers. The Context must outlive it. Members throw DeviceError.
template <typename T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(Context& context, std::string name, std::size_t size)
      : context_(&context), name_(std::move(name)), size_(size), bytes_(std::max<std::size_t>(size, 1) * sizeof(T)) {
    context.account_allocation(bytes_, name_);
    try {
      memory_ = context.take_host_memory(bytes_);
      cl_guard("allocating " + name_, [this] {
        const cl_mem_flags flags = CL_MEM_READ_WRITE | (memory_.memory ? CL_MEM_USE_HOST_PTR : 0);
        handle_ = cl::Buffer(context_->handle(), flags, bytes_, memory_.memory.get());
      });
    } catch (...) {
      context.keep_host_memory(std::move(memory_));
      context.account_release(bytes_);
      throw;
    }
  }
  Buffer(Context& context, std::string name, std::span<const T> data) : Buffer(context, std::move(name), data.size()) {
    write(data);
  }
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer moved(std::move(other));
    swap(moved);
    return *this;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() {
    if (context_ == nullptr) return;
    context_->account_release(bytes_);
    handle_ = cl::Buffer();
    context_->keep_host_memory(std::move(memory_));
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] const cl::Buffer& handle() const { return handle_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Copies data.size() <= size() elements to the start of the buffer; waits.
  void write(std::span<const T> data) {
    if (data.empty()) return;
    cl_guard("writing " + name_,
             [&] { context_->queue().enqueueWriteBuffer(handle_, CL_TRUE, 0, data.size_bytes(), data.data()); });
  }

  /// Copies `count` elements from `first` on to the host; waits for everything queued before.
  [[nodiscard]] std::vector<T> read(std::size_t first, std::size_t count) const {
    std::vector<T> data(count);
    if (count == 0) return data;
    cl_guard("reading " + name_, [&] {
      context_->queue().enqueueReadBuffer(handle_, CL_TRUE, first * sizeof(T), count * sizeof(T), data.data());
    });
    return data;
  }
  [[nodiscard]] std::vector<T> read() const { return read(0, size_); }

  /// Sets every element to zero bytes, by a write: simulators take filled buffers for uninitialised.
  void clear() {
    constexpr std::size_t kPiece = std::size_t{1} << 20U;
    const std::vector<unsigned char> zeros(std::min(kPiece, static_cast<std::size_t>(bytes_)), 0);
    cl_guard("clearing " + name_, [&] {
      for (std::size_t at = 0; at < bytes_; at += zeros.size()) {
        context_->queue().enqueueWriteBuffer(handle_, CL_TRUE, at, std::min(zeros.size(), bytes_ - at), zeros.data());
      }
    });
  }

 private:
  void swap(Buffer& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(name_, other.name_);
    std::swap(size_, other.size_);
    std::swap(bytes_, other.bytes_);
    std::swap(memory_, other.memory_);
    std::swap(handle_, other.handle_);
  }

  Context* context_ = nullptr;
  std::string name_;
  std::size_t size_ = 0;
  std::size_t bytes_ = 0;
  HostMemory memory_;  ///< of large buffers on CPU devices; outlives the handle, and waits in the context after it
  cl::Buffer handle_;
};

}  // namespace hemiray
