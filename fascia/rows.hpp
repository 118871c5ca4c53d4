#pragma once

#include <cstddef>
#include <span>

namespace fascia {

/// A view of numbers in rows, whose memory belongs to whoever gave it.
struct Rows {
  const double* data = nullptr;
  int rows = 0, columns = 0;

  std::span<const double> operator[](int row) const {
    return {data + static_cast<std::ptrdiff_t>(row) * columns, static_cast<std::size_t>(columns)};
  }
};

}  // namespace fascia
