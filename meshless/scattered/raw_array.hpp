#pragma once

#include "core/base/aligned.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>

namespace fascia {

/// Numbers without a value at first: all threads write them, and with that meet the pages, which takes the system as
/// long as the work itself where millions of numbers live for one step.
template <class T>
class RawArray {
 public:
  explicit RawArray(std::size_t size = 0) : data_(AlignedAllocator<T>().allocate(size)), size_(size) {
    static_assert(std::is_arithmetic_v<T>);
  }

  std::size_t size() const { return size_; }  ///< unless it was moved from
  T& operator[](std::size_t n) { return data_[n]; }
  const T& operator[](std::size_t n) const { return data_[n]; }
  std::span<T> span() { return {data_.get(), size_}; }
  std::span<const T> span() const { return {data_.get(), size_}; }

 private:
  struct Free {
    void operator()(T* data) const { AlignedAllocator<T>().deallocate(data, 0); }
  };
  std::unique_ptr<T[], Free> data_;
  std::size_t size_;
};

}  // namespace fascia
