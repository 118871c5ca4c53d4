#pragma once

#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace fascia {

/// Values in the memory of a space (space.hpp), of a type that is copied byte by byte. Growing loses the contents.
template <class Space, class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Array() = default;
  explicit Array(std::size_t size) { resize(size); }
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(Array&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Array() { Space::release(data_); }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }

  void resize(std::size_t size) {
    if (size > room_) {
      Space::release(std::exchange(data_, nullptr));
      room_ = 0;
      data_ = static_cast<T*>(Space::allocate(size * sizeof(T)));
      room_ = size;
    }
    size_ = size;
  }
  void set_zero() { Space::set_zero(data_, size_ * sizeof(T)); }

  void upload(std::span<const T> values) {
    resize(values.size());
    Space::copy_in(data_, values.data(), size_ * sizeof(T));
  }
  /// The nearest values.
  template <class S>
  void upload_rounded(std::span<const S> values) {
    if constexpr (std::is_same_v<T, S>) {
      upload(values);
    } else {
      const std::vector<T> nearest(values.begin(), values.end());
      upload(nearest);
    }
  }
  /// @param values  of the same size
  void download(std::span<T> values) const { Space::copy_out(values.data(), data_, size_ * sizeof(T)); }
  std::vector<T> downloaded() const {
    std::vector<T> values(size_);
    download(values);
    return values;
  }
  void copy_from(const Array& other) {
    resize(other.size());
    Space::copy(data_, other.data(), size_ * sizeof(T));
  }
  void swap(Array& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(room_, other.room_);
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0, room_ = 0;
};

/// Values of the host for loops of a space: themselves where it sees the host's memory, else a copy.
template <class Space, class T>
class Shown {
 public:
  /// @param values  stay where they are as long as the space looks at them
  /// @return  null where there are none
  const T* show(std::span<const T> values) {
    if (values.empty()) return nullptr;
    if constexpr (Space::kSeesHost) {
      return values.data();
    } else {
      copy_.upload(values);
      return copy_.data();
    }
  }

 private:
  Array<Space, T> copy_;
};

}  // namespace fascia
