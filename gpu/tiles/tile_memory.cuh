#pragma once

#include "gpu/space/cuda_check.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fascia::tile {

using gpu::check;

/// An array on the device.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t n) { resize(n); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  Buffer(Buffer&& o) noexcept : data_(std::exchange(o.data_, nullptr)), size_(std::exchange(o.size_, 0)) {}
  Buffer& operator=(Buffer&& o) noexcept {
    std::swap(data_, o.data_);
    std::swap(size_, o.size_);
    return *this;
  }
  ~Buffer() { cudaFree(data_); }

  /// Contents are lost.
  void resize(std::size_t n) {
    if (n == size_) return;
    check(cudaFree(std::exchange(data_, nullptr)), "freeing memory");
    size_ = 0;
    if (n > 0) {
      const std::string what = "asking for " + std::to_string(n * sizeof(T)) + " bytes";
      check(cudaMalloc(reinterpret_cast<void**>(&data_), n * sizeof(T)), what.c_str());
    }
    size_ = n;
  }
  void upload(std::span<const T> values) {
    resize(values.size());
    if (!values.empty())
      check(cudaMemcpy(data_, values.data(), values.size_bytes(), cudaMemcpyHostToDevice), "copying to the device");
  }
  std::vector<T> download() const {
    std::vector<T> values(size_);
    if (size_ > 0)
      check(cudaMemcpy(values.data(), data_, size_ * sizeof(T), cudaMemcpyDeviceToHost), "copying from the device");
    return values;
  }
  T* get() { return data_; }
  const T* get() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace fascia::tile
